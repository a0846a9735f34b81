mat2x3 parts_of( Shaded at ) {
	LtcFormula lobe = ltc_formula( at.alpha.x, at.alpha.y, at.wo, dot( at.f0, vec3( 1.0 / 3.0 ) ), 1.0 );
	return outerProduct( covered( lobe.inverse, at ), vec2( lobe.amplitude, lobe.fresnel ) );
}
