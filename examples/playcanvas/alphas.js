/**
 * Sets the GGX roughness along the tangent and across it, and GGX for PlayCanvas' other lights, as `gloss` and
 * `anisotropyIntensity`. The intensity stretches the lobe along a direction: alpha = (1 - gloss)^4 across, and
 * alpha + (1 - alpha) anisotropyIntensity^2 along it. Without anisotropy, alpha = (1 - gloss)^2.
 *
 * @param {import('playcanvas').StandardMaterial} material - The material, which is updated.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1]. PlayCanvas raises it to 0.001.
 * @param {number} alphaY - GGX alpha across the tangent, in (0, 1]. PlayCanvas raises it to 0.001.
 */
export function setAlphas( material, alphaX, alphaY ) {

	for ( const alpha of [ alphaX, alphaY ] ) {

		if ( ! ( alpha > 0 && alpha <= 1 ) ) throw new RangeError( `alpha is ${ alpha }: it must be above 0 and at most 1` );

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
