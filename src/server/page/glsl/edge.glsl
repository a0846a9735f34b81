// The part of the vector form factor that an edge between two unit vectors adds, times 2 pi.
vec3 edge( vec3 a, vec3 b ) {
	float cosine = clamp( dot( a, b ), - 1.0, 1.0 );
	vec3 normal = cross( a, b );
	float sine = length( normal );
	return sine > 1e-6 ? normal * ( atan( sine, cosine ) / sine ) : normal;
}
