// The normals model, which supports only polygons. As in previews, polygons replace other shapes.
mat2x3 parts_of( Shaded at ) {
	NormalsView view = normals_view( at.alpha.x, at.alpha.y, at.wo );
	mat2x3 sum = mat2x3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		uint count = outline_of( l, at, v );
		vec3[4] corners = vec3[4]( v[0], v[1], v[2], v[3] );
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) {
			NormalsTextured textured = normals_textured_rectangle( view, corners, is_two_sided( l ), uint( light_picture[l] ), picture_base );
			sum += outerProduct( radiance_of( l ) * textured.colour, textured.parts );
			continue;
		}
#endif
		vec2 of_light = count == 4u ? normals_rectangle( view, corners, is_two_sided( l ) ) : normals_polygon( view, v, count, is_two_sided( l ) );
		sum += outerProduct( radiance_of( l ), of_light );
	}
	return sum;
}
