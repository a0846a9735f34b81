mat2x3 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	return mat2x3( lobes.first.amplitude * covered( ltc_inverse( lobes.first.m ), at ), lobes.first.fresnel * covered( ltc_inverse( lobes.second ), at ) );
}
