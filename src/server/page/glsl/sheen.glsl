// Sheen: distribution Charlie [Estevez and Kulla 2017] with a visibility term. Directions are sampled with a density proportional to the cosine.
vec3 sampled_direction( Shaded at, vec2 u ) {
	float radius = sqrt( u.x );
	return vec3( radius * cos( 6.2831853 * u.y ), radius * sin( 6.2831853 * u.y ), sqrt( 1.0 - u.x ) );
}
vec2 scattered( Shaded at, vec3 wm, vec3 wi ) {
	float alpha = max( max( at.alpha.x, at.alpha.y ), 0.0049 );
	float distribution = ( 2.0 + 1.0 / alpha ) * pow( max( dot( wm.xy, wm.xy ), 1e-36 ), 0.5 / alpha ) / 6.2831853;
	return vec2( distribution * visibility( alpha, at.wo.z, wi.z ) * wi.z, wi.z / 3.14159265 );
}
