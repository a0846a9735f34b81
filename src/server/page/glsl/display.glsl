// Shows the left side, the right side, both, or their difference in false colours. Uses the tone curve of src/view/preview/tone.rs.
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
}
