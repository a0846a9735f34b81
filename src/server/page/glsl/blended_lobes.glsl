mat2x3 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	float f0 = dot( at.f0, vec3( 1.0 / 3.0 ) );
	return outerProduct( covered( ltc_inverse( ltc_blend( lobes, f0, 1.0 ) ), at ), vec2( lobes.first.amplitude, lobes.first.fresnel ) );
}
