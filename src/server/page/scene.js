// The viewer's scene: its parameters, which are those of previews, and the numbers that the shader reads of them.

/** Parameters: their names in a link and in `/v1/preview`, labels, bounds, steps and defaults. */
export const PARAMETERS = [
	[ 'alpha_x', 'Roughness along', 0.01, 1, 0.01, 0.5 ],
	[ 'alpha_y', 'Roughness across', 0.01, 1, 0.01, 0.1 ],
	[ 'rotation', 'Rotation', - 3.14, 3.14, 0.01, 0 ],
	[ 'light_x', 'Light, right', - 5, 5, 0.01, - 1.3 ],
	[ 'light_y', 'Light, up', - 1, 5, 0.01, 1.4 ],
	[ 'light_z', 'Light, near', - 5, 5, 0.01, 1.2 ],
	[ 'light_width', 'Light, half width', 0.05, 3, 0.01, 0.7 ],
	[ 'light_height', 'Light, half height', 0.05, 3, 0.01, 0.45 ],
	[ 'light_intensity', 'Radiance', 0.1, 20, 0.1, 3 ],
	[ 'camera_azimuth', 'Camera, around', - 3.14, 3.14, 0.01, 0 ],
	[ 'camera_elevation', 'Camera, up', - 1.5, 1.5, 0.01, 0.2 ],
	[ 'camera_distance', 'Camera, distance', 2, 16, 0.01, 9 ],
	[ 'exposure', 'Exposure', 0.1, 8, 0.01, 1 ],
].map( ( [ name, label, min, max, step, value ] ) => ( { name, label, min, max, step, value } ) );

/** Reflectances at normal incidence, linear sRGB. */
export const METALS = { silver: [ 0.91, 0.92, 0.92 ], gold: [ 1, 0.71, 0.29 ], copper: [ 0.95, 0.64, 0.54 ], plastic: [ 0.04, 0.04, 0.04 ] };

/** Choices beside the numbers; the first of each is the default. */
export const CHOICES = {
	surface: [ 'sphere', 'floor' ],
	metal: Object.keys( METALS ),
	show: [ 'split', 'model', 'reference', 'difference' ],
};

/** The whole angle of view, of scene `sphere`. */
const FIELD_OF_VIEW = 0.5;

const dot = ( a, b ) => a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];
const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];
const scaled = ( v, by ) => v.map( ( x ) => x * by );
const plus = ( ...vectors ) => vectors.reduce( ( a, b ) => a.map( ( x, i ) => x + b[ i ] ) );
const unit = ( v, otherwise ) => dot( v, v ) > 1e-24 ? scaled( v, 1 / Math.sqrt( dot( v, v ) ) ) : otherwise;

/** A scene from a link's parameters; what is missing or malformed is the default, what is out of bounds the bound. */
export function read( parameters ) {

	const scene = { table: parameters.get( 'table' ) || '', split: 0.5 };
	for ( const { name, min, max, value } of PARAMETERS ) {

		const given = parameters.has( name ) ? Number( parameters.get( name ) ) : value;
		scene[ name ] = Number.isFinite( given ) ? Math.min( max, Math.max( min, given ) ) : value;

	}

	for ( const [ name, options ] of Object.entries( CHOICES ) ) scene[ name ] = options.includes( parameters.get( name ) ) ? parameters.get( name ) : options[ 0 ];
	return scene;

}

/** The parameters of a link: those that are not the defaults. */
export function link( scene ) {

	const changed = PARAMETERS.filter( ( { name, value } ) => scene[ name ] !== value ).map( ( { name } ) => [ name, scene[ name ] ] );
	const chosen = Object.entries( CHOICES ).filter( ( [ name, [ first ] ] ) => scene[ name ] !== first ).map( ( [ name ] ) => [ name, scene[ name ] ] );
	return new URLSearchParams( [ ...( scene.table ? [ [ 'table', scene.table ] ] : [] ), ...chosen, ...changed ] );

}

/** The light's corners, clockwise as seen from the lit side, which faces the origin, and its normal. */
export function light( { light_x, light_y, light_z, light_width, light_height } ) {

	const centre = [ light_x, light_y, light_z ];
	const normal = unit( scaled( centre, - 1 ), [ 0, 0, 1 ] );
	const right = unit( cross( [ 0, 1, 0 ], normal ), [ 1, 0, 0 ] );
	const up = cross( normal, right );
	const corner = ( x, y ) => plus( centre, scaled( right, x * light_width ), scaled( up, y * light_height ) );
	return { centre, normal, area: 4 * light_width * light_height, corners: [ corner( - 1, 1 ), corner( 1, 1 ), corner( 1, - 1 ), corner( - 1, - 1 ) ] };

}

/** The camera, which looks at the origin: its place, and the way to the middle, right and upper edges of the image at distance one. */
export function camera( { camera_azimuth: azimuth, camera_elevation: elevation, camera_distance: distance } ) {

	const back = [ Math.sin( azimuth ) * Math.cos( elevation ), Math.sin( elevation ), Math.cos( azimuth ) * Math.cos( elevation ) ];
	const right = [ Math.cos( azimuth ), 0, - Math.sin( azimuth ) ];
	const half = Math.tan( FIELD_OF_VIEW / 2 );
	return { eye: scaled( back, distance ), forward: scaled( back, - 1 ), right: scaled( right, half ), up: scaled( cross( back, right ), half ), half };

}

/** Where a point is seen, in the square from -1 to 1, and how far; null behind the camera. */
export function seen( { eye, forward, right, up, half }, point ) {

	const way = plus( point, scaled( eye, - 1 ) );
	const distance = dot( way, forward );
	return distance > 1e-3 ? { x: dot( way, right ) / ( half * half * distance ), y: dot( way, up ) / ( half * half * distance ), distance } : null;

}

/** How far a point at a distance moves in the scene as it moves in the square. */
export function moved( { right, up }, distance, x, y ) {

	return plus( scaled( right, x * distance ), scaled( up, y * distance ) );

}
