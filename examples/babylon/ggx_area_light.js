// Area lights on anisotropic GGX for Babylon.js. They replace the lookup of linearly transformed cosines, which supports
// isotropic lobes only, by the closed form from `ltcforge shader --model normals --language glsl-es`. It needs no table.
//
// This works on PBRMaterial, PBRMetallicRoughnessMaterial and PBRSpecularGlossinessMaterial with Babylon's RectAreaLight,
// `roughness` and `anisotropy`. Diffuse light does not change. The module imports nothing: pass it the global BABYLON or a
// namespace of @babylonjs/core.

import { definitions, ENGINE_LINES, forLight, lightPattern, LIGHTS_BEGIN, lightsBegin } from './patches.js';

export { setAlphas } from './alphas.js';

/**
 * Lights a material's gloss by Babylon's rectangular lights, in closed form.
 *
 * @param {Object} material - A PBRMaterial or one of its simpler forms. It gets a plugin.
 * @param {string} normalsGlsl - The output of `ltcforge shader --model normals --language glsl-es`, with any rule.
 * @param {Object} BABYLON - An object with MaterialPluginBase, RegisterClass and ShaderStore.
 * @returns {Object} The material.
 */
export function withClosedFormAreaLights( material, normalsGlsl, BABYLON ) {

	requireText( normalsGlsl );
	requireMaterial( material );
	// Reports another version of Babylon now, and not at the first frame. Modules of @babylonjs/core load shaders with the first
	// material; then `getCustomCode` reports it.
	if ( BABYLON.ShaderStore.IncludesShadersStore.lightFragment ) requireEngineLines( BABYLON, material );
	const Plugin = areaLightsPlugin( BABYLON );
	( pluginOf( material ) || new Plugin( material ) ).normalsGlsl = normalsGlsl;
	return material;

}

/**
 * Gives a material Babylon's own area lights back. Babylon cannot remove a plugin, so ours stays and adds nothing.
 *
 * @param {Object} material - The material. An unpatched material does not change.
 * @returns {Object} The material.
 */
export function withoutAreaLights( material ) {

	const plugin = pluginOf( material );
	if ( plugin ) plugin.normalsGlsl = '';
	return material;

}

/** The name of the plugin and of its class. */
const NAME = 'LtcforgeAreaLights';

const pluginOf = ( material ) => material.pluginManager ? material.pluginManager.getPlugin( NAME ) : null;

/** Classes of the plugin, by the MaterialPluginBase that they extend. */
const classes = new WeakMap();

/** The texts in use. Babylon shares shaders by their defines, so each text needs a number in the defines. */
const texts = [ '' ];

/**
 * The class of the plugin. Call this before Babylon parses a scene with patched materials, because it finds the class by name.
 *
 * @param {Object} BABYLON - An object with MaterialPluginBase, RegisterClass and ShaderStore.
 */
export function areaLightsPlugin( BABYLON ) {

	if ( classes.has( BABYLON.MaterialPluginBase ) ) return classes.get( BABYLON.MaterialPluginBase );

	class LtcforgeAreaLights extends BABYLON.MaterialPluginBase {

		constructor( material ) {

			requireMaterial( material );
			super( material, NAME, 200, { LTCFORGE_AREA_LIGHTS: 0 } );
			this._enable( true );

		}

		getClassName() {

			return NAME;

		}

		/** The text of the closed form; empty for Babylon's own area lights. */
		get normalsGlsl() {

			return this._normalsGlsl || '';

		}

		set normalsGlsl( text ) {

			if ( text !== '' ) requireText( text );
			this._normalsGlsl = text;
			if ( ! texts.includes( text ) ) texts.push( text );
			this.markAllDefinesAsDirty();

		}

		prepareDefines( defines ) {

			defines.LTCFORGE_AREA_LIGHTS = texts.indexOf( this.normalsGlsl );

		}

		getCustomCode( shaderType ) {

			if ( shaderType !== 'fragment' ) return null;
			// Babylon asks for the places first, from its constructor, and then for the code with each shader.
			const hasUbo = this._material.getScene().getEngine().supportsUniformBuffers;
			const places = [ 'CUSTOM_FRAGMENT_DEFINITIONS', `!${ inPattern( LIGHTS_BEGIN ) }`, `!${ lightPattern( hasUbo ) }` ];
			if ( this.normalsGlsl === '' ) return Object.fromEntries( places.map( ( place ) => [ place, '' ] ) );
			requireEngineLines( BABYLON, this._material );
			const code = [ definitions( this.normalsGlsl ), lightsBegin( this._material.maxSimultaneousLights, hasUbo ), forLight ];
			return Object.fromEntries( places.map( ( place, i ) => [ place, code[ i ] ] ) );

		}

		serialize() {

			return { ...super.serialize(), normalsGlsl: this.normalsGlsl };

		}

		// The data come from a scene's file, or from the material that is cloned.
		parse( source, scene, rootUrl ) {

			super.parse( source, scene, rootUrl );
			this.normalsGlsl = source.normalsGlsl;

		}

	}

	BABYLON.RegisterClass( `BABYLON.${ NAME }`, LtcforgeAreaLights );
	classes.set( BABYLON.MaterialPluginBase, LtcforgeAreaLights );
	return LtcforgeAreaLights;

}

/** A pattern that matches a text. */
function inPattern( text ) {

	return text.replace( /[^\w ]/g, '\\$&' );

}

function requireEngineLines( { ShaderStore }, material ) {

	for ( const [ include, lines ] of Object.entries( ENGINE_LINES ) ) for ( const line of lines ) {

		if ( ( ShaderStore.IncludesShadersStore[ include ] || '' ).split( line ).length === 2 ) continue;
		const version = material.getScene().getEngine().constructor.Version;
		throw new Error( `${ include } of Babylon.js ${ version } must contain \`${ line }\` exactly once; install 9.34 or 9.35, with which this plugin is tested` );

	}

}

function requireText( text ) {

	if ( typeof text === 'string' && text.includes( 'normals_rectangle(' ) && text.includes( 'NormalsView normals_view(' ) ) return;
	throw new TypeError( 'the shader must be the output of `ltcforge shader --model normals --language glsl-es`' );

}

function requireMaterial( material ) {

	const name = material && material.getClassName ? material.getClassName() : material;
	if ( ! material || ! material.anisotropy || ! material.isMetallicWorkflow ) {

		throw new TypeError( `${ name } is not lit by the shader of PBRMaterial, as this plugin requires` );

	}

	// ShaderLanguage.GLSL is 0.
	if ( material.shaderLanguage !== 0 ) throw new TypeError( `${ name } has a shader in WGSL: this plugin is for WebGL 2` );
	if ( material.getScene().getEngine().webGLVersion < 2 ) throw new Error( 'this plugin needs WebGL 2' );

}
