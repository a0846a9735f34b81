// Sums over tiles of 4 x 4 pixels, one tile for each texel.
uniform sampler2D surface_position;
/** The number of the mesh to measure, or -1 for all. */
uniform int size, number;
/** Pixels of the surface, light of the left and of the right side, and squared noise of the truth. */
layout( location = 0 ) out vec4 sums;
/** Light of the truth, by each half of its samples. */
layout( location = 1 ) out vec4 truths;

void main() {
	sums = truths = vec4( 0.0 );
	ivec2 start = 4 * ivec2( gl_FragCoord.xy ), end = min( start + 4, size );
	for ( int y = start.y; y < end.y; y ++ ) for ( int x = start.x; x < end.x; x ++ ) {
		ivec2 texel = ivec2( x, y );
		vec4 left = left_of( texel );
		// A pixel at an edge has the light of several surfaces.
		if ( left.w < 0.999 || number >= 0 && int( texelFetch( surface_position, texel, 0 ).w ) != 1 + number ) continue;
		vec2 truth = vec2( mean( texelFetch( even_sum, texel, 0 ) ), mean( texelFetch( odd_sum, texel, 0 ) ) ) * 2.0 * truth_weight;
		sums += vec4( 1.0, mean( left ), has_right != 0 ? mean( right_of( texel ) ) : 0.0, 0.25 * ( truth.x - truth.y ) * ( truth.x - truth.y ) );
		truths.xy += truth;
	}
}
