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
			if ( of_light >= 0.0 && found.y > 0.0 && ! is_hidden( l, at.position, towards ) ) sum += fresnel( at.f0, dot( at.wo, wm ) ) * emitted( l, at.position, towards ) * ( found.x / ( found.y + of_light ) );
		}
	}
	for ( int l = 0; l < light_count; l ++ ) {
		vec4 of_light = light_sample( l, at.position, point( i, seed.zw ) );
		wi = vec3( dot( of_light.xyz, at.x ), dot( of_light.xyz, at.y ), dot( of_light.xyz, at.z ) );
		if ( wi.z > HORIZON && of_light.w > 0.0 && ! is_hidden( l, at.position, of_light.xyz ) ) {
			vec3 wm = normalize( at.wo + wi );
			vec2 found = scattered( at, wm, wi );
			// Directions of the BRDF never hit a line.
			float of_both = of_light.w + ( is_shape( l, 3 ) ? 0.0 : found.y );
			sum += fresnel( at.f0, dot( at.wo, wm ) ) * emitted( l, at.position, of_light.xyz ) * ( found.x / of_both );
		}
	}
	return sum;
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
}
