// The final image in GLSL ES, the lights as the camera sees them, and the errors of both sides.

import { LIGHTS, SAMPLED_LIGHTS } from './lights.js';
import { PRECISE } from './surface.js';

const HEAD = `#version 300 es\n${ PRECISE }`;

/** Both sides and the truth: sums over frames. A weight is the reciprocal of the number of frames or samples. */
const SIDES = `
uniform sampler2D left_sum, right_sum, even_sum, odd_sum;
uniform float model_weight, truth_weight;
/** Whether the right side is a model. Otherwise it is the truth. */
uniform int has_right;
vec4 left_of( ivec2 texel ) { return texelFetch( left_sum, texel, 0 ) * model_weight; }
vec4 truth_of( ivec2 texel ) { return ( texelFetch( even_sum, texel, 0 ) + texelFetch( odd_sum, texel, 0 ) ) * truth_weight; }
vec4 right_of( ivec2 texel ) { return has_right != 0 ? texelFetch( right_sum, texel, 0 ) * model_weight : truth_of( texel ); }
float mean( vec4 colour ) { return dot( colour.rgb, vec3( 1.0 / 3.0 ) ); }
`;

/** Adds the lights in front of the surface, with four rays per pixel, to a sum over frames. The back of a light is dark. */
export const glowShader = ( shapes ) => `${ HEAD }#define SHAPES_USED ${ shapes }
${ LIGHTS }${ SAMPLED_LIGHTS }
uniform sampler2D surface_position, sum_before;
uniform vec3 eye, right, up, forward;
uniform int size, sum_count;
out vec4 sum;
void main() {
	ivec2 texel = ivec2( gl_FragCoord.xy );
	vec4 place = texelFetch( surface_position, texel, 0 );
	float far = place.w > 0.5 ? distance( place.xyz, eye ) : 1e9;
	sum = sum_count > 0 ? texelFetch( sum_before, texel, 0 ) : vec4( 0.0 );
	for ( int i = 0; i < 4; i ++ ) {
		vec2 at = ( gl_FragCoord.xy + vec2( ( i & 1 ) == 0 ? - 0.25 : 0.25, i < 2 ? - 0.25 : 0.25 ) ) / float( size ) * 2.0 - 1.0;
		vec3 ray = normalize( forward + right * at.x + up * at.y );
		float nearest = far;
		vec4 seen = vec4( 0.0 );
		for ( int l = 0; l < light_count; l ++ ) {
			vec2 hit = is_solid( l ) ? tube_hit( l, eye, ray ) : flat_hit( l, eye, ray );
			if ( hit.x <= 0.0 || hit.x >= nearest ) continue;
			nearest = hit.x;
			seen = vec4( is_solid( l ) || hit.y > 0.0 ? emitted( l, eye, ray ) : vec3( 0.01 ), 1.0 );
		}
		sum += 0.25 * seen;
	}
}`;

/** Shows the left side, the right side, both, or their difference in false colours. Uses the tone curve of src/view/preview/tone.rs. */
export const DISPLAY_SHADER = `${ HEAD }${ SIDES }
uniform sampler2D glow_sum, diffuse_sum;
uniform int size, show, has_glow, has_diffuse;
uniform float exposure, split, difference_scale;
out vec4 colour;
const vec3 BACKGROUND = vec3( 0.02 );
/** The signed colours of src/view/picture/colours.rs. */
const vec3 STOPS[5] = vec3[5]( vec3( 0.004, 0.03, 0.25 ), vec3( 0.08, 0.32, 0.72 ), vec3( 0.72 ), vec3( 0.74, 0.22, 0.08 ), vec3( 0.25, 0.006, 0.01 ) );

vec3 srgb( vec3 y ) { return mix( 1.055 * pow( max( y, vec3( 0.003 ) ), vec3( 1.0 / 2.4 ) ) - 0.055, 12.92 * y, lessThanEqual( y, vec3( 0.0031308 ) ) ); }

void main() {
	ivec2 texel = ivec2( gl_FragCoord.xy );
	vec4 left = left_of( texel ), right = right_of( texel );
	vec3 shown;
	if ( show == 3 ) {
		float place = 2.0 + 2.0 * clamp( ( mean( left ) - mean( right ) ) / difference_scale, - 1.0, 1.0 );
		int lower = min( int( place ), 3 );
		shown = mix( BACKGROUND, mix( STOPS[lower], STOPS[lower + 1], place - float( lower ) ), left.w );
	} else {
		vec4 side = show == 2 || ( show == 0 && gl_FragCoord.x >= split * float( size ) ) ? right : left;
		if ( has_diffuse != 0 ) side.rgb += texelFetch( diffuse_sum, texel, 0 ).rgb * model_weight;
		shown = side.rgb + BACKGROUND * ( 1.0 - side.w );
		if ( has_glow != 0 ) {
			vec4 glow = texelFetch( glow_sum, texel, 0 ) * model_weight;
			shown = shown * ( 1.0 - glow.a ) + glow.rgb;
		}
		shown = vec3( 1.0 ) - exp( - exposure * max( shown, vec3( 0.0 ) ) );
	}
	colour = vec4( clamp( srgb( shown ), 0.0, 1.0 ), 1.0 );
}`;

/**
 * Errors of both sides against the truth, one texel for each block of pixels. The sign of an error comes from one half of the truth,
 * and its amount from the other half, so noise adds nothing to the mean.
 */
export const ERRORS_SHADER = `${ HEAD }${ SIDES }
uniform sampler2D surface_position;
/** The number of the mesh to measure, or -1 for all. */
uniform int size, block, number;
/** Sums: pixels, truth, error of the left side, error of the right side. */
layout( location = 0 ) out vec4 sums;
/** Largest error of the left and of the right side, sum of the squared noise, largest difference of both sides. */
layout( location = 1 ) out vec4 others;

vec2 error_of( float value, float even, float odd ) {
	vec2 off = value - vec2( even, odd );
	return vec2( 0.5 * dot( sign( off ), off.yx ), off.x * off.y > 0.0 ? min( abs( off.x ), abs( off.y ) ) : 0.0 );
}

void main() {
	sums = others = vec4( 0.0 );
	ivec2 start = ivec2( gl_FragCoord.xy ) * block;
	for ( int y = start.y; y < min( start.y + block, size ); y ++ ) for ( int x = start.x; x < min( start.x + block, size ); x ++ ) {
		ivec2 texel = ivec2( x, y );
		vec4 left = left_of( texel ), right = right_of( texel );
		// A pixel at an edge has the light of several surfaces.
		if ( left.w < 0.999 || number >= 0 && int( texelFetch( surface_position, texel, 0 ).w ) != 1 + number ) continue;
		float even = mean( texelFetch( even_sum, texel, 0 ) ) * 2.0 * truth_weight, odd = mean( texelFetch( odd_sum, texel, 0 ) ) * 2.0 * truth_weight;
		vec2 of_left = error_of( mean( left ), even, odd ), of_right = has_right != 0 ? error_of( mean( right ), even, odd ) : vec2( 0.0 );
		sums += vec4( 1.0, 0.5 * ( even + odd ), of_left.x, of_right.x );
		others.xy = max( others.xy, vec2( of_left.y, of_right.y ) );
		others.z += 0.25 * ( even - odd ) * ( even - odd );
		others.w = max( others.w, has_right != 0 ? abs( mean( left ) - mean( right ) ) : of_left.y );
	}
}`;
