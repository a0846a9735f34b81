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
 * Errors of both sides against the truth, one texel for each block of pixels. A block consists of tiles of 4 x 4 pixels. The sign of
 * the mean error of a tile comes from one half of the truth, and its amount from the other half, so noise adds nothing.
 */
export const ERRORS_SHADER = `${ HEAD }${ SIDES }
uniform sampler2D surface_position;
/** The number of the mesh to measure, or -1 for all. */
uniform int size, block, number;
/** Sums: pixels, truth, error of the left side, error of the right side. */
layout( location = 0 ) out vec4 sums;
/** Largest error of the left and of the right side, sum of the squared noise, largest difference of both sides. */
layout( location = 1 ) out vec4 others;

/** The mean and the least amount of an error, from its means with both halves of the truth. */
vec2 error_of( vec2 off ) { return vec2( 0.5 * dot( sign( off ), off.yx ), off.x * off.y > 0.0 ? min( abs( off.x ), abs( off.y ) ) : 0.0 ); }

void main() {
	sums = others = vec4( 0.0 );
	ivec2 start = ivec2( gl_FragCoord.xy ) * block, end = min( start + block, size );
	for ( int v = start.y; v < end.y; v += 4 ) for ( int u = start.x; u < end.x; u += 4 ) {
		float count = 0.0;
		vec4 tile = vec4( 0.0 );
		for ( int y = v; y < min( v + 4, end.y ); y ++ ) for ( int x = u; x < min( u + 4, end.x ); x ++ ) {
			ivec2 texel = ivec2( x, y );
			vec4 left = left_of( texel );
			// A pixel at an edge has the light of several surfaces.
			if ( left.w < 0.999 || number >= 0 && int( texelFetch( surface_position, texel, 0 ).w ) != 1 + number ) continue;
			vec2 truth = vec2( mean( texelFetch( even_sum, texel, 0 ) ), mean( texelFetch( odd_sum, texel, 0 ) ) ) * 2.0 * truth_weight;
			tile += vec4( mean( left ), has_right != 0 ? mean( right_of( texel ) ) : 0.0, truth );
			others.z += 0.25 * ( truth.x - truth.y ) * ( truth.x - truth.y );
			count += 1.0;
		}
		if ( count == 0.0 ) continue;
		tile /= count;
		vec2 of_left = error_of( tile.x - tile.zw ), of_right = has_right != 0 ? error_of( tile.y - tile.zw ) : vec2( 0.0 );
		sums += count * vec4( 1.0, 0.5 * ( tile.z + tile.w ), of_left.x, of_right.x );
		others.xy = max( others.xy, vec2( of_left.y, of_right.y ) );
		others.w = max( others.w, has_right != 0 ? abs( tile.x - tile.y ) : of_left.y );
	}
}`;
