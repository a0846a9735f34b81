/** Babylon adds this to the square of a roughness. */
const MINIMUM_VARIANCE = 0.0005;

/**
 * Sets the roughness of GGX along the tangent and across it. Babylon has it as `roughness` and `anisotropy`, whose intensity
 * stretches the lobe along a direction: alpha = roughness^2 + 0.0005 across, and along it alpha + (1 - alpha) intensity^2.
 *
 * @param {Object} material - A PBRMaterial or one of its simpler forms.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1], of which Babylon takes 0.0005 at least.
 * @param {number} alphaY - GGX alpha across it, likewise.
 */
export function setAlphas( material, alphaX, alphaY ) {

	for ( const alpha of [ alphaX, alphaY ] ) {

		if ( ! ( alpha > 0 && alpha <= 1 ) ) throw new RangeError( `alpha is ${ alpha }: it has to be above 0 and at most 1` );

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
