// The sum over all lights of the part of a lobe that the light covers, times the light's radiance.
vec3 covered( LtcInverse local, Shaded at ) {
	LtcInverse inverse = LtcInverse( local.m * transpose( mat3( at.x, at.y, at.z ) ), local.side );
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 centre = light_centre[l].xyz - at.position;
		vec3 end = light_x[l].xyz - at.position;
		vec3 colour = radiance_of( l );
		bool is_both = is_two_sided( l );
		float part = 0.0;
		if ( is_shape( l, 0 ) ) {
			vec3 v[8];
			for ( int i = 0; i < 8; i ++ ) v[i] = light_vertices[8 * l + i].xyz - at.position;
			vec3[4] corners = vec3[4]( v[0], v[1], v[2], v[3] );
#if SHAPES_USED & 16
			if ( is_pictured( l ) ) {
				LtcTextured textured = ltc_textured_rectangle( inverse, corners, is_both, uint( light_picture[l] ), picture_base );
				sum += textured.covered * colour * textured.colour;
				continue;
			}
#endif
			part = light_corners[l] == 4 ? ltc_rectangle( inverse, corners, is_both ) : ltc_polygon( inverse, v, uint( light_corners[l] ), is_both );
		}
		if ( is_shape( l, 1 ) ) part = ltc_disk( inverse, centre, light_x[l].xyz, light_y[l].xyz, is_both );
		if ( is_shape( l, 2 ) ) part = ltc_tube( inverse, centre, end, light_centre[l].w );
		if ( is_shape( l, 3 ) ) part = ltc_line( inverse, centre, end, light_centre[l].w );
		sum += part * colour;
	}
	return sum;
}
