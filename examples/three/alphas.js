/**
 * Sets the GGX roughness along the tangent and across it, as three's `roughness` and `anisotropy`. The anisotropy stretches the
 * lobe along a direction, which `anisotropyRotation` rotates: alpha = roughness^2 across, and alpha + (1 - alpha) anisotropy^2
 * along it. three raises roughness to 0.045.
 *
 * @param {import('three').MeshPhysicalMaterial} material - The material.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1].
 * @param {number} alphaY - GGX alpha across the tangent, in (0, 1].
 */
export function setAlphas( material, alphaX, alphaY ) {

	for ( const alpha of [ alphaX, alphaY ] ) {

		if ( ! ( alpha > 0 && alpha <= 1 ) ) throw new RangeError( `alpha is ${ alpha }: it must be above 0 and at most 1` );

	}

	if ( ! ( 'anisotropy' in material ) && alphaX !== alphaY ) throw new TypeError( `${ material.type } has no anisotropy: MeshPhysicalMaterial has` );

	const small = Math.min( alphaX, alphaY );
	const large = Math.max( alphaX, alphaY );
	material.roughness = Math.sqrt( small );
	if ( ! ( 'anisotropy' in material ) ) return;
	material.anisotropy = small < 1 ? Math.sqrt( ( large - small ) / ( 1 - small ) ) : 0;
	material.anisotropyRotation = alphaX >= alphaY ? 0 : Math.PI / 2;

}
