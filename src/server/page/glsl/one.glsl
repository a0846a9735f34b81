mat2x3 parts_of( Shaded at ) {
	LtcLobe lobe = ltc_lookup( at.alpha.x, at.alpha.y, at.wo );
	return outerProduct( covered( ltc_inverse( lobe.m ), at ), vec2( lobe.amplitude, lobe.fresnel ) );
}
