uint hash( uint key ) {
	uint x = key;
	x = ( x ^ ( x >> 16u ) ) * 0x7feb352du;
	x = ( x ^ ( x >> 15u ) ) * 0x846ca68bu;
	return x ^ ( x >> 16u );
}
/** Four seeds, each the hash of the one before. */
uvec4 seeds( uint key ) {
	uint a = hash( key ), b = hash( a ^ 0x9e3779b9u ), c = hash( b ^ 0x9e3779b9u );
	return uvec4( a, b, c, hash( c ^ 0x9e3779b9u ) );
}
vec2 point( uint i, uvec2 seed ) { return vec2( ( uvec2( i * 0xc13fa9a9u, i * 0x91e10da5u ) + seed ) >> uvec2( 8u ) ) / 16777216.0; }
vec3 fresnel( vec3 f0, float cosine ) { float m = clamp( 1.0 - cosine, 0.0, 1.0 ); return mix( f0, vec3( 1.0 ), m * m * m * m * m ); }
