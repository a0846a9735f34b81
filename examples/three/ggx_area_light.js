// Area lights on anisotropic GGX for WebGLRenderer of three.js: replaces the lookup of linearly transformed cosines, which
// knows round lobes only. Either by the closed form that `ltcforge shader --model normals --language glsl-es` writes, which
// needs no table, or by a table that `ltcforge export --for wgpu` writes, with `ltcforge shader --layout reflected`.
//
// Works on MeshStandardMaterial and MeshPhysicalMaterial with three's own RectAreaLight, `roughness`, `anisotropy`,
// `anisotropyRotation`, anisotropyMap and clearcoat. Diffuse light stays three's. WebGPURenderer: see webgpu.js.

import { REVISION, ShaderChunk } from 'three';

import { LightPictures } from './light_pictures.js';
import { BY_NORMALS, BY_PICTURES, BY_TABLE, PATCHES } from './patches.js';

export { setAlphas } from './alphas.js';
export { LightPictures } from './light_pictures.js';

/** What is known of a patched material. */
const patches = new WeakMap();

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights in closed form.
 *
 * @param {import('three').MeshStandardMaterial} material - Patched in place.
 * @param {string} normalsGlsl - What `ltcforge shader --model normals --language glsl-es` prints, of any rule.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withClosedFormAreaLights( material, normalsGlsl ) {

	requireText( normalsGlsl, 'normals_rectangle(', 'ltcforge shader --model normals --language glsl-es' );
	return patch( material, normalsGlsl + BY_NORMALS, {} );

}

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights with a table.
 *
 * @param {import('three').MeshStandardMaterial} material - Patched in place.
 * @param {string} tableGlsl - What `ltcforge shader --layout reflected --language glsl-es` prints.
 * @param {{ uniforms: Object }} table - What {@link loadTable} gave. Materials share it.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withTableAreaLights( material, tableGlsl, table ) {

	requireText( tableGlsl, 'ltc_rectangle(', 'ltcforge shader --layout reflected --language glsl-es' );
	if ( ! table || ! table.uniforms ) throw new TypeError( 'table has to be what loadTable gave' );
	return patch( material, tableGlsl + BY_TABLE, table.uniforms );

}

/**
 * The same in closed form, where lights have pictures: in place of its colour alone, a light shines with its picture times its colour.
 *
 * @param {import('three').MeshStandardMaterial} material - Patched in place.
 * @param {string} texturedGlsl - What `ltcforge shader --model normals --textured 4 --language glsl-es` prints, of any rule.
 * @param {import('./light_pictures.js').LightPictures} pictures - Of the scene's first lights. Materials share them.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withPictureAreaLights( material, texturedGlsl, pictures ) {

	requireText( texturedGlsl, 'normals_textured_rectangle(', 'ltcforge shader --model normals --textured 4 --language glsl-es' );
	if ( ! ( pictures instanceof LightPictures ) ) throw new TypeError( 'pictures have to be LightPictures' );
	return patch( material, texturedGlsl + BY_PICTURES, pictures.uniforms );

}

/**
 * Takes the patch off a material, and leaves the user's own hooks. A material that has none stays as it is.
 *
 * @param {import('three').Material} material - The material, which is compiled anew at its next use.
 * @returns {import('three').Material} The material.
 */
export function withoutAreaLights( material ) {

	const patched = patches.get( material );
	if ( ! patched ) return material;
	patches.delete( material );
	for ( const name of OWN ) delete material[ name ];
	for ( const [ name, value ] of Object.entries( patched.own ) ) material[ name ] = value;
	material.needsUpdate = true;
	return material;

}

/**
 * Loads a table that `ltcforge export --for wgpu` wrote.
 *
 * @param {string | URL} address - Of the folder, with a slash at its end.
 * @param {import('three/addons/loaders/KTX2Loader.js').KTX2Loader} loader - After `detectSupport( renderer )`.
 * @returns {Promise<{ uniforms: Object, dispose: function(): void }>} The shader's uniforms, and what frees the textures.
 */
export async function loadTable( address, loader ) {

	const answer = await fetch( `${ address }ltc.json` );
	if ( ! answer.ok ) throw new Error( `${ address }ltc.json: ${ answer.status }` );
	const { textures, ltc_table } = await answer.json();
	const loaded = await Promise.all( textures.map( ( path ) => loader.loadAsync( address + path ) ) );
	const [ ltc_matrix_a, ltc_matrix_b, ltc_terms ] = loaded;
	const values = { ltc_table, ltc_matrix_a, ltc_matrix_b, ltc_terms };
	return {
		uniforms: Object.fromEntries( Object.entries( values ).map( ( [ name, value ] ) => [ name, { value } ] ) ),
		dispose: () => loaded.forEach( ( texture ) => texture.dispose() ),
	};

}

/** What a patched material has of its own, where others have their class's. */
const OWN = [ 'onBeforeCompile', 'customProgramCacheKey', 'clone', 'setupLightingModel' ];

/** Patches a material, or patches one anew. */
function patch( material, glsl, uniforms ) {

	requireMaterial( material );
	// Tells at once, rather than at the first frame, that this three.js has other lines.
	for ( const [ chunk, lines ] of Object.entries( PATCHES ) ) for ( const [ line ] of lines ) requireOnce( ShaderChunk[ chunk ] || '', line, `ShaderChunk.${ chunk }` );

	withoutAreaLights( material );
	const own = Object.fromEntries( OWN.filter( ( name ) => Object.hasOwn( material, name ) ).map( ( name ) => [ name, material[ name ] ] ) );
	const patched = { glsl, uniforms, own };
	patches.set( material, patched );

	hook( material, patched, 'onBeforeCompile', ( users ) => function ( shader, renderer ) {

		users.call( this, shader, renderer );
		// A hook of the user's that calls this one may outlive the patch.
		if ( patches.get( material ) !== patched ) return;
		Object.assign( shader.uniforms, uniforms );
		shader.fragmentShader = patchedShader( shader.fragmentShader, glsl );

	} );
	hook( material, patched, 'customProgramCacheKey', ( users ) => function () {

		return patches.get( material ) === patched ? `${ glsl }\n${ users.call( this ) }` : users.call( this );

	} );

	// three's clone() leaves hooks behind, the user's too.
	Object.defineProperty( material, 'clone', { configurable: true, writable: true, value() {

		return patch( ( patched.own.clone || Object.getPrototypeOf( this ).clone ).call( this ), glsl, uniforms );

	} } );

	// WebGPURenderer makes a node material of this one, with all that can be enumerated, and never calls the hooks.
	Object.defineProperty( material, 'setupLightingModel', { configurable: true, enumerable: true, value() {

		throw new Error( 'this material is patched for WebGLRenderer; WebGPURenderer takes those of ltcforge-three/webgpu' );

	} } );
	material.needsUpdate = true;
	return material;

}

/**
 * Makes a hook of a material one that also does ours, whenever the user sets it.
 *
 * @param {function(function): function} around - Makes the hook that calls the user's.
 */
function hook( material, patched, name, around ) {

	const stock = () => Object.getPrototypeOf( material )[ name ];
	let both;
	const set = ( users ) => {

		if ( users ) patched.own[ name ] = users; else delete patched.own[ name ];
		// three's key is the text of `onBeforeCompile`: of the user's, since ours has the same text for all.
		const isStockKey = name === 'customProgramCacheKey' && ( users || stock() ) === stock();
		both = around( isStockKey ? () => String( patched.own.onBeforeCompile || '' ) : users || stock() );

	};

	set( patched.own[ name ] );
	// A hook that calls the one before it calls ours too: the patch is made once, see `patchedShader`.
	Object.defineProperty( material, name, { configurable: true, enumerable: true, get: () => both, set } );

}

/** Tells a shader that is patched. */
const MARK = '// ltcforge: gloss of rectangular lights';

/** A fragment shader with our gloss. */
function patchedShader( shader, glsl ) {

	if ( shader.includes( MARK ) ) return shader;
	for ( const [ chunk, lines ] of Object.entries( PATCHES ) ) {

		// A hook of the user's may have put the chunk's text here already.
		shader = shader.replace( `#include <${ chunk }>`, () => ShaderChunk[ chunk ] );
		for ( const [ line, by ] of lines ) {

			requireOnce( shader, line, 'the fragment shader, after the material\'s own onBeforeCompile,' );
			shader = shader.replace( placesOf( line ), () => typeof by === 'function' ? by( `${ MARK }\n${ glsl }` ) : by );

		}

	}

	return shader;

}

/** Where a text has a line: three's builds leave out white space that its sources have. */
function placesOf( line ) {

	return new RegExp( line.trim().split( /\s+/ ).map( ( word ) => word.replace( /[^\w]/g, '\\$&' ) ).join( '\\s+' ), 'g' );

}

function requireOnce( text, line, where ) {

	if ( ( text.match( placesOf( line ) ) || [] ).length === 1 ) return;
	throw new Error( `${ where } of three.js r${ REVISION } has not exactly one place with \`${ line.trim() }\`; this patch is for r187` );

}

function requireText( text, needed, command ) {

	if ( typeof text !== 'string' || ! text.includes( needed ) ) throw new TypeError( `the shader has to be the text that \`${ command }\` prints` );

}

function requireMaterial( material ) {

	if ( material && material.isNodeMaterial ) throw new TypeError( `${ material.type } is a node material of WebGPURenderer: ltcforge-three/webgpu lights those` );
	if ( ! material || ! material.isMeshStandardMaterial ) {

		throw new TypeError( `${ material && material.type || material } has no GGX lobe: MeshStandardMaterial and MeshPhysicalMaterial have one` );

	}

}
