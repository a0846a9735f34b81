// The lines of Babylon's shader that are replaced, and their replacements. Everything is in world space.

/** The line before the lights. */
export const LIGHTS_BEGIN = 'vec3 diffuseBase=vec3(0.,0.,0.);';

/** The pattern of each area light's line, with its number. Without uniform buffers, the number ends the name of a uniform. */
export const lightPattern = ( hasUbo ) =>
	String.raw`info\.specular=computeAreaSpecularLighting\(preInfo,(${ hasUbo ? String.raw`light(\d+)\.vLightSpecular` : String.raw`vLightSpecular(\d+)` }\.rgb),([\w.]+),([\w.]+)\);`;

/** For each include, lines that must occur once: lines that are replaced, and functions that our code calls. */
export const ENGINE_LINES = {
	pbrBlockDirectLighting: [ LIGHTS_BEGIN ],
	lightFragment: [ 'info.specular=computeAreaSpecularLighting(preInfo,light{X}.vLightSpecular.rgb,clearcoatOut.specularEnvironmentR0,reflectivityOut.colorReflectanceF90);' ],
	lightUboDeclaration: [ '{vec4 vLightData;vec4 vLightDiffuse;vec4 vLightSpecular;', 'vec4 vLightWidth;vec4 vLightHeight;' ],
	pbrBlockAnisotropic: [ '{float anisotropy;vec3 anisotropicTangent;' ],
	pbrBlockGeometryInfo: [ 'vec2 AARoughnessFactors=getAARoughnessFactors(normalW.xyz);' ],
	pbrHelperFunctions: [ 'float convertRoughnessToAverageSlope(float roughness)' ],
};

const HAS_AREA_LIGHTS = '#if defined(AREALIGHTUSED) && defined(SPECULARTERM)';

/** The code without comments, because Babylon breaks lines at semicolons, even in comments. */
const uncommented = ( code ) => code.replace( /\/\/.*$/gm, '' );

/** The code before `main`. */
export const definitions = ( normalsGlsl ) => uncommented( `
${ HAS_AREA_LIGHTS }
${ normalsGlsl }
struct AreaRectangle { vec3 centre; vec3 halfWidth; vec3 halfHeight; };
// x - y is weighed by f0, y by f90 (Schlick).
vec2 area_parts( NormalsView view, mat3 toTangentFrame, AreaRectangle light, vec3 position ) {
	vec3 toCentre = light.centre - position;
	// Babylon's corners run counterclockwise as seen from the side that emits, which is the light's -z. These must run clockwise.
	vec3 corners[ 4 ] = vec3[ 4 ](
		toTangentFrame * ( toCentre + light.halfWidth + light.halfHeight ),
		toTangentFrame * ( toCentre - light.halfWidth + light.halfHeight ),
		toTangentFrame * ( toCentre - light.halfWidth - light.halfHeight ),
		toTangentFrame * ( toCentre + light.halfWidth - light.halfHeight )
	);
	return normals_rectangle( view, corners, false );
}
#endif
` );

/**
 * The code before the lights. Babylon writes the code of each light one after another. Here a loop runs over the rectangles, so
 * drivers compile the closed form once.
 *
 * @param {number} most - The most lights that the material may have.
 * @param {boolean} hasUbo - Whether uniforms of lights are in buffers.
 */
export function lightsBegin( most, hasUbo ) {

	const uniform = ( i, name ) => hasUbo ? `light${ i }.${ name }.xyz` : `${ name }${ i }.xyz`;
	const collect = ( _, i ) => `
#if defined(AREALIGHT${ i }) && !defined(RECTAREALIGHTEMISSIONTEXTURE${ i })
	int area${ i } = areaCount ++;
	areaRectangles[ area${ i } ] = AreaRectangle( ${ uniform( i, 'vLightData' ) }, ${ uniform( i, 'vLightWidth' ) }, ${ uniform( i, 'vLightHeight' ) } );
#endif`;
	return uncommented( `${ LIGHTS_BEGIN }
${ HAS_AREA_LIGHTS }
	vec2 areaAlphas = vec2( convertRoughnessToAverageSlope( roughness ) );
	vec3 areaAlong = abs( normalW.x ) < 0.9 ? vec3( 1.0, 0.0, 0.0 ) : vec3( 0.0, 1.0, 0.0 );
#ifdef ANISOTROPIC
	areaAlphas = getAnisotropicRoughness( areaAlphas.x, anisotropicOut.anisotropy );
	areaAlong = anisotropicOut.anisotropicTangent;
#endif
	areaAlphas = max( areaAlphas, vec2( square( AARoughnessFactors.x ) ) );
	// The tangent frame. GGX is symmetric in y, so the frame is right-handed for any texture coordinates.
	areaAlong = normalize( areaAlong - normalW * dot( normalW, areaAlong ) );
	mat3 areaFrame = transpose( mat3( areaAlong, cross( normalW, areaAlong ), normalW ) );
	// An interpolated normal may face away from the viewer.
	vec3 areaView = areaFrame * viewDirectionW;
	NormalsView areaLobe = normals_view( areaAlphas.x, areaAlphas.y, normalize( vec3( areaView.xy, max( areaView.z, 1e-3 ) ) ) );
	AreaRectangle areaRectangles[ ${ most } ];
	vec2 areaParts[ ${ most } ];
	int areaCount = 0;${ Array.from( { length: most }, collect ).join( '' ) }
	for ( int i = 0; i < areaCount; i ++ ) {
		areaParts[ i ] = area_parts( areaLobe, areaFrame, areaRectangles[ i ], vPositionW );
	}
#endif
` );

}

/** The replacement of a light's line. $0 is the line, $1 its colour, $2 its number, $3 and $4 the material's f0 and f90. */
export const forLight = `
#if defined(RECTAREALIGHTEMISSIONTEXTURE$2)
$0
#else
info.specular = $1 * ( $3 * ( areaParts[ area$2 ].x - areaParts[ area$2 ].y ) + $4 * areaParts[ area$2 ].y );
#endif
`;
