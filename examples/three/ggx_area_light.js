// Area lights on anisotropic GGX for three.js: replaces the lookup of linearly transformed cosines, which knows round
// lobes only. Either by the closed form that `ltcforge shader --model normals --language glsl-es` writes, which needs no
// table, or by a table that `ltcforge export --for wgpu` writes, with `ltcforge shader --layout reflected --language glsl-es`.
//
// Works on MeshStandardMaterial and MeshPhysicalMaterial with three's own RectAreaLight, `roughness`, `anisotropy`,
// `anisotropyRotation` and anisotropyMap. Diffuse light and clearcoat stay three's.

import { ShaderChunk } from 'three';

/** Where three declares what a rectangular light does to a physical material, and the line that adds the gloss. */
const DECLARATION = '#if NUM_RECT_AREA_LIGHTS > 0';
const STOCK_GLOSS =
	'reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );';
const OUR_GLOSS = 'reflectedLight.directSpecular += lightColor * rect_area_gloss( normal, viewDir, position, rectCoords, material );';

/** What both ways need: everything is in view space, `reflected` turns the parts of the light into what is seen. */
const glossOf = ( reflected ) => /* glsl */ `
	// What a rectangle of radiance one reflects by a material's GGX lobe. Everything is in view space.
	vec3 rect_area_gloss( const in vec3 normal, const in vec3 viewDir, const in vec3 position, const in vec3 rectCoords[ 4 ], const in PhysicalMaterial material ) {

		float alpha = pow2( material.roughness );

		#ifdef USE_ANISOTROPY
			vec3 along = material.anisotropyT;
			vec2 alphas = vec2( material.alphaT, alpha );
		#else
			vec3 along = abs( normal.x ) < 0.9 ? vec3( 1.0, 0.0, 0.0 ) : vec3( 0.0, 1.0, 0.0 );
			vec2 alphas = vec2( alpha );
		#endif

		// The tangent frame. GGX does not tell y from -y, so the frame is right-handed whatever the texture coordinates are.
		vec3 tangent = normalize( along - normal * dot( normal, along ) );
		mat3 toTangentFrame = transpose( mat3( tangent, cross( normal, tangent ), normal ) );

		// An interpolated normal may face away from the viewer.
		vec3 wo = toTangentFrame * viewDir;
		wo = normalize( vec3( wo.xy, max( wo.z, 1e-3 ) ) );

		// three's corners run counterclockwise seen from the lit side; these have to run clockwise.
		vec3 corners[ 4 ] = vec3[ 4 ](
			toTangentFrame * ( rectCoords[ 3 ] - position ),
			toTangentFrame * ( rectCoords[ 2 ] - position ),
			toTangentFrame * ( rectCoords[ 1 ] - position ),
			toTangentFrame * ( rectCoords[ 0 ] - position )
		);

		${ reflected }

	}
`;

const BY_NORMALS = glossOf( /* glsl */ `
		vec2 parts = normals_rectangle( normals_view( alphas.x, alphas.y, wo ), corners, false, NORMALS_FAN );

		// Schlick: y is the part of x that (1 - cos)^5 weighs.
		return material.specularColorBlended * ( parts.x - parts.y ) + material.specularF90 * parts.y;` );

const BY_TABLE = glossOf( /* glsl */ `
		LtcLobe lobe = ltc_lookup( alphas.x, alphas.y, wo );
		float covered = ltc_rectangle( ltc_inverse( lobe.m ), corners, false );

		// Schlick: fresnel is the part of amplitude that (1 - cos)^5 weighs.
		vec3 reflectance = material.specularColorBlended * ( lobe.amplitude - lobe.fresnel ) + material.specularF90 * lobe.fresnel;
		return covered * reflectance;` );

/**
 * Lights a material's gloss by three's rectangular lights in closed form.
 *
 * @param {import('three').MeshStandardMaterial} material - Patched in place, before it is first drawn.
 * @param {string} normalsGlsl - What `ltcforge shader --model normals --language glsl-es` prints.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withClosedFormAreaLights( material, normalsGlsl ) {

	return patched( material, 'ltcforge normals', normalsGlsl + BY_NORMALS, {} );

}

/**
 * Lights a material's gloss by three's rectangular lights with a table.
 *
 * @param {import('three').MeshStandardMaterial} material - Patched in place, before it is first drawn.
 * @param {string} tableGlsl - What `ltcforge shader --layout reflected --language glsl-es` prints.
 * @param {Object} table - What {@link loadTable} gave. Materials share it.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withTableAreaLights( material, tableGlsl, table ) {

	return patched( material, 'ltcforge table', tableGlsl + BY_TABLE, table );

}

/**
 * Loads a table that `ltcforge export --for wgpu` wrote.
 *
 * @param {string} address - Of the folder, with a slash at its end.
 * @param {import('three/addons/loaders/KTX2Loader.js').KTX2Loader} loader - After `detectSupport( renderer )`.
 * @returns {Promise<Object>} The shader's uniforms.
 */
export async function loadTable( address, loader ) {

	const answer = await fetch( `${ address }ltc.json` );
	if ( ! answer.ok ) throw new Error( `${ address }ltc.json: ${ answer.status }` );
	const { textures, ltc_table } = await answer.json();
	const [ ltc_matrix_a, ltc_matrix_b, ltc_terms ] = await Promise.all( textures.map( ( path ) => loader.loadAsync( address + path ) ) );
	const uniforms = { ltc_table, ltc_matrix_a, ltc_matrix_b, ltc_terms };
	return Object.fromEntries( Object.entries( uniforms ).map( ( [ name, value ] ) => [ name, { value } ] ) );

}

/** A material whose shader has other gloss under rectangular lights. */
function patched( material, name, glsl, uniforms ) {

	material.onBeforeCompile = ( shader ) => {

		Object.assign( shader.uniforms, uniforms );
		let chunk = ShaderChunk.lights_physical_pars_fragment;
		chunk = replaced( chunk, STOCK_GLOSS, OUR_GLOSS );
		chunk = replaced( chunk, DECLARATION, `${ DECLARATION }\n${ glsl }` );
		shader.fragmentShader = replaced( shader.fragmentShader, '#include <lights_physical_pars_fragment>', chunk );

	};

	// three tells programs apart by the text of the function above, which is the same for both ways.
	material.customProgramCacheKey = () => name;
	return material;

}

/**
 * Sets the roughness of GGX along the tangent and across it. three has it as `roughness` and `anisotropy`, which
 * stretches the lobe along a direction that `anisotropyRotation` turns: alpha = roughness^2 across, and along it
 * alpha + (1 - alpha) anisotropy^2. three raises roughness to 0.045.
 *
 * @param {import('three').MeshPhysicalMaterial} material - The material.
 * @param {number} alphaX - GGX alpha along the tangent, in (0, 1].
 * @param {number} alphaY - GGX alpha across it, in (0, 1].
 */
export function setAlphas( material, alphaX, alphaY ) {

	const small = Math.min( alphaX, alphaY );
	const large = Math.max( alphaX, alphaY );
	material.roughness = Math.sqrt( small );
	material.anisotropy = small < 1 ? Math.sqrt( ( large - small ) / ( 1 - small ) ) : 0;
	material.anisotropyRotation = alphaX >= alphaY ? 0 : Math.PI / 2;

}

/** Replaces the one place where a text has `what`. Another version of three may have none. */
function replaced( text, what, by ) {

	if ( text.split( what ).length !== 2 ) throw new Error( `this version of three.js has not exactly one place with: ${ what }` );
	return text.replace( what, () => by );

}
