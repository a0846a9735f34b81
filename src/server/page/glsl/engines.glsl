// The isotropic table of 2017 as engines read it. It uses the geometric mean of both roughnesses. Instead of clipping a light at the
// horizon, it uses the visible part of a sphere with the same vector form factor [Hill and Heitz 2016]. It uses only
// the mean colour of a picture. `EngineWay::Clipless` of `ltcforge-light` is the CPU twin.
uniform sampler2D shipped_matrix, shipped_terms;
#if SHAPES_USED & 16
uniform highp sampler2DArray engines_pictures;
#endif
mat2x3 parts_of( Shaded at ) {
	vec2 place = vec2( sqrt( sqrt( at.alpha.x * at.alpha.y ) ), sqrt( 1.0 - at.wo.z ) ) * ( 63.0 / 64.0 ) + 0.5 / 64.0;
	vec4 stored = textureLod( shipped_matrix, place, 0.0 );
	vec2 terms = textureLod( shipped_terms, place, 0.0 ).xy;
	vec2 azimuth = dot( at.wo.xy, at.wo.xy ) > 1e-12 ? normalize( at.wo.xy ) : vec2( 1.0, 0.0 );
	mat3 to_view = transpose( mat3( azimuth, 0.0, - azimuth.y, azimuth.x, 0.0, 0.0, 0.0, 1.0 ) );
	mat3 inverse = mat3( stored.x, 0.0, stored.y, 0.0, 1.0, 0.0, stored.z, 0.0, stored.w ) * to_view;
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		if ( ! is_two_sided( l ) && dot( light_normal[l].xyz, light_vertices[8 * l].xyz - at.position ) >= 0.0 ) continue;
		vec3 v[8];
		int count = int( outline_of( l, at, v ) );
		vec3 flux = vec3( 0.0 );
		vec3 before = normalize( inverse * v[count - 1] );
		for ( int i = 0; i < count; i ++ ) {
			vec3 corner = normalize( inverse * v[i] );
			flux += edge( before, corner );
			before = corner;
		}
		flux *= 0.15915494;
		// The outline of a light with two sides can have either orientation.
		if ( is_two_sided( l ) && dot( flux, inverse * ( v[0] + v[count / 2] ) ) < 0.0 ) flux = - flux;
		float size = length( flux );
		vec3 colour = radiance_of( l );
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) colour *= textureLod( engines_pictures, vec3( 0.5, 0.5, light_picture[l] ), 16.0 ).rgb;
#endif
		sum += colour * max( size * ( size + flux.z / max( size, 1e-12 ) ) / ( size + 1.0 ), 0.0 );
	}
	return outerProduct( sum, terms );
}
