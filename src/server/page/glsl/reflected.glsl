vec3 reflected( Shaded at ) {
	mat2x3 parts = parts_of( at );
	return at.f0 * ( parts[0] - parts[1] ) + parts[1];
}
