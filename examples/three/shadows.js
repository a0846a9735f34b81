// Shadows of boxes and spheres under an area light over brushed metal, traced in the fragment shader. The page draws a frame when
// an option changes. ?width=960&height=640 sets the size.

import * as THREE from 'three';

import { cornersOf, lightsOf } from '../common/scene.js';
import normals from './shaders/normals_balanced.glsl.js';
import samplers from './shaders/samplers.glsl.js';

const [ lamp ] = lightsOf( 1 );
/** Centre and radius. */
const spheres = [ [ - 0.75, 0.28, - 0.1, 0.28 ], [ 0.15, 0.16, 0.65, 0.16 ], [ 0.3, 0.75, - 0.7, 0.14 ] ];
/** Lower corner and upper corner. */
const boxes = [ [ [ 0.55, 0, - 0.4 ], [ 0.95, 0.7, 0 ] ], [ [ - 0.5, 0, - 1.1 ], [ - 0.4, 0.5, - 0.6 ] ] ];

const vector = ( values ) => `vec${ values.length }( ${ values.map( ( value ) => value.toFixed( 6 ) ).join( ', ' ) } )`;
const array = ( type, name, values ) => `const ${ type } ${ name }[ ${ values.length } ] = ${ type }[ ${ values.length } ]( ${ values.map( vector ).join( ', ' ) } );`;

const fragmentShader = /* glsl */ `
	${ normals }
	${ samplers }

	uniform vec2 size;
	uniform mat3 camera; // right, up, back
	uniform vec3 eye;
	uniform float halfHeight;
	uniform vec3 corners[ 4 ];
	uniform int rays;
	uniform int way; // as in shadows.html
	uniform bool toScreen;
	out vec4 colour;

	${ array( 'vec4', 'spheres', spheres ) }
	${ array( 'vec3', 'lows', boxes.map( ( [ low ] ) => low ) ) }
	${ array( 'vec3', 'highs', boxes.map( ( [ , high ] ) => high ) ) }
	const vec3 radiance = ${ vector( lamp.radiance ) };
	const vec2 alpha = vec2( 0.25, 0.06 );
	const vec3 f0 = vec3( 0.75, 0.76, 0.78 );

	// PCG [O'Neill 2014].
	uint random( uint seed ) {

		uint state = seed * 747796405u + 2891336453u;
		uint word = ( ( state >> ( ( state >> 28u ) + 4u ) ) ^ state ) * 277803737u;
		return ( word >> 22u ) ^ word;

	}

	// The distance to the first solid on a ray, and its normal there. Solids that contain the start are skipped.
	float solid( vec3 from, vec3 ray, out vec3 normal ) {

		float nearest = 1e9;
		for ( int i = 0; i < spheres.length(); i ++ ) {

			vec3 to = spheres[ i ].xyz - from;
			float along = dot( to, ray );
			vec3 off = to - along * ray;
			float half2 = spheres[ i ].w * spheres[ i ].w - dot( off, off );
			float at = along - sqrt( max( half2, 0.0 ) );
			if ( half2 > 0.0 && at > 0.0 && at < nearest ) {

				nearest = at;
				normal = ( from + at * ray - spheres[ i ].xyz ) / spheres[ i ].w;

			}

		}

		for ( int i = 0; i < lows.length(); i ++ ) {

			vec3 first = ( lows[ i ] - from ) / ray;
			vec3 second = ( highs[ i ] - from ) / ray;
			vec3 enter = min( first, second );
			vec3 leave = max( first, second );
			float at = max( enter.x, max( enter.y, enter.z ) );
			if ( at > 0.0 && at < min( leave.x, min( leave.y, leave.z ) ) && at < nearest ) {

				nearest = at;
				normal = - sign( ray ) * vec3( equal( enter, vec3( at ) ) );

			}

		}

		return nearest;

	}

	// GGX with Schlick's factor f, times the cosine of wi.
	vec3 reflected( vec3 wo, vec3 wi ) {

		vec3 h = normalize( wo + wi );
		vec3 slope = vec3( h.xy / alpha, h.z );
		float steep = dot( slope, slope );
		float d = 1.0 / ( 3.14159265 * alpha.x * alpha.y * steep * steep );
		float lengths = wi.z * length( vec3( alpha * wo.xy, wo.z ) ) + wo.z * length( vec3( alpha * wi.xy, wi.z ) );
		return mix( f0, vec3( 1.0 ), pow( 1.0 - dot( wo, h ), 5.0 ) ) * ( 0.5 * d * wi.z / lengths );

	}

	vec3 shaded( vec3 point, vec3 normal, vec3 to_eye ) {

		// Brushed along x. On a plane across x, along z.
		vec3 tangent = abs( normal.x ) > 0.99 ? vec3( 0.0, 0.0, 1.0 ) : normalize( vec3( 1.0, 0.0, 0.0 ) - normal.x * normal );
		mat3 frame = mat3( tangent, cross( normal, tangent ), normal );
		vec3 wo = to_eye * frame;
		wo = normalize( vec3( wo.xy, max( wo.z, 1e-3 ) ) );
		vec3 local[ 4 ];
		for ( int i = 0; i < 4; i ++ ) local[ i ] = ( corners[ i ] - point ) * frame;

		SamplerRectangle rectangle;
		if ( way == 3 ) rectangle = sampler_ltc( mat3( 1.41421356, 0.0, 0.0, 0.0, 1.41421356, 0.0, 0.0, 0.0, 1.0 ), local, false );
		else rectangle = sampler_normals( alpha.x, alpha.y, wo, local, false );

		vec3 lamp_normal = normalize( cross( corners[ 3 ] - corners[ 0 ], corners[ 1 ] - corners[ 0 ] ) );
		vec3 all = vec3( 0.0 );
		vec3 seen = vec3( 0.0 );
		uvec2 pixel = uvec2( gl_FragCoord.xy );
		uint first = random( pixel.y * 4096u + pixel.x );
		vec2 shift = vec2( float( first >> 8u ), float( random( first ^ 0x9e3779b9u ) >> 8u ) ) * 5.9604645e-8;
		for ( int i = 0; i < rays; i ++ ) {

			// Points of the R2 sequence [Roberts 2018], moved in each pixel.
			vec2 u = fract( shift + float( i ) * vec2( 0.7548776662, 0.5698402910 ) );
			SamplerDrawn drawn = sampler_draw( rectangle, u );
			if ( drawn.pdf <= 0.0 || drawn.wi.z <= 0.0 ) continue;
			vec3 weighted = reflected( wo, drawn.wi ) / drawn.pdf;
			vec3 ray = frame * drawn.wi;
			vec3 unused;
			float far = dot( corners[ 0 ] - point, lamp_normal ) / dot( ray, lamp_normal );
			all += weighted;
			if ( solid( point + 1e-4 * normal, ray, unused ) > far ) seen += weighted;

		}

		float count = float( rays );
		if ( way >= 2 ) return radiance * seen / count;
		NormalsView view = normals_view( alpha.x, alpha.y, wo );
		vec2 energy = normals_rectangle( view, local, false );
		vec3 light = f0 * ( energy.x - energy.y ) + energy.y;
		// A sum of hidden light above the analytic light gives a negative pixel.
		if ( way == 1 ) return radiance * max( sampler_minus_hidden( light, all - seen, count ), vec3( 0.0 ) );
		return radiance * sampler_by_ratio( light, seen, all );

	}

	void main() {

		vec2 place = ( 2.0 * gl_FragCoord.xy - size ) / size.y * halfHeight;
		vec3 ray = normalize( camera * vec3( place, - 1.0 ) );
		vec3 normal;
		float nearest = solid( eye, ray, normal );
		float floor_at = - eye.y / ray.y;
		if ( floor_at > 0.0 && floor_at < nearest ) {

			nearest = floor_at;
			normal = vec3( 0.0, 1.0, 0.0 );

		}

		colour = vec4( 0.0, 0.0, 0.0, 1.0 );
		vec3 across = corners[ 3 ] - corners[ 0 ];
		vec3 up = corners[ 1 ] - corners[ 0 ];
		vec3 lamp_normal = normalize( cross( across, up ) );
		float lamp_at = dot( corners[ 0 ] - eye, lamp_normal ) / dot( ray, lamp_normal );
		vec3 on = eye + lamp_at * ray - corners[ 0 ];
		vec2 part = vec2( dot( on, across ) / dot( across, across ), dot( on, up ) / dot( up, up ) );
		bool is_lamp = lamp_at > 0.0 && lamp_at < nearest && all( equal( part, clamp( part, 0.0, 1.0 ) ) );
		if ( is_lamp ) colour.rgb = radiance;
		else if ( nearest < 12.0 ) colour.rgb = shaded( eye + nearest * ray, normal, - ray );
		if ( toScreen ) colour.rgb = mix( 12.92 * colour.rgb, 1.055 * pow( max( colour.rgb, 0.0 ), vec3( 1.0 / 2.4 ) ) - 0.055, greaterThan( colour.rgb, vec3( 0.0031308 ) ) );

	}
`;

const query = new URLSearchParams( location.search );
const [ width, height ] = [ [ 'width', 960 ], [ 'height', 640 ] ].map( ( [ name, usual ] ) => Number( query.get( name ) || usual ) );
const renderer = new THREE.WebGLRenderer();
renderer.setSize( width, height );
document.querySelector( 'main' ).append( renderer.domElement );

const eye = new THREE.Vector3( 0, 1.7, 3.4 );
const looking = new THREE.Matrix4().lookAt( eye, new THREE.Vector3( 0, 0.25, - 0.4 ), new THREE.Vector3( 0, 1, 0 ) );
const uniforms = Object.fromEntries( Object.entries( {
	size: new THREE.Vector2( width, height ), camera: new THREE.Matrix3().setFromMatrix4( looking ), eye, halfHeight: Math.tan( 21 * Math.PI / 180 ),
	corners: cornersOf( lamp ).map( ( corner ) => new THREE.Vector3( ...corner ) ), rays: 4, way: 0, toScreen: true,
} ).map( ( [ name, value ] ) => [ name, { value } ] ) );
const material = new THREE.RawShaderMaterial( {
	uniforms, glslVersion: THREE.GLSL3, depthTest: false, fragmentShader,
	vertexShader: 'in vec3 position; void main() { gl_Position = vec4( position, 1.0 ); }',
} );
const screen = new THREE.Mesh( new THREE.PlaneGeometry( 2, 2 ), material );
screen.frustumCulled = false;
const camera = new THREE.Camera();

function draw() {

	uniforms.rays.value = Number( document.querySelector( '#rays' ).value );
	uniforms.way.value = Number( document.querySelector( '#way' ).value );
	renderer.render( screen, camera );

}

document.querySelectorAll( 'select' ).forEach( ( select ) => select.addEventListener( 'change', draw ) );
draw();

/** A picture as linear radiance, for tests: four floats a pixel, from the bottom left. */
window.radianceOf = ( rays, way ) => {

	Object.entries( { rays, way, toScreen: false } ).forEach( ( [ name, value ] ) => uniforms[ name ].value = value );
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	renderer.setRenderTarget( target );
	renderer.render( screen, camera );
	const pixels = new Float32Array( 4 * width * height );
	renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
	renderer.setRenderTarget( null );
	target.dispose();
	uniforms.toScreen.value = true;
	return Array.from( pixels );

};
