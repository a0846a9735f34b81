/** The number that Babylon adds to the square of a roughness. */
const MINIMUM_VARIANCE = 0.0005;

/**
 * Sets the GGX roughness along the tangent and across it, as Babylon's `roughness` and `anisotropy`. The intensity stretches the
 * lobe along a direction: alpha = roughness^2 + 0.0005 across, and alpha + (1 - alpha) intensity^2 along it.
 *
 * @param {Object} material - A PBRMaterial or one of its simpler forms.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1]. Babylon raises it to 0.0005.
 * @param {number} alphaY - GGX alpha across the tangent, in (0, 1]. Babylon raises it to 0.0005.
 */
export function setAlphas( material, alphaX, alphaY ) {

	for ( const alpha of [ alphaX, alphaY ] ) {

		if ( ! ( alpha > 0 && alpha <= 1 ) ) throw new RangeError( `alpha is ${ alpha }: it must be above 0 and at most 1` );

	}

	const small = Math.min( alphaX, alphaY );
	const large = Math.max( alphaX, alphaY );
	const roughness = Math.sqrt( Math.max( small - MINIMUM_VARIANCE, 0 ) );
	if ( 'glossiness' in material ) material.glossiness = 1 - roughness;
	else if ( material.isMetallicWorkflow() ) material.roughness = roughness;
	else material.microSurface = 1 - roughness;
	material.anisotropy.isEnabled = large > small;
	material.anisotropy.legacy = false;
	material.anisotropy.intensity = small < 1 ? Math.sqrt( ( large - small ) / ( 1 - small ) ) : 0;
	material.anisotropy.angle = alphaX >= alphaY ? 0 : Math.PI / 2;

}
