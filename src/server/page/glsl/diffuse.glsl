// Diffuse reflection [Lambert], the same for every model: form factors of polygons, which replace other shapes. It uses only the
// mean colour of a picture.
#if SHAPES_USED & 16
uniform highp sampler2DArray diffuse_pictures;
#endif
vec3 reflected( Shaded at ) {
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		int count = int( outline_of( l, at, v ) );
		vec3 flux = vec3( 0.0 ), first = vec3( 0.0 ), last = vec3( 0.0 );
		for ( int i = 0; i < 2 * count; i ++ ) {
			// Each corner above the horizon, and each point where the outline crosses the horizon.
			vec3 a = v[i / 2], b = v[( i / 2 + 1 ) % count];
			if ( ( i & 1 ) == 0 ? a.z < 0.0 : ( a.z < 0.0 ) == ( b.z < 0.0 ) ) continue;
			vec3 corner = normalize( ( i & 1 ) == 0 ? a : a + ( b - a ) * ( a.z / ( a.z - b.z ) ) );
			if ( first == vec3( 0.0 ) ) first = corner;
			else flux += edge( last, corner );
			last = corner;
		}
		float part = 0.15915494 * ( flux + edge( last, first ) ).z;
		vec3 colour = radiance_of( l );
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) colour *= textureLod( diffuse_pictures, vec3( 0.5, 0.5, light_picture[l] ), 16.0 ).rgb;
#endif
		sum += colour * ( is_two_sided( l ) ? abs( part ) : max( part, 0.0 ) );
	}
	return at.diffuse * sum;
}
