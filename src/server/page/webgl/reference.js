// The reference in GLSL ES, by Monte Carlo integration. Each sample takes a direction from the BRDF and a point on each light,
// weighted by the balance heuristic [Veach and Guibas 1995]. The code follows shaders/ggx_reference.wgsl.
// Even and odd samples have sums of their own.

import { LIGHTS, SAMPLED_LIGHTS } from './lights.js';
import { PRECISE, SURFACE_POINT } from './surface.js';

const SAMPLING = `
uint hash( uint key ) {
	uint x = key;
	x = ( x ^ ( x >> 16u ) ) * 0x7feb352du;
	x = ( x ^ ( x >> 15u ) ) * 0x846ca68bu;
	return x ^ ( x >> 16u );
}
vec2 point( uint i, uvec2 seed ) { return vec2( ( uvec2( i * 0xc13fa9a9u, i * 0x91e10da5u ) + seed ) >> uvec2( 8u ) ) / 16777216.0; }
vec3 fresnel( vec3 f0, float cosine ) { float m = clamp( 1.0 - cosine, 0.0, 1.0 ); return mix( f0, vec3( 1.0 ), m * m * m * m * m ); }
`;

/** GGX, sampled by visible normals [Dupuy and Benyoub 2023]. */
const GGX = `
float lambda( vec2 alpha, vec3 w ) { vec2 t = alpha * w.xy / w.z; return 0.5 * ( sqrt( 1.0 + dot( t, t ) ) - 1.0 ); }
float distribution( vec2 alpha, vec3 wm ) {
	vec2 t = wm.xy / alpha;
	float q = dot( t, t ) + wm.z * wm.z;
	return 1.0 / ( 3.14159265 * alpha.x * alpha.y * q * q );
}
vec3 sampled_direction( Shaded at, vec2 u ) {
	vec3 standard = normalize( vec3( at.alpha * at.wo.xy, at.wo.z ) );
	float z = ( 1.0 - u.y ) * ( 1.0 + standard.z ) - standard.z;
	float radius = sqrt( max( 1.0 - z * z, 0.0 ) );
	vec3 wm = vec3( radius * cos( 6.2831853 * u.x ), radius * sin( 6.2831853 * u.x ), z ) + standard;
	wm = normalize( vec3( at.alpha * wm.xy, max( wm.z, 0.0 ) ) );
	return 2.0 * dot( at.wo, wm ) * wm - at.wo;
}
/** x: BRDF times cosine. y: density of wi in sampled_direction. */
vec2 scattered( Shaded at, vec3 wm, vec3 wi ) {
	float lambda_o = lambda( at.alpha, at.wo );
	float of_brdf = distribution( at.alpha, wm ) / ( 4.0 * at.wo.z * ( 1.0 + lambda_o ) );
	return vec2( of_brdf * ( 1.0 + lambda_o ) / ( 1.0 + lambda_o + lambda( at.alpha, wi ) ), of_brdf );
}
`;

/** Sheen: distribution Charlie [Estevez and Kulla 2017] with a visibility term. Directions are sampled with a density proportional to the cosine. */
const sheen = ( visibility ) => `
vec3 sampled_direction( Shaded at, vec2 u ) {
	float radius = sqrt( u.x );
	return vec3( radius * cos( 6.2831853 * u.y ), radius * sin( 6.2831853 * u.y ), sqrt( 1.0 - u.x ) );
}
${ visibility }
vec2 scattered( Shaded at, vec3 wm, vec3 wi ) {
	float alpha = max( max( at.alpha.x, at.alpha.y ), 0.0049 );
	float distribution = ( 2.0 + 1.0 / alpha ) * pow( max( dot( wm.xy, wm.xy ), 1e-36 ), 0.5 / alpha ) / 6.2831853;
	return vec2( distribution * visibility( alpha, at.wo.z, wi.z ) * wi.z, wi.z / 3.14159265 );
}
`;

const ESTEVEZ = `
float log_lambda( float rough, float x ) {
	vec4 s = mix( vec4( 25.3245, 3.32435, 0.16801, - 1.27393 ), vec4( 21.5473, 3.82987, 0.19823, - 1.97760 ), rough );
	return s.x / ( 1.0 + s.y * pow( max( x, 1e-9 ), s.z ) ) + s.w * x + mix( - 4.85967, - 4.32054, rough );
}
float smith( float alpha, float cosine ) {
	float rough = 1.0 - ( 1.0 - alpha ) * ( 1.0 - alpha );
	return exp( cosine < 0.5 ? log_lambda( rough, cosine ) : 2.0 * log_lambda( rough, 0.5 ) - log_lambda( rough, max( 1.0 - cosine, 0.0 ) ) );
}
float visibility( float alpha, float o, float i ) { return 1.0 / ( 4.0 * o * i * ( 1.0 + smith( alpha, o ) + smith( alpha, i ) ) ); }
`;

const NEUBELT = 'float visibility( float alpha, float o, float i ) { return 0.25 / ( o + i - o * i ); }';
/** The scattering models that the reference supports. */
const BRDFS = { ggx: GGX, charlie: sheen( ESTEVEZ ), charlie_neubelt: sheen( NEUBELT ) };
/** Whether the reference supports a scattering model. */
export const hasReference = ( brdf ) => Object.hasOwn( BRDFS, brdf );

const SUM = `
uniform sampler2D even_before, odd_before;
uniform int size, first, samples;
layout( location = 0 ) out vec4 even_sum;
layout( location = 1 ) out vec4 odd_sum;

/** The light of sample i. The four seeds shift its points. */
vec3 sampled( Shaded at, uint i, uvec4 seed ) {
	vec3 sum = vec3( 0.0 );
	vec3 wi = sampled_direction( at, point( i, seed.xy ) );
	if ( wi.z > HORIZON ) {
		vec3 wm = normalize( at.wo + wi );
		vec2 found = scattered( at, wm, wi );
		vec3 towards = at.x * wi.x + at.y * wi.y + at.z * wi.z;
		for ( int l = 0; l < light_count; l ++ ) {
			float of_light = light_pdf( l, at.position, towards );
			if ( of_light >= 0.0 && found.y > 0.0 ) sum += fresnel( at.f0, dot( at.wo, wm ) ) * emitted( l, at.position, towards ) * ( found.x / ( found.y + of_light ) );
		}
	}
	for ( int l = 0; l < light_count; l ++ ) {
		vec4 of_light = light_sample( l, at.position, point( i, seed.zw ) );
		wi = vec3( dot( of_light.xyz, at.x ), dot( of_light.xyz, at.y ), dot( of_light.xyz, at.z ) );
		if ( wi.z > HORIZON && of_light.w > 0.0 ) {
			vec3 wm = normalize( at.wo + wi );
			vec2 found = scattered( at, wm, wi );
			// Directions of the BRDF never hit a line.
			float of_both = of_light.w + ( is_shape( l, 3 ) ? 0.0 : found.y );
			sum += fresnel( at.f0, dot( at.wo, wm ) ) * emitted( l, at.position, of_light.xyz ) * ( found.x / of_both );
		}
	}
	return sum;
}

/** Four seeds, each the hash of the one before. */
uvec4 seeds( uint key ) {
	uint a = hash( key ), b = hash( a ^ 0x9e3779b9u ), c = hash( b ^ 0x9e3779b9u );
	return uvec4( a, b, c, hash( c ^ 0x9e3779b9u ) );
}

void main() {
	Shaded at = shaded_point();
	ivec2 texel = ivec2( gl_FragCoord.xy );
	even_sum = first > 0 ? texelFetch( even_before, texel, 0 ) : vec4( 0.0 );
	odd_sum = first > 0 ? texelFetch( odd_before, texel, 0 ) : vec4( 0.0 );
	if ( at.coverage <= 0.0 ) return;
	uvec4 even = seeds( uint( ( size - 1 - texel.y ) * size + texel.x ) );
	// The halves are independent, so their difference shows the noise.
	uvec4 odd = seeds( even.w ^ 0x9e3779b9u );
	for ( int i = first; i < first + samples; i += 2 ) {
		even_sum += at.coverage * vec4( sampled( at, uint( i / 2 ), even ), 1.0 );
		odd_sum += at.coverage * vec4( sampled( at, uint( i / 2 ), odd ), 1.0 );
	}
}`;

/** The fragment shader that adds samples of a scattering model. `shapes` has a bit for each shape of the lights. */
export function referenceShader( brdf, shapes ) {
	return `#version 300 es\n${ PRECISE }#define SHAPES_USED ${ shapes }\n${ SURFACE_POINT }${ LIGHTS }${ SAMPLED_LIGHTS }${ SAMPLING }${ BRDFS[ brdf ] }${ SUM }`;
}
