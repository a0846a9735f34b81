// The scene that every engine draws, and for which the truth is computed. It is right-handed, in metres, with y
// upwards. It has a table in the plane y = 0 with only a glossy material, and a rectangle light of radiance one.

/** Pictures for docs/engines.md are larger and fewer: `run.js --pictures`, or `?scale=4` of a page. */
const scale = globalThis.location ? Number( new URLSearchParams( location.search ).get( 'scale' ) ) || 1 : process.argv.includes( '--pictures' ) ? 4 : 1;

/** The query of a page, so that it draws the compared pictures. */
export const query = `scale=${ scale }`;

/** Pixels of a picture. */
export const width = 48 * scale;
export const height = 36 * scale;

/** Perceptual roughness: the square root of GGX alpha. */
export const roughnesses = [ 0.1, 0.25, 0.4, 0.6, 0.8 ];

/** Reflectance at normal incidence: white metal and black plastic. At grazing angles both have 1. */
export const reflectances = [ 1, 0.04 ];

/** Reflectance of dark metal at normal incidence. It is only drawn at the lowest view. */
export const darkMetal = 0.25;

/** White metal under clearcoat, whose reflectance is 0.04 and 1. */
export const coated = { roughness: 0.6, clearcoatRoughness: 0.25 };

/** Views from above to grazing. They are not symmetrical, so that a mirrored picture cannot pass. */
export const views = [
	{ eye: [ 0.5, 3.1, 1.9 ], target: [ 0.2, 0, 0 ], fov: 40 },
	{ eye: [ - 0.6, 1.7, 3.3 ], target: [ 0.1, 0, - 0.2 ], fov: 35 },
	{ eye: [ 0.9, 0.55, 3.9 ], target: [ 0, 0.1, - 0.3 ], fov: 30 },
];

/** Half of the table's sides along x and z, from its centre at the origin. */
export const table = { halfX: 2.2, halfZ: 1.5 };

/** The light: `axes` are width, height and the direction in which it shines, each of length one and right-handed. */
export const light = {
	centre: [ 0.3, 1, - 1.9 ],
	width: 1.5,
	height: 0.9,
	axes: axes( [ 0.15, - 0.35, 1 ], [ 1, 0.1, 0 ] ),
};

function axes( direction, across ) {

	const z = unit( direction );
	const along = dot( across, z );
	const x = unit( across.map( ( value, i ) => value - along * z[ i ] ) );
	return [ x, cross( z, x ), z ];

}

function dot( a, b ) {

	return a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];

}

function cross( a, b ) {

	return [ 0, 1, 2 ].map( ( i ) => a[ ( i + 1 ) % 3 ] * b[ ( i + 2 ) % 3 ] - a[ ( i + 2 ) % 3 ] * b[ ( i + 1 ) % 3 ] );

}

function unit( v ) {

	const length = Math.sqrt( dot( v, v ) );
	return v.map( ( x ) => x / length );

}

/** The point of the table in the middle of each pixel, from the top left; `null` at and beyond the edges of the table. */
export function pointsOf( view ) {

	const back = unit( view.eye.map( ( x, i ) => x - view.target[ i ] ) );
	const right = unit( cross( [ 0, 1, 0 ], back ) );
	const up = cross( back, right );
	const half = Math.tan( view.fov * Math.PI / 360 );
	const hit = ( column, row ) => {

		const x = ( 2 * column / width - 1 ) * half * width / height;
		const y = ( 1 - 2 * row / height ) * half;
		const ray = [ 0, 1, 2 ].map( ( i ) => x * right[ i ] + y * up[ i ] - back[ i ] );
		const distance = - view.eye[ 1 ] / ray[ 1 ];
		const point = view.eye.map( ( value, i ) => value + distance * ray[ i ] );
		const isHit = distance > 0 && Math.abs( point[ 0 ] ) < table.halfX && Math.abs( point[ 2 ] ) < table.halfZ;
		return isHit ? point : null;

	};

	return Array.from( { length: width * height }, ( _, i ) => {

		const column = i % width;
		const row = Math.floor( i / width );
		const isInside = [ [ 0, 0 ], [ 1, 0 ], [ 0, 1 ], [ 1, 1 ] ].every( ( [ x, y ] ) => hit( column + x, row + y ) );
		return isInside ? hit( column + 0.5, row + 0.5 ) : null;

	} );

}

/** Every picture that an engine draws, in order. */
const all = reflectances.flatMap( ( f0 ) => roughnesses.flatMap( ( roughness ) => views.map( ( view ) => ( { f0, roughness, view } ) ) ) );
all.push( ...roughnesses.map( ( roughness ) => ( { f0: darkMetal, roughness, view: views[ 2 ] } ) ) );
const isShown = ( { f0, roughness, view } ) => f0 === 1 && roughness === 0.4 && view !== views[ 0 ];
export const pictures = scale === 1 ? all : all.filter( isShown );

/** A line for `ltcforge light` for a point of the table. The tangent frame is (z, x, y). */
export function questionOf( roughness, view, point ) {

	const inFrame = ( v ) => [ v[ 2 ], v[ 0 ], v[ 1 ] ];
	const wo = inFrame( unit( view.eye.map( ( x, i ) => x - point[ i ] ) ) );
	const [ x, y ] = light.axes;
	// The corners run clockwise as seen from the lit side.
	const corners = [ [ - 1, - 1 ], [ - 1, 1 ], [ 1, 1 ], [ 1, - 1 ] ].flatMap( ( [ i, j ] ) => inFrame( point.map( ( at, k ) =>
		light.centre[ k ] + ( i * light.width * x[ k ] + j * light.height * y[ k ] ) / 2 - at ) ) );
	const alpha = roughness ** 2;
	return [ alpha, alpha, Math.acos( wo[ 2 ] ), Math.atan2( wo[ 1 ], wo[ 0 ] ), 1, ...corners ].join( ',' );

}

/** The red channel from the top left, of pixels of four numbers from the bottom left. */
export function redFromTop( pixels ) {

	return Array.from( { length: width * height }, ( _, i ) =>
		pixels[ 4 * ( ( height - 1 - Math.floor( i / width ) ) * width + i % width ) ] );

}
