uniform int size, frame, samples;
/** The visible part of each light: of its specular and of its diffuse reflection. */
layout( location = 0 ) out vec4 specular;
layout( location = 1 ) out vec4 diffuse;

/** The ratio of the visible samples to all samples, both weighted by the reflected light. */
float visible_part( int l, Shaded at, SamplerPolygon light, bool is_specular, uvec2 seed ) {
	vec2 sums = vec2( 0.0 );
	for ( int i = 0; i < samples; i ++ ) {
		SamplerDrawn drawn = sampler_draw_polygon( light, point( uint( frame * samples + i ), seed ) );
		if ( drawn.pdf <= 0.0 ) continue;
		vec3 wm = normalize( at.wo + drawn.wi );
		float reflected = is_specular ? scattered( at, wm, drawn.wi ).x * dot( fresnel( at.f0, dot( at.wo, wm ) ), vec3( 1.0 / 3.0 ) ) : drawn.wi.z;
		vec3 towards = at.x * drawn.wi.x + at.y * drawn.wi.y + at.z * drawn.wi.z;
		sums += reflected / drawn.pdf * vec2( is_hidden( l, at.position, towards ) ? 0.0 : 1.0, 1.0 );
	}
	return sums.y > 0.0 ? sums.x / sums.y : 1.0;
}

void main() {
	// A shader may not choose a component of an output by a variable.
	vec4 parts = vec4( 1.0 ), diffuse_parts = vec4( 1.0 );
	specular = diffuse = parts;
	Shaded at = shaded_point();
	if ( at.coverage <= 0.0 ) return;
	uvec4 seed = seeds( uint( gl_FragCoord.y ) * uint( size ) + uint( gl_FragCoord.x ) );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		uint count = outline_of( l, at, v );
		parts[l] = visible_part( l, at, sampler_normals_polygon( at.alpha.x, at.alpha.y, at.wo, v, count, is_two_sided( l ) ), true, seed.xy );
		diffuse_parts[l] = visible_part( l, at, sampler_ltc_polygon( mat3( 1.0 ), v, count, is_two_sided( l ) ), false, seed.zw );
		seed = seeds( seed.w );
	}
	specular = parts;
	diffuse = diffuse_parts;
}
