/**
 * Sets the roughness of GGX along the tangent and across it, and GGX for PlayCanvas' other lights. PlayCanvas has it as `gloss`
 * and `anisotropyIntensity`, which stretches the lobe along a direction: alpha = (1 - gloss)^4 across, and along it
 * alpha + (1 - alpha) anisotropyIntensity^2. Without anisotropy, alpha = (1 - gloss)^2.
 *
 * @param {import('playcanvas').StandardMaterial} material - The material, which is updated.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1], of which PlayCanvas takes 0.001 at least.
 * @param {number} alphaY - GGX alpha across it, likewise.
 */
export function setAlphas( material, alphaX, alphaY ) {

	for ( const alpha of [ alphaX, alphaY ] ) {

		if ( ! ( alpha > 0 && alpha <= 1 ) ) throw new RangeError( `alpha is ${ alpha }: it has to be above 0 and at most 1` );

	}

	const small = Math.min( alphaX, alphaY );
	const large = Math.max( alphaX, alphaY );
	const roughness = small ** ( large > small ? 1 / 4 : 1 / 2 );
	material.gloss = material.glossInvert ? roughness : 1 - roughness;
	material.enableGGXSpecular = true;
	material.anisotropyIntensity = small < 1 ? Math.sqrt( ( large - small ) / ( 1 - small ) ) : 0;
	material.anisotropyRotation = alphaX >= alphaY ? 0 : 90;
	material.update();

}
