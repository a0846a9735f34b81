// The scene of the viewer: its parameters, its links, and its uniforms for shaders.

/** Makes parameters from rows of name, label, minimum, maximum, step and default. */
const numbers = ( rows ) => rows.map( ( [ name, label, min, max, step, value ] ) => ( { name, label, min, max, step, value } ) );

/** Parameters of the scene. Their names are the same in links and in `/v1/preview`. */
export const PARAMETERS = numbers( [
	[ 'alpha_x', 'Roughness along', 0.01, 1, 0.01, 0.5 ],
	[ 'alpha_y', 'Roughness across', 0.01, 1, 0.01, 0.1 ],
	[ 'rotation', 'Rotation', - 3.14, 3.14, 0.01, 0 ],
	[ 'camera_azimuth', 'Azimuth', - 3.14, 3.14, 0.01, 0 ],
	[ 'camera_elevation', 'Elevation', - 1.5, 1.5, 0.01, 0.2 ],
	[ 'camera_distance', 'Distance', 1.5, 16, 0.01, 9 ],
	[ 'exposure', 'Exposure', 0.1, 8, 0.01, 1 ],
	[ 'occluder_x', 'Position x', - 2, 2, 0.01, - 0.75 ],
	[ 'occluder_y', 'Position y', - 1, 2, 0.01, 0.95 ],
	[ 'occluder_z', 'Position z', - 2, 3, 0.01, 0.8 ],
	[ 'occluder_size', 'Half size', 0.05, 1, 0.01, 0.2 ],
] );

/** Parameters of a light. In links, parameters of the second light begin with `light2_`. */
export const OF_LIGHT = numbers( [
	[ 'x', 'Position x', - 5, 5, 0.01, - 1.3 ],
	[ 'y', 'Position y', - 1, 5, 0.01, 1.4 ],
	[ 'z', 'Position z', - 5, 5, 0.01, 1.2 ],
	[ 'width', 'Half width', 0.05, 3, 0.01, 0.7 ],
	[ 'height', 'Half height', 0.02, 3, 0.01, 0.45 ],
	[ 'yaw', 'Turn', - 3.14, 3.14, 0.01, 0 ],
	[ 'pitch', 'Tilt', - 3.14, 3.14, 0.01, 0 ],
	[ 'roll', 'Roll', - 3.14, 3.14, 0.01, 0 ],
	[ 'intensity', 'Radiance', 0.1, 20, 0.1, 3 ],
] );

/** Maximum number of lights, and the initial position of each. */
export const MOST_LIGHTS = 4;
const PLACES = [ [ - 1.3, 1.4, 1.2 ], [ 1.5, 1.2, 1 ], [ 0, 1.9, - 0.6 ], [ 0, - 0.4, 2 ] ];

/** Shapes of lights, with the labels of their two sizes, and the number of corners of regular polygons. */
export const LIGHT_SHAPES = {
	rectangle: { sizes: [ 'Half width', 'Half height' ] },
	disk: { sizes: [ 'Half width', 'Half height' ] },
	sphere: { sizes: [ 'Radius', null ] },
	tube: { sizes: [ 'Half length', 'Radius' ] },
	line: { sizes: [ 'Half length', 'Half thickness' ] },
	triangle: { sizes: [ 'Half width', 'Half height' ], corners: 3 },
	pentagon: { sizes: [ 'Half width', 'Half height' ], corners: 5 },
	hexagon: { sizes: [ 'Half width', 'Half height' ], corners: 6 },
	// The polygon of a scene. Member `outline` of the light has its corners, from -1 to 1.
	polygon: { sizes: [ 'Half width', 'Half height' ] },
};

/** Pictures on rectangular lights: name in a link, and label. Opened files are not in this list. */
export const PICTURES = { '': 'one colour', signs: 'a picture', disc: 'a video' };

/** The sides that emit: name in a link, and label. */
export const LIT_SIDES = { '': 'the front', both: 'both sides' };

/** Whether a light has two sides, and can turn. */
export const isFlat = ( { shape } ) => ! [ 'sphere', 'tube', 'line' ].includes( shape );

/** Whether a light shows a picture. */
export const isPictured = ( { shape, picture } ) => shape === 'rectangle' && picture !== '';

/** Reflectances at normal incidence, linear sRGB. Sheen is always `white`. */
export const METALS = { silver: [ 0.91, 0.92, 0.92 ], gold: [ 1, 0.71, 0.29 ], copper: [ 0.95, 0.64, 0.54 ], plastic: [ 0.04, 0.04, 0.04 ], white: [ 1, 1, 1 ] };

/** Diffuse colours of the materials that have one. */
export const DIFFUSE = { plastic: [ 0.05, 0.12, 0.4 ] };

/** Parameters with a list of values. The first value is the default. */
export const CHOICES = {
	surface: [ 'sphere', 'floor', 'shader_ball', 'mesh' ],
	metal: Object.keys( METALS ),
	show: [ 'split', 'model', 'reference', 'difference' ],
	glow: [ 'on', 'off' ],
	diffuse: [ 'on', 'off' ],
	occluders: [ 'none', 'ball', 'box', 'ball_and_box' ],
	shadows: [ '4', '1', 'off' ],
};

/** Largest number of pixels per side. */
export const MOST_PIXELS = 1440;

/** Parameters that only links have: pixels per side, where 0 stands for those of the screen, and samples of a finished truth. */
const FIXED = [ { name: 'size', min: 64, max: MOST_PIXELS, step: 1, value: 0 }, { name: 'spp', min: 2, max: 4096, step: 2, value: 1024 } ];

/** The angle of view from edge to edge in radians, as in the scene `sphere` of previews. */
const FIELD_OF_VIEW = 0.5;

export const dot = ( a, b ) => a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];

export const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];

export const scaled = ( v, by ) => v.map( ( x ) => x * by );

export const plus = ( ...vectors ) => vectors.reduce( ( a, b ) => a.map( ( x, i ) => x + b[ i ] ) );

export const unit = ( v, otherwise ) => dot( v, v ) > 1e-24 ? scaled( v, 1 / Math.sqrt( dot( v, v ) ) ) : otherwise;

/** The name of a light's parameter in a link. */
const named = ( i, name ) => `light${ i ? i + 1 : '' }_${ name }`;

/** The initial values of the light with index `i`. */
export function addedLight( i ) {
	const [ x, y, z ] = PLACES[ i ];
	return { shape: 'rectangle', outline: '', picture: '', colour: '#ffffff', sides: '', ...Object.fromEntries( OF_LIGHT.map( ( { name, value } ) => [ name, value ] ) ), x, y, z };
}

/** The number in a text, clamped to its bounds, or `value` if the text is missing or malformed. */
function within( { min, max }, text, value ) {
	const given = text === null || text === '' ? value : Number( text );
	return Number.isFinite( given ) ? Math.min( max, Math.max( min, given ) ) : value;
}

/** The bounds of a light's parameter. The lights of a scene can be farther away, larger and brighter than sliders allow. */
const loose = ( { name, min } ) => /^(yaw|pitch|roll)$/.test( name ) ? { min: - Math.PI, max: Math.PI } : { min: min < 0 ? - 1e4 : 1e-5, max: 1e6 };

/** A value of a parameter within its bounds. An azimuth turns around instead. */
export function bounded( name, value ) {
	if ( name === 'camera_azimuth' ) return value - 2 * Math.PI * Math.round( value / ( 2 * Math.PI ) );
	const { min, max } = PARAMETERS.find( ( field ) => field.name === name ) ?? loose( OF_LIGHT.find( ( field ) => field.name === name ) );
	return Math.min( max, Math.max( min, value ) );
}

/** The corners of a polygon in a text, or none if it does not have three to eight. */
function cornersOf( outline ) {
	const numbers = outline.split( ' ' ).map( Number );
	const isValid = numbers.length % 2 === 0 && numbers.length >= 6 && numbers.length <= 16 && numbers.every( ( at ) => Math.abs( at ) <= 1 );
	return isValid ? Array.from( { length: numbers.length / 2 }, ( _, i ) => [ numbers[ 2 * i ], numbers[ 2 * i + 1 ] ] ) : [];
}

/** The default border between both sides, as a fraction of the width. */
const SPLIT = 0.5;

/** The first look of a dropped file: lit by the table of engines and a light in front of the scene. */
const DROPPED = { table: 'engines', surface: 'mesh', camera_distance: '4.6', light_y: '1.6', light_z: '2.6', light_width: '1.2', light_height: '0.9', light_intensity: '6' };

/** Whether lights are those of a new link, or of a dropped file. */
export const areNew = ( lights ) => [ {}, DROPPED ].some( ( parameters ) => JSON.stringify( read( new URLSearchParams( parameters ) ).lights ) === JSON.stringify( lights ) );

/** Reads a scene from the parameters of a link. Member `dropped` names a file that was just dropped. Missing and malformed values are replaced by defaults. Numbers are clamped to their bounds. */
export function read( parameters ) {
	if ( parameters.get( 'dropped' ) ) return read( new URLSearchParams( { ...DROPPED, mesh: parameters.get( 'dropped' ) } ) );
	const scene = { table: parameters.get( 'table' ) || '', against: parameters.get( 'against' ) || '', split: within( { min: 0, max: 1 }, parameters.get( 'split' ), SPLIT ), mesh: parameters.get( 'mesh' ) || '' };
	for ( const { name, step, value, ...bounds } of FIXED ) scene[ name ] = parameters.get( name ) ? step * Math.round( within( bounds, parameters.get( name ), value ) / step ) : value;
	for ( const field of PARAMETERS ) scene[ field.name ] = within( field, parameters.get( field.name ), field.value );
	for ( const [ name, options ] of Object.entries( CHOICES ) ) scene[ name ] = options.includes( parameters.get( name ) ) ? parameters.get( name ) : options[ 0 ];
	const count = Math.round( within( { min: 1, max: MOST_LIGHTS }, parameters.get( 'lights' ), 1 ) );
	scene.lights = Array.from( { length: count }, ( _, i ) => {
		const light = addedLight( i );
		for ( const field of OF_LIGHT ) light[ field.name ] = within( loose( field ), parameters.get( named( i, field.name ) ), light[ field.name ] );
		const shape = parameters.get( named( i, 'shape' ) );
		const outline = parameters.get( named( i, 'outline' ) ) || '';
		if ( cornersOf( outline ).length ) light.outline = outline;
		if ( Object.hasOwn( LIGHT_SHAPES, shape || '' ) && ( shape !== 'polygon' || light.outline ) ) light.shape = shape;
		const picture = parameters.get( named( i, 'picture' ) ) || '';
		if ( Object.hasOwn( PICTURES, picture ) ) light.picture = picture;
		if ( parameters.get( named( i, 'sides' ) ) === 'both' ) light.sides = 'both';
		const colour = parameters.get( named( i, 'colour' ) ) || '';
		if ( /^#[0-9a-f]{6}$/.test( colour ) ) light.colour = colour;
		return light;
	} );
	return scene;
}

/** The parameters of a link to a scene. Default values are left out. */
export function link( scene ) {
	const changed = PARAMETERS.filter( ( { name, value } ) => scene[ name ] !== value ).map( ( { name } ) => [ name, scene[ name ] ] );
	const chosen = Object.entries( CHOICES ).filter( ( [ name, options ] ) => options.indexOf( scene[ name ] ) > 0 ).map( ( [ name ] ) => [ name, scene[ name ] ] );
	const fixed = FIXED.filter( ( { name, value } ) => scene[ name ] !== value ).map( ( { name } ) => [ name, scene[ name ] ] );
	const models = [ 'table', 'against', 'mesh' ].filter( ( name ) => scene[ name ] ).map( ( name ) => [ name, scene[ name ] ] );
	const lights = scene.lights.flatMap( ( light, i ) => Object.entries( addedLight( i ) ).filter( ( [ name, value ] ) => light[ name ] !== value && light[ name ] !== 'file' ).map( ( [ name ] ) => [ named( i, name ), light[ name ] ] ) );
	return new URLSearchParams( [ ...models, ...chosen, ...fixed, ...( scene.split === SPLIT ? [] : [ [ 'split', scene.split ] ] ), ...changed, ...( scene.lights.length > 1 ? [ [ 'lights', scene.lights.length ] ] : [] ), ...lights ] );
}

/** The linear channels of a colour such as `#ff8000`. */
function linear( colour ) {
	return [ 1, 3, 5 ].map( ( at ) => parseInt( colour.slice( at, at + 2 ), 16 ) / 255 ).map( ( v ) => v <= 0.04045 ? v / 12.92 : ( ( v + 0.055 ) / 1.055 ) ** 2.4 );
}

/** The corners of a regular polygon around the origin, clockwise from an angle. */
const regular = ( count, radius, first ) => Array.from( { length: count }, ( _, i ) => [ radius * Math.cos( first - 2 * Math.PI * i / count ), radius * Math.sin( first - 2 * Math.PI * i / count ) ] );

/** A light in space: centre, half axes, normal of the side that emits light and faces the origin, corners of its polygon, and both ends. */
export function placed( { shape, outline, x, y, z, width, height, yaw, pitch, roll } ) {
	const centre = [ x, y, z ];
	const facing = unit( scaled( centre, - 1 ), [ 0, 0, 1 ] );
	const right = unit( cross( [ 0, 1, 0 ], facing ), [ 1, 0, 0 ] );
	const up = cross( facing, right );
	// Rotates about the normal, then about the horizontal axis, then about the vertical axis of the light.
	const [ sy, cy, sp, cp, sr, cr ] = [ yaw, pitch, roll ].flatMap( ( angle ) => [ Math.sin( angle ), Math.cos( angle ) ] );
	const turned = ( a, b, c ) => plus( scaled( right, cy * a + sy * c ), scaled( up, b ), scaled( facing, cy * c - sy * a ) );
	const normal = turned( 0, - sp, cp );
	const [ along, across ] = [ scaled( turned( cr, cp * sr, sp * sr ), width ), scaled( turned( - sr, cp * cr, sp * cr ), height ) ];
	const at = ( [ u, v ] ) => plus( centre, scaled( along, u ), scaled( across, v ) );
	const { corners } = LIGHT_SHAPES[ shape ];
	const flat = shape === 'rectangle' ? [ [ - 1, 1 ], [ 1, 1 ], [ 1, - 1 ], [ - 1, - 1 ] ]
		: shape === 'polygon' ? cornersOf( outline )
		: corners ? regular( corners, 1, Math.PI / 2 )
		// Some models support only polygons. For them, an octagon with the same area replaces the disk.
		: shape === 'disk' ? regular( 8, Math.sqrt( Math.PI / ( 4 * Math.sin( Math.PI / 4 ) ) ), Math.PI / 8 ) : [];
	return { centre, normal, along, across, vertices: flat.map( at ), at, ends: [ plus( centre, scaled( along, - 1 ) ), plus( centre, along ) ] };
}

/** Points on the outline of a light, as seen from `eye`. */
export function outline( light, eye ) {
	const { centre, along, vertices, at, ends } = placed( light );
	if ( light.shape === 'disk' ) return regular( 32, 1, 0 ).map( at );
	if ( vertices.length ) return vertices;
	const way = unit( plus( centre, scaled( eye, - 1 ) ), [ 0, 0, 1 ] );
	const radius = light.shape === 'sphere' ? light.width : light.height;
	const circle = ( middle, first, from, count, turn ) => Array.from( { length: count }, ( _, i ) => {
		const angle = from + turn * i / ( count - 1 );
		return plus( middle, scaled( first, radius * Math.cos( angle ) ), scaled( unit( cross( way, first ), first ), radius * Math.sin( angle ) ) );
	} );
	if ( light.shape === 'sphere' ) return circle( centre, unit( cross( [ 0, 1, 0 ], way ), [ 1, 0, 0 ] ), 0, 33, 2 * Math.PI );
	// A tube or line has half a circle around each end, perpendicular to the direction to the eye.
	const across = unit( plus( along, scaled( way, - dot( along, way ) ) ), [ 1, 0, 0 ] );
	return [ ...circle( ends[ 0 ], across, Math.PI / 2, 9, Math.PI ), ...circle( ends[ 1 ], across, - Math.PI / 2, 9, Math.PI ) ];
}

/** The uniforms of the lights, and `shapes`, which has a bit for each shape in the scene and a bit for pictures. The pictures are layers of a texture, in the order of their lights. */
export function uniformsOf( lights ) {
	const four = ( v, w = 0 ) => [ ...v, w ];
	const made = { light_count: lights.length, light_shape: [], light_two_sided: [], light_picture: [], light_corners: [], light_radiance: [], light_centre: [], light_x: [], light_y: [], light_normal: [], light_vertices: [] };
	let layers = 0;
	for ( const light of lights ) {
		const { centre, normal, along, across, vertices, ends } = placed( light );
		const shape = { disk: 1, sphere: 2, tube: 2, line: 3 }[ light.shape ] ?? 0;
		const isSolid = shape > 1;
		const [ start, end ] = light.shape === 'sphere' ? [ centre, centre ] : ends;
		const triangle = ( i ) => Math.hypot( ...cross( plus( vertices[ i - 1 ], scaled( vertices[ 0 ], - 1 ) ), plus( vertices[ i ], scaled( vertices[ 0 ], - 1 ) ) ) ) / 2;
		const upTo = vertices.reduce( ( sums, _, i ) => [ ...sums, i < 2 ? 0 : sums[ i - 1 ] + triangle( i ) ], [] );
		const area = upTo.at( - 1 ) || 1;
		made.light_shape.push( shape );
		made.light_picture.push( isPictured( light ) ? layers ++ : - 1 );
		made.light_corners.push( vertices.length );
		made.light_two_sided.push( Number( light.sides === 'both' && isFlat( light ) ) );
		made.light_radiance.push( linear( light.colour ).map( ( channel ) => light.intensity * channel ) );
		made.light_centre.push( four( isSolid ? start : centre, { sphere: light.width, tube: light.height, line: 2 * light.height }[ light.shape ] ) );
		made.light_x.push( isSolid ? four( end ) : four( along, 1 / dot( along, along ) ) );
		made.light_y.push( four( across, 1 / dot( across, across ) ) );
		made.light_normal.push( four( normal, area ) );
		for ( let i = 0; i < 8; i ++ ) made.light_vertices.push( four( vertices[ i ] || [ 0, 0, 0 ], ( upTo[ i ] || 0 ) / area ) );
	}
	return { uniforms: made, shapes: made.light_shape.reduce( ( bits, shape ) => bits | 1 << shape, layers && 16 ) };
}

/** The uniforms of the occluders: a ball, and a box next to it or in its place. */
export function occludersOf( { occluders, occluder_x: x, occluder_y: y, occluder_z: z, occluder_size: half } ) {
	const centre = [ occluders === 'box' ? x : x + 3 * half, y, z ];
	const isBox = occluders.includes( 'box' );
	return { ball: [ x, y, z, occluders.includes( 'ball' ) ? half : 0 ], box_low: centre.map( ( at ) => at - isBox * half ), box_high: centre.map( ( at ) => at + isBox * half ) };
}

/** A camera that looks at the origin: position `eye`, unit vector `forward`, and `right` and `up` from the centre of the image to its edges at distance one. */
export function camera( { camera_azimuth: azimuth, camera_elevation: elevation, camera_distance: distance } ) {
	const back = [ Math.sin( azimuth ) * Math.cos( elevation ), Math.sin( elevation ), Math.cos( azimuth ) * Math.cos( elevation ) ];
	const right = [ Math.cos( azimuth ), 0, - Math.sin( azimuth ) ];
	const half = Math.tan( FIELD_OF_VIEW / 2 );
	return { eye: scaled( back, distance ), forward: scaled( back, - 1 ), right: scaled( right, half ), up: scaled( cross( back, right ), half ), half };
}

/** Projects a point to the image, which is a square from -1 to 1, and adds its distance. Returns null for a point behind the camera. */
export function projected( { eye, forward, right, up, half }, point ) {
	const way = plus( point, scaled( eye, - 1 ) );
	const distance = dot( way, forward );
	return distance > 1e-3 ? { x: dot( way, right ) / ( half * half * distance ), y: dot( way, up ) / ( half * half * distance ), distance } : null;
}

/** The vector by which a point moves in the scene if it moves by x and y in the image. */
export function moved( { right, up }, distance, x, y ) {
	return plus( scaled( right, x * distance ), scaled( up, y * distance ) );
}
