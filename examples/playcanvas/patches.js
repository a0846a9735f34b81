// The lines of PlayCanvas' chunks that are replaced, and their replacements. Everything is in world space.

/** The code before `calcLTCLightValues`, which is called once a fragment. */
export const closedForm = ( normalsGlsl ) => /* glsl */ `
${ normalsGlsl }
	// Values that are the same for all lights.
	struct AreaLobe {
		mat3 toTangentFrame;
		NormalsView view;
		vec3 specularity;
	};
	AreaLobe areaBase;
	AreaLobe areaCoat;

	AreaLobe area_lobe( vec3 normal, vec3 viewDir, vec3 along, vec2 alphas, vec3 specularity ) {

		// The tangent frame. GGX is symmetric in y, so the frame is right-handed for any texture coordinates.
		vec3 tangent = normalize( along - normal * dot( normal, along ) );
		AreaLobe lobe;
		lobe.toTangentFrame = transpose( mat3( tangent, cross( normal, tangent ), normal ) );
		// An interpolated normal may face away from the viewer.
		vec3 wo = lobe.toTangentFrame * viewDir;
		lobe.view = normals_view( alphas.x, alphas.y, normalize( vec3( wo.xy, max( wo.z, 1e-3 ) ) ) );
		lobe.specularity = specularity;
		return lobe;

	}

	vec3 area_any_tangent( vec3 normal ) {

		return abs( normal.x ) < 0.9 ? vec3( 1.0, 0.0, 0.0 ) : vec3( 0.0, 1.0, 0.0 );

	}

	// The light of a rectangle of radiance one, reflected by a lobe. The rectangle emits from both sides.
	vec3 area_gloss( AreaLobe lobe, Coords rectangle ) {

		vec3 corners[ 4 ] = vec3[ 4 ](
			lobe.toTangentFrame * ( rectangle.coord0 - vPositionW ),
			lobe.toTangentFrame * ( rectangle.coord1 - vPositionW ),
			lobe.toTangentFrame * ( rectangle.coord2 - vPositionW ),
			lobe.toTangentFrame * ( rectangle.coord3 - vPositionW )
		);
		// Schlick: y is the part of x that (1 - cos)^5 weighs.
		vec2 parts = normals_rectangle( lobe.view, corners, true );
		return lobe.specularity * ( parts.x - parts.y ) + parts.y;

	}

	// PlayCanvas writes the code of each light one after another. Here a loop runs over the rectangles, so drivers compile the
	// closed form once.
	#if LIGHT_COUNT > 0
		vec3 areaGloss[ LIGHT_COUNT ];
		vec3 areaCoatGloss[ LIGHT_COUNT ];
	#endif

	void area_begin( float gloss, vec3 worldNormal, vec3 viewDir, vec3 specularity, float clearcoatGloss, vec3 clearcoatWorldNormal, float clearcoatSpecularity ) {

		// The alpha of PlayCanvas' other lights differs for anisotropic materials.
		float alpha = max( ( 1.0 - gloss ) * ( 1.0 - gloss ), 0.001 );
		#ifdef LIT_ANISOTROPY
			float across = clamp( alpha * alpha, 0.001, 1.0 );
			vec2 alphas = vec2( mix( alpha * alpha, 1.0, dAnisotropy * dAnisotropy ), across );
			areaBase = area_lobe( worldNormal, viewDir, dTBN * vec3( dAnisotropyRotation, 0.0 ), alphas, specularity );
		#else
			areaBase = area_lobe( worldNormal, viewDir, area_any_tangent( worldNormal ), vec2( alpha ), specularity );
		#endif
		#ifdef LIT_CLEARCOAT
			float coatAlpha = max( ( 1.0 - clearcoatGloss ) * ( 1.0 - clearcoatGloss ), 0.001 );
			areaCoat = area_lobe( clearcoatWorldNormal, viewDir, area_any_tangent( clearcoatWorldNormal ), vec2( coatAlpha ), vec3( clearcoatSpecularity ) );
		#endif

		#if LIGHT_COUNT > 0
			Coords rectangles[ LIGHT_COUNT ];
			int lights[ LIGHT_COUNT ];
			int count = 0;
			#include "ltcforgeCollectPS, LIGHT_COUNT"
			for ( int i = 0; i < count; i ++ ) {

				areaGloss[ lights[ i ] ] = area_gloss( areaBase, rectangles[ i ] );
				#ifdef LIT_CLEARCOAT
					areaCoatGloss[ lights[ i ] ] = area_gloss( areaCoat, rectangles[ i ] );
				#endif

			}
		#endif

	}

	void calcLTCLightValues(`;

/** The code of a chunk for each light. */
export const collect = /* glsl */ `
	#if defined(LIGHT{i})
		#if LIGHT{i}SHAPE == RECT
			rectangles[ count ] = getLTCLightCoords( light{i}_position, light{i}_halfWidth, light{i}_halfHeight );
			lights[ count ] = {i};
			count ++;
		#endif
	#endif
`;

/** For each chunk, lines and their replacements. */
export const PATCHES = {
	ltcPS: [
		[ 'void calcLTCLightValues(', closedForm ],
		[
			'dLTCUV = getLTCLightUV(gloss, worldNormal, viewDir);',
			`area_begin( gloss, worldNormal, viewDir, specularity, clearcoatGloss, clearcoatWorldNormal, clearcoatSpecularity );
	dLTCUV = getLTCLightUV(gloss, worldNormal, viewDir);`,
		],
	],
	lightFunctionLightPS: [
		[
			'dSpecularLight += dLTCSpecFres * getRectLightSpecular(litArgs_worldNormal, dViewDirW) * dAtten * lightColor;',
			'dSpecularLight += areaGloss[ {i} ] * dAtten * lightColor;',
		],
		[
			'ccSpecularLight += ccLTCSpecFres * getRectLightSpecular(litArgs_clearcoat_worldNormal, dViewDirW) * dAtten * lightColor;',
			'ccSpecularLight += areaCoatGloss[ {i} ] * dAtten * lightColor;',
		],
	],
	// PlayCanvas evaluates clustered lights in a loop.
	clusteredLightPS: [
		[ 'areaLightSpecular = getRectLightSpecular(worldNormal, viewDir);', 'areaLightSpecular = 0.0;' ],
		[
			'dSpecularLight += dLTCSpecFres * areaLightSpecular * falloffAttenuation * light.color * cookieAttenuation;',
			`vec3 areaGlossOf = light.shape == {LIGHTSHAPE_RECT} ? area_gloss( areaBase, dLTCCoords ) : dLTCSpecFres * areaLightSpecular;
				dSpecularLight += areaGlossOf * falloffAttenuation * light.color * cookieAttenuation;`,
		],
		[ 'areaLightSpecularCC = getRectLightSpecular(clearcoat_worldNormal, viewDir);', 'areaLightSpecularCC = 0.0;' ],
		[
			'ccSpecularLight += ccLTCSpecFres * areaLightSpecularCC * falloffAttenuation * light.color * cookieAttenuation;',
			`vec3 areaCoatGlossOf = light.shape == {LIGHTSHAPE_RECT} ? area_gloss( areaCoat, dLTCCoords ) : ccLTCSpecFres * areaLightSpecularCC;
					ccSpecularLight += areaCoatGlossOf * falloffAttenuation * light.color * cookieAttenuation;`,
		],
	],
};
