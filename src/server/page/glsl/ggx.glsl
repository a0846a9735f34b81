// GGX, sampled by visible normals [Dupuy and Benyoub 2023].
float lambda( vec2 alpha, vec3 w ) { vec2 t = alpha * w.xy / w.z; return 0.5 * ( sqrt( 1.0 + dot( t, t ) ) - 1.0 ); }
float distribution( vec2 alpha, vec3 wm ) {
	vec2 t = wm.xy / alpha;
	float q = dot( t, t ) + wm.z * wm.z;
	return 1.0 / ( 3.14159265 * alpha.x * alpha.y * q * q );
}
vec3 sampled_direction( Shaded at, vec2 u ) {
	vec3 standard = normalize( vec3( at.alpha * at.wo.xy, at.wo.z ) );
	float z = ( 1.0 - u.y ) * ( 1.0 + standard.z ) - standard.z;
	float radius = sqrt( max( 1.0 - z * z, 0.0 ) );
	vec3 wm = vec3( radius * cos( 6.2831853 * u.x ), radius * sin( 6.2831853 * u.x ), z ) + standard;
	wm = normalize( vec3( at.alpha * wm.xy, max( wm.z, 0.0 ) ) );
	return 2.0 * dot( at.wo, wm ) * wm - at.wo;
}
/** x: BRDF times cosine. y: density of wi in sampled_direction. */
vec2 scattered( Shaded at, vec3 wm, vec3 wi ) {
	float lambda_o = lambda( at.alpha, at.wo );
	float of_brdf = distribution( at.alpha, wm ) / ( 4.0 * at.wo.z * ( 1.0 + lambda_o ) );
	return vec2( of_brdf * ( 1.0 + lambda_o ) / ( 1.0 + lambda_o + lambda( at.alpha, wi ) ), of_brdf );
}
