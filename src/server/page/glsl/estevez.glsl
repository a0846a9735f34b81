float log_lambda( float rough, float x ) {
	vec4 s = mix( vec4( 25.3245, 3.32435, 0.16801, - 1.27393 ), vec4( 21.5473, 3.82987, 0.19823, - 1.97760 ), rough );
	return s.x / ( 1.0 + s.y * pow( max( x, 1e-9 ), s.z ) ) + s.w * x + mix( - 4.85967, - 4.32054, rough );
}
float smith( float alpha, float cosine ) {
	float rough = 1.0 - ( 1.0 - alpha ) * ( 1.0 - alpha );
	return exp( cosine < 0.5 ? log_lambda( rough, cosine ) : 2.0 * log_lambda( rough, 0.5 ) - log_lambda( rough, max( 1.0 - cosine, 0.0 ) ) );
}
float visibility( float alpha, float o, float i ) { return 1.0 / ( 4.0 * o * i * ( 1.0 + smith( alpha, o ) + smith( alpha, i ) ) ); }
