// The lines of three's shader that are replaced, and their replacements. Everything is in view space.

/**
 * For each chunk, lines and their replacements: a text, or a function that makes it from the text of the lobe, which is
 * `BY_NORMALS`, `BY_FORMULA`, `BY_PICTURES` or `BY_TABLE` after the functions that it calls.
 */
export const PATCHES = {
	lights_physical_pars_fragment: [
		[ '	void RE_Direct_RectArea_Physical(', ( lobe ) => `${ lobe }\n	void RE_Direct_RectArea_Physical(` ],
		[
			'reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );',
			'reflectedLight.directSpecular += lightColor * rect_area_gloss( rectAreaBase, material.specularColorBlended, material.specularF90, position, rectCoords );',
		],
		[
			'clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );',
			'clearcoatSpecularDirect += lightColor * rect_area_gloss( rectAreaCoat, material.clearcoatF0, material.clearcoatF90, position, rectCoords );',
		],
	],
	lights_fragment_begin: [
		// three unrolls the loop, so drivers compile the gloss again for each light.
		[
			`	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {

		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );

	}
	#pragma unroll_loop_end`,
			`	rect_area_begin( geometryNormal, geometryViewDir, geometryClearcoatNormal, material );

	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {

		rectAreaNumber = i;
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );

	}`,
		],
	],
};

/**
 * The GLSL code that all exports share.
 *
 * @param {string} members - The members of a lobe.
 * @param {string} lobe - Sets these members of `lobe` from `alphas`, `wo` and `fresnel`, the reflectance at normal and grazing incidence.
 * @param {string} gloss - Returns the light of `corners`, which are in the tangent frame.
 */
const glossOf = ( members, lobe, gloss ) => /* glsl */ `
	// Values that are the same for all lights.
	struct RectAreaLobe {
		mat3 toTangentFrame;
		${ members }
	};
	RectAreaLobe rectAreaBase;
	RectAreaLobe rectAreaCoat;
	// The number of the light in the loop.
	int rectAreaNumber = 0;

	RectAreaLobe rect_area_lobe( const in vec3 normal, const in vec3 viewDir, const in vec3 along, const in vec2 alphas, const in vec2 fresnel ) {

		// The tangent frame. GGX is symmetric in y, so the frame is right-handed for any texture coordinates.
		vec3 tangent = normalize( along - normal * dot( normal, along ) );
		RectAreaLobe lobe;
		lobe.toTangentFrame = transpose( mat3( tangent, cross( normal, tangent ), normal ) );

		// An interpolated normal may face away from the viewer.
		vec3 wo = lobe.toTangentFrame * viewDir;
		wo = normalize( vec3( wo.xy, max( wo.z, 1e-3 ) ) );
		${ lobe }
		return lobe;

	}

	vec3 rect_area_any_tangent( const in vec3 normal ) {

		return abs( normal.x ) < 0.9 ? vec3( 1.0, 0.0, 0.0 ) : vec3( 0.0, 1.0, 0.0 );

	}

	// Runs once a fragment, before the loop over lights.
	void rect_area_begin( const in vec3 normal, const in vec3 viewDir, const in vec3 clearcoatNormal, const in PhysicalMaterial material ) {

		float alpha = pow2( material.roughness );
		vec2 fresnel = vec2( dot( material.specularColorBlended, vec3( 1.0 / 3.0 ) ), material.specularF90 );

		#ifdef USE_ANISOTROPY
			rectAreaBase = rect_area_lobe( normal, viewDir, material.anisotropyT, vec2( material.alphaT, alpha ), fresnel );
		#else
			rectAreaBase = rect_area_lobe( normal, viewDir, rect_area_any_tangent( normal ), vec2( alpha ), fresnel );
		#endif

		#ifdef USE_CLEARCOAT
			rectAreaCoat = rect_area_lobe( clearcoatNormal, viewDir, rect_area_any_tangent( clearcoatNormal ), vec2( pow2( material.clearcoatRoughness ) ), vec2( material.clearcoatF0.x, material.clearcoatF90 ) );
		#endif

	}

	// The light of a rectangle of radiance one, reflected by a lobe.
	vec3 rect_area_gloss( const in RectAreaLobe lobe, const in vec3 f0, const in float f90, const in vec3 position, const in vec3 rectCoords[ 4 ] ) {

		// three's corners run counterclockwise as seen from the side that emits. These must run clockwise.
		vec3 corners[ 4 ] = vec3[ 4 ](
			lobe.toTangentFrame * ( rectCoords[ 3 ] - position ),
			lobe.toTangentFrame * ( rectCoords[ 2 ] - position ),
			lobe.toTangentFrame * ( rectCoords[ 1 ] - position ),
			lobe.toTangentFrame * ( rectCoords[ 0 ] - position )
		);

		${ gloss }

	}
`;

export const BY_NORMALS = glossOf(
	'NormalsView view;',
	'lobe.view = normals_view( alphas.x, alphas.y, wo );',
	`// Schlick: y is the part of x that (1 - cos)^5 weighs.
		vec2 parts = normals_rectangle( lobe.view, corners, false );
		return f0 * ( parts.x - parts.y ) + f90 * parts.y;` );

export const BY_FORMULA = glossOf(
	'LtcFormula ltc;',
	'lobe.ltc = ltc_formula( alphas.x, alphas.y, wo, fresnel.x, fresnel.y );',
	`vec3 reflectance = f0 * ( lobe.ltc.amplitude - lobe.ltc.fresnel ) + f90 * lobe.ltc.fresnel;
		return reflectance * ltc_rectangle( lobe.ltc.inverse, corners, false );` );

/** The gloss with pictures. Corners of three's lights begin at the upper left, as seen from the side that emits. */
export const BY_PICTURES = `
	uniform int rect_area_pictures;
	uniform float rect_area_picture_base;
` + glossOf(
	'NormalsView view;',
	'lobe.view = normals_view( alphas.x, alphas.y, wo );',
	`NormalsTextured light = NormalsTextured( vec2( 0.0 ), vec3( 1.0 ) );
		if ( rectAreaNumber < rect_area_pictures ) {
			light = normals_textured_rectangle( lobe.view, corners, false, uint( rectAreaNumber ), rect_area_picture_base );
		} else {
			light.parts = normals_rectangle( lobe.view, corners, false );
		}
		return light.colour * ( f0 * ( light.parts.x - light.parts.y ) + f90 * light.parts.y );` );

export const BY_TABLE = glossOf(
	'LtcInverse inverse_; float amplitude; float fresnel;',
	`LtcLobe stored = ltc_lookup( alphas.x, alphas.y, wo );
		lobe.inverse_ = ltc_inverse( stored.m );
		lobe.amplitude = stored.amplitude;
		lobe.fresnel = stored.fresnel;`,
	`// Schlick: fresnel is the part of amplitude that (1 - cos)^5 weighs.
		vec3 reflectance = f0 * ( lobe.amplitude - lobe.fresnel ) + f90 * lobe.fresnel;
		return reflectance * ltc_rectangle( lobe.inverse_, corners, false );` );
