// Adds the lights in front of the surface, with four rays per pixel, to a sum over frames. The back of a light is dark.
uniform sampler2D surface_position, sum_before;
uniform vec3 eye, right, up, forward;
uniform int size, sum_count;
out vec4 sum;
void main() {
	ivec2 texel = ivec2( gl_FragCoord.xy );
	vec4 place = texelFetch( surface_position, texel, 0 );
	// A lamp of a scene can lie on its surface.
	float far = place.w > 0.5 ? 1.0001 * distance( place.xyz, eye ) : 1e9;
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
#if SHAPES_USED & 32
		vec4 hit = occluder_hit( eye, ray );
		if ( hit.w > 0.0 && hit.w < nearest ) seen = vec4( vec3( 0.03 + 0.12 * max( - dot( hit.xyz, ray ), 0.0 ) ), 1.0 );
#endif
		sum += 0.25 * seen;
	}
}
