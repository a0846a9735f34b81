// Polygons that replace tubes, spheres and lines, for models that support only polygons.
void tube_end( vec3 end, vec3 outwards, vec3 beside, vec3 sideways, float size, out vec3 v[4] ) {
	float sine2 = size * size / dot( end, end );
	vec3 centre = end * ( 1.0 - sine2 );
	float radius = size * sqrt( max( 1.0 - sine2, 0.0 ) );
	vec3 ahead = unit_of( outwards - end * ( dot( outwards, end ) / dot( end, end ) ) );
	float beside2 = dot( beside, beside );
	vec3 touched = - ( beside * ( size / beside2 ) - sideways * ( sqrt( beside2 - size * size ) / sqrt( beside2 ) ) ) * size;
	vec3 to_end = end + touched - centre;
	float cos_end = dot( to_end, ahead );
	float sin_end = dot( to_end, sideways );
	float half_arc = atan( max( sin_end, 0.0 ), cos_end );
	vec2 turn = vec2( sin( half_arc / 3.0 ), cos( half_arc / 3.0 ) );
	float sine = 2.0 * turn.x * turn.y;
	float far = half_arc > 1e-3 ? sqrt( 1.0 + 2.0 * half_arc / max( sine, 1e-6 ) ) - 1.0 : 1.0;
	v = vec3[4]( centre + ahead * cos_end + sideways * sin_end, centre + ( ahead * turn.y + sideways * turn.x ) * ( radius * far ),
		centre + ( ahead * turn.y - sideways * turn.x ) * ( radius * far ), centre + ahead * cos_end - sideways * sin_end );
}

/** The polygon that replaces a tube or line: a strip for a line, otherwise an octagon with the same area as the outline. Inside a tube, the polygon covers the whole sky. */
uint solid_outline( int l, vec3 position, vec3 sky, out vec3 v[8] ) {
	vec3 start = light_centre[l].xyz - position;
	vec3 end = light_x[l].xyz - position;
	vec3 along = end - start;
	float size = light_centre[l].w;
	if ( is_shape( l, 3 ) ) {
		vec3 across = unit_of( cross( start, end ) ) * ( 0.5 * size );
		v = vec3[8]( start - across, start + across, end + across, end - across, start, start, start, start );
		return 4u;
	}
	vec3 nearest = solid_nearest( l, position );
	vec3 beside = start - along * ( dot( start, along ) / max( dot( along, along ), 1e-36 ) );
	bool is_inside = dot( nearest, nearest ) <= size * size;
	if ( is_inside || dot( along, along ) == 0.0 || dot( beside, beside ) <= size * size ) {
		if ( is_inside ) nearest = sky;
		float radius = is_inside ? 0.999 : size;
		float sine2 = radius * radius / dot( nearest, nearest );
		mat2x3 basis = solid_basis( unit_of( nearest ) ) * ( radius * sqrt( 1.0 - sine2 ) * 1.0539074 );
		for ( int i = 0; i < 8; i ++ ) {
			float turn = ( 0.5 - float( i ) ) * 0.78539816;
			v[i] = nearest * ( 1.0 - sine2 ) + basis * vec2( cos( turn ), sin( turn ) );
		}
		return 8u;
	}
	vec3 sideways = normalize( cross( along, beside ) );
	vec3 a[4], b[4];
	tube_end( start, - along, beside, sideways, size, a );
	tube_end( end, along, beside, - sideways, size, b );
	v = vec3[8]( a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3] );
	return 8u;
}

/** The vertices of a light in the tangent frame of a surface point. Returns their number. */
uint outline_of( int l, Shaded at, out vec3 v[8] ) {
	mat3 to_local = transpose( mat3( at.x, at.y, at.z ) );
	uint count = uint( light_corners[l] );
	for ( int i = 0; i < 8; i ++ ) v[i] = light_vertices[8 * l + i].xyz - at.position;
	if ( is_solid( l ) ) count = solid_outline( l, at.position, at.z, v );
	for ( int i = 0; i < 8; i ++ ) v[i] = to_local * v[i];
	return count;
}
