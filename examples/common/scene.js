// The scene as numbers, for the pages that draw it and for the program that computes the truth. Lengths are metres, y is up.
// Surfaces are flat, so interpolated normals cause no differences between the pictures. They have gloss only. Nothing casts a
// shadow.

export const camera = { eye: [ 0, 2.3, 3.6 ], target: [ 0, 0.1, - 0.1 ], fov: 40 };

/** One-sided rectangles that emit along their normals; `width` is along `right`. Radiance is red, green, blue. */
const all = [
	{ centre: [ 0.1, 1.05, - 2.2 ], normal: [ 0, - 0.25, 1 ], right: [ 1, 0, 0 ], width: 2.4, height: 1, radiance: [ 2, 1.94, 1.8 ] },
	{ centre: [ - 2.3, 0.9, - 0.4 ], normal: [ 1, - 0.3, 0.1 ], right: [ 0, 0, 1 ], width: 1.6, height: 0.5, radiance: [ 0.5, 1, 2 ] },
	{ centre: [ 2.2, 0.8, - 0.6 ], normal: [ - 1, - 0.2, 0 ], right: [ 0, 0.1, 1 ], width: 0.8, height: 1.2, radiance: [ 2, 0.7, 0.4 ] },
	// A strip on the table.
	{ centre: [ - 0.2, 0.06, - 1.4 ], normal: [ 0, 0, 1 ], right: [ 1, 0, 0 ], width: 3, height: 0.12, radiance: [ 0.6, 2, 0.8 ] },
];

/** The first `count` lights. The page uses one, or as many as `?lights=4` says; eight lights measure a shader's compile time. */
export const lightsOf = ( count ) => Array.from( { length: count }, ( _, i ) => all[ i % all.length ] );

/**
 * Rectangles of `size`, and rings from `radii[ 0 ]` to `radii[ 1 ]`. `right` is tangential to the surface. `alpha` is GGX
 * roughness along x and y: on a rectangle along and across `right`, on a ring along and across the radius, as after turning on
 * a lathe. `f0` is the reflectance at normal incidence, red, green, blue. At grazing angles it is 1 (Schlick).
 */
export const surfaces = [
	{ // A table brushed from left to right, which stretches the image of the light towards the viewer.
		centre: [ 0, 0, 0 ], normal: [ 0, 1, 0 ], right: [ 1, 0, 0 ],
		size: [ 6, 5 ], alpha: [ 0.03, 0.25 ], f0: [ 0.55, 0.56, 0.58 ],
	},
	{ // A turned disc of copper.
		centre: [ - 0.8, 0.15, 0.3 ], normal: [ 0.06, 1, 0.1 ], right: [ 1, - 0.06, 0 ],
		radii: [ 0.05, 0.62 ], alpha: [ 0.4, 0.05 ], f0: [ 0.95, 0.64, 0.54 ],
	},
	{ // A plate of gold, brushed at an angle.
		centre: [ 0.8, 0.2, 0.3 ], normal: [ - 0.1, 1, 0.1 ], right: [ 0.9, 0.045, 0.45 ],
		size: [ 1.15, 0.85 ], alpha: [ 0.5, 0.06 ], f0: [ 1, 0.77, 0.34 ],
	},
	{ // A black plastic tile. It is isotropic, so the lobe of engines is right here.
		centre: [ 0.1, 0.1, 1.1 ], normal: [ 0, 1, - 0.25 ], right: [ 1, 0, 0 ],
		size: [ 0.8, 0.4 ], alpha: [ 0.1, 0.1 ], f0: [ 0.04, 0.04, 0.04 ],
	},
];

const dot = ( a, b ) => a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];
const sum = ( ...vectors ) => [ 0, 1, 2 ].map( ( i ) => vectors.reduce( ( total, v ) => total + v[ i ], 0 ) );
const scaled = ( v, by ) => v.map( ( x ) => x * by );
const minus = ( a, b ) => sum( a, scaled( b, - 1 ) );
const cross = ( a, b ) => [ 0, 1, 2 ].map( ( i ) => a[ ( i + 1 ) % 3 ] * b[ ( i + 2 ) % 3 ] - a[ ( i + 2 ) % 3 ] * b[ ( i + 1 ) % 3 ] );
const unit = ( v ) => scaled( v, 1 / Math.sqrt( dot( v, v ) ) );

/** The axes of a surface or a light, right-handed and of unit length: `right`, `up`, `normal`. */
export function axesOf( { normal, right } ) {

	const z = unit( normal );
	const x = unit( minus( right, scaled( z, dot( z, right ) ) ) );
	return [ x, cross( z, x ), z ];

}

/** The corners of the light in world space, clockwise as seen from the side that emits. */
export function cornersOf( rectangle ) {

	const [ x, y ] = axesOf( rectangle );
	const halfX = scaled( x, rectangle.width / 2 );
	const halfY = scaled( y, rectangle.height / 2 );
	return [ [ - 1, - 1 ], [ - 1, 1 ], [ 1, 1 ], [ 1, - 1 ] ]
		.map( ( [ i, j ] ) => sum( rectangle.centre, scaled( halfX, i ), scaled( halfY, j ) ) );

}

/**
 * The visible point at the middle of a pixel.
 *
 * @returns {?{ surface: number, light: number, view: number[], corners: number[][][] }} Null for nothing. For a light,
 * `surface` is -1 and `light` its number. For a surface, its number, the direction to the eye, and the corners of each light
 * relative to the point, all in the tangent frame.
 */
export function seenBy( column, row, width, height, lights ) {

	const back = unit( minus( camera.eye, camera.target ) );
	const right = unit( cross( [ 0, 1, 0 ], back ) );
	const up = cross( back, right );
	const half = Math.tan( camera.fov * Math.PI / 360 );
	const x = ( 2 * ( column + 0.5 ) / width - 1 ) * half * width / height;
	const y = ( 1 - 2 * ( row + 0.5 ) / height ) * half;
	const ray = unit( sum( scaled( right, x ), scaled( up, y ), scaled( back, - 1 ) ) );

	let nearest = Infinity;
	let seen = null;
	[ ...surfaces, ...lights.map( ( light ) => ( { ...light, size: [ light.width, light.height ] } ) ) ].forEach( ( surface, number ) => {

		const axes = axesOf( surface );
		const facing = - dot( ray, axes[ 2 ] );
		const distance = dot( minus( camera.eye, surface.centre ), axes[ 2 ] ) / facing;
		if ( facing <= 0 || distance <= 0 || distance >= nearest ) return;

		const point = sum( camera.eye, scaled( ray, distance ) );
		const local = axes.slice( 0, 2 ).map( ( axis ) => dot( minus( point, surface.centre ), axis ) );
		const radius = Math.hypot( ...local );
		const within = surface.radii
			? radius >= surface.radii[ 0 ] && radius <= surface.radii[ 1 ]
			: local.every( ( value, i ) => Math.abs( value ) <= surface.size[ i ] / 2 );
		if ( ! within ) return;

		nearest = distance;
		if ( number >= surfaces.length ) {

			seen = { surface: - 1, light: number - surfaces.length };
			return;

		}

		// The tangent frame. On a ring, x is along the radius.
		const tangent = surface.radii
			? unit( sum( scaled( axes[ 0 ], local[ 0 ] ), scaled( axes[ 1 ], local[ 1 ] ) ) )
			: axes[ 0 ];
		const frame = [ tangent, cross( axes[ 2 ], tangent ), axes[ 2 ] ];
		const inFrame = ( v ) => frame.map( ( axis ) => dot( axis, v ) );
		seen = {
			surface: number,
			view: inFrame( scaled( ray, - 1 ) ),
			corners: lights.map( ( light ) => cornersOf( light ).map( ( corner ) => inFrame( minus( corner, point ) ) ) ),
		};

	} );
	return seen;

}
