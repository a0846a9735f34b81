// Errors of both sides against the truth, one texel for each block of pixels. A block consists of tiles of 4 x 4 pixels. The sign of
// the mean error of a tile comes from one half of the truth, and its amount from the other half, so noise adds nothing.
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
}
