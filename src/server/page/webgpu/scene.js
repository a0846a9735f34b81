// The numbers of a scene in WGSL: one structure that all programs read, with the names that the uniforms of WebGL have.

const FIELDS = Object.entries( {
	eye: 'vec3<f32>', right: 'vec3<f32>', up: 'vec3<f32>', forward: 'vec3<f32>', f0: 'vec3<f32>', base: 'vec3<f32>', material: 'vec4<f32>', factors: 'vec4<f32>',
	size: 'i32', surface: 'i32', show: 'i32', first: 'i32', samples: 'i32', light_count: 'i32',
	pixel_width: 'f32', exposure: 'f32', split: 'f32', difference_scale: 'f32', left_weight: 'f32', right_weight: 'f32', picture_base: 'f32', normal_scale: 'f32', is_white: 'f32',
	light_shape: 'vec4<i32>', light_corners: 'vec4<i32>', light_picture: 'vec4<i32>', light_radiance: 'vec4<f32>',
	light_centre: 'array<vec4<f32>, 4>', light_x: 'array<vec4<f32>, 4>', light_y: 'array<vec4<f32>, 4>', light_normal: 'array<vec4<f32>, 4>',
	light_vertices: 'array<vec4<f32>, 32>',
} );

/** How many numbers a field has. */
const numbersOf = ( type ) => type.startsWith( 'array' ) ? 4 * Number( type.match( /(\d+)>$/ )[ 1 ] ) : Number( type.match( /^vec(\d)/ )?.[ 1 ] || 1 );

/** Where each field begins, in numbers, by the rules of WGSL: a vector at a multiple of four. */
const PLACES = new Map();
let end = 0;
for ( const [ name, type ] of FIELDS ) {

	const count = numbersOf( type );
	if ( count > 1 ) end = Math.ceil( end / 4 ) * 4;
	PLACES.set( name, { at: end, isWhole: type.includes( 'i32' ) } );
	end += count;

}

const WORDS = Math.ceil( end / 4 ) * 4;

/** The structure, which is bound first in group 1. */
export const SCENE = `
struct Scene {
${ FIELDS.map( ( [ name, type ] ) => `	${ name }: ${ type },` ).join( '\n' ) }
}
@group(1) @binding(0) var<uniform> scene: Scene;
`;

/** The bytes of the structure with these values, by the names of its fields; others are left out. */
export function packed( values ) {

	const buffer = new ArrayBuffer( 4 * WORDS );
	const [ floats, whole ] = [ new Float32Array( buffer ), new Int32Array( buffer ) ];
	for ( const [ name, value ] of Object.entries( values ) ) {

		const place = PLACES.get( name );
		if ( place ) ( place.isWhole ? whole : floats ).set( [ value ].flat( 2 ), place.at );

	}

	return buffer;

}
