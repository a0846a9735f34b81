// Area lights on anisotropic GGX for WebGLRenderer of three.js. They replace the lookup of linearly transformed cosines, which
// supports isotropic lobes only. There are two ways: a closed form from `ltcforge shader --language glsl-es`, with `--model normals`
// or `--model ltc-formula`, which needs no table; or a table from `ltcforge export --for wgpu` with the shader from `ltcforge shader --layout reflected`.
//
// This works on MeshStandardMaterial and MeshPhysicalMaterial with three's RectAreaLight, `roughness`, `anisotropy`,
// `anisotropyRotation`, anisotropyMap and clearcoat. Diffuse light does not change. For WebGPURenderer, see webgpu.js.

import { REVISION, ShaderChunk } from 'three';

import { LightPictures } from './light_pictures.js';
import { BY_FORMULA, BY_NORMALS, BY_PICTURES, BY_TABLE, PATCHES } from './patches.js';

export { setAlphas } from './alphas.js';
export { LightPictures } from './light_pictures.js';

/** The data of each patched material. */
const patches = new WeakMap();

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights, in closed form.
 *
 * @param {import('three').MeshStandardMaterial} material - The material, which is patched in place.
 * @param {string} glsl - The output of `ltcforge shader --language glsl-es` for `--model normals` with any rule, or for
 * `--model ltc-formula`.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withClosedFormAreaLights( material, glsl ) {

	if ( String( glsl ).includes( 'ltc_formula(' ) ) return patch( material, glsl + BY_FORMULA, {} );
	requireText( glsl, 'normals_rectangle(', 'ltcforge shader --model normals (or ltc-formula) --language glsl-es' );
	return patch( material, glsl + BY_NORMALS, {} );

}

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights, with a table.
 *
 * @param {import('three').MeshStandardMaterial} material - The material, which is patched in place.
 * @param {string} tableGlsl - The output of `ltcforge shader --layout reflected --language glsl-es`.
 * @param {{ uniforms: Object }} table - The result of {@link loadTable}. Materials share it.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withTableAreaLights( material, tableGlsl, table ) {

	requireText( tableGlsl, 'ltc_rectangle(', 'ltcforge shader --layout reflected --language glsl-es' );
	if ( ! table || ! table.uniforms ) throw new TypeError( 'table must be the result of loadTable' );
	return patch( material, tableGlsl + BY_TABLE, table.uniforms );

}

/**
 * Lights a material in closed form by lights with pictures. Such a light emits its picture times its colour.
 *
 * @param {import('three').MeshStandardMaterial} material - The material, which is patched in place.
 * @param {string} texturedGlsl - The output of `ltcforge shader --model normals --textured 4 --language glsl-es`, with any rule.
 * @param {import('./light_pictures.js').LightPictures} pictures - The pictures of the first lights. Materials share them.
 * @returns {import('three').MeshStandardMaterial} The material.
 */
export function withPictureAreaLights( material, texturedGlsl, pictures ) {

	requireText( texturedGlsl, 'normals_textured_rectangle(', 'ltcforge shader --model normals --textured 4 --language glsl-es' );
	if ( ! ( pictures instanceof LightPictures ) ) throw new TypeError( 'pictures must be LightPictures' );
	return patch( material, texturedGlsl + BY_PICTURES, pictures.uniforms );

}

/**
 * Removes the patch from a material, and keeps the user's own hooks. An unpatched material does not change.
 *
 * @param {import('three').Material} material - The material. It is compiled again at its next use.
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
 * Loads a table from `ltcforge export --for wgpu`.
 *
 * @param {string | URL} address - The address of the folder, with a slash at its end.
 * @param {import('three/addons/loaders/KTX2Loader.js').KTX2Loader} loader - A loader after `detectSupport( renderer )`.
 * @returns {Promise<{ uniforms: Object, dispose: function(): void }>} The shader's uniforms, and a function that frees the textures.
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

/** The properties that a patched material has itself. Other materials inherit them from their class. */
const OWN = [ 'onBeforeCompile', 'customProgramCacheKey', 'clone', 'setupLightingModel' ];

/** Patches a material, also if it is patched already. */
function patch( material, glsl, uniforms ) {

	requireMaterial( material );
	// Reports another version of three.js now, and not at the first frame.
	for ( const [ chunk, lines ] of Object.entries( PATCHES ) ) for ( const [ line ] of lines ) requireOnce( ShaderChunk[ chunk ] || '', line, `ShaderChunk.${ chunk }` );

	withoutAreaLights( material );
	const own = Object.fromEntries( OWN.filter( ( name ) => Object.hasOwn( material, name ) ).map( ( name ) => [ name, material[ name ] ] ) );
	const patched = { glsl, uniforms, own };
	patches.set( material, patched );

	hook( material, patched, 'onBeforeCompile', ( users ) => function ( shader, renderer ) {

		users.call( this, shader, renderer );
		// A user's hook that calls this hook may outlive the patch.
		if ( patches.get( material ) !== patched ) return;
		Object.assign( shader.uniforms, uniforms );
		shader.fragmentShader = patchedShader( shader.fragmentShader, glsl );

	} );
	hook( material, patched, 'customProgramCacheKey', ( users ) => function () {

		return patches.get( material ) === patched ? `${ glsl }\n${ users.call( this ) }` : users.call( this );

	} );

	// three's clone() does not copy hooks, neither ours nor the user's.
	Object.defineProperty( material, 'clone', { configurable: true, writable: true, value() {

		return patch( ( patched.own.clone || Object.getPrototypeOf( this ).clone ).call( this ), glsl, uniforms );

	} } );

	// WebGPURenderer builds a node material from the enumerable properties of this material, and never calls the hooks.
	Object.defineProperty( material, 'setupLightingModel', { configurable: true, enumerable: true, value() {

		throw new Error( 'this material is patched for WebGLRenderer; use ltcforge-three/webgpu with WebGPURenderer' );

	} } );
	material.needsUpdate = true;
	return material;

}

/**
 * Makes a hook of a material that also calls ours, whenever the user sets the hook.
 *
 * @param {function(function): function} around - Makes a hook that calls the user's hook.
 */
function hook( material, patched, name, around ) {

	const stock = () => Object.getPrototypeOf( material )[ name ];
	let both;
	const set = ( users ) => {

		if ( users ) patched.own[ name ] = users; else delete patched.own[ name ];
		// three's cache key is the text of the user's `onBeforeCompile`, because ours has the same text for all materials.
		const isStockKey = name === 'customProgramCacheKey' && ( users || stock() ) === stock();
		both = around( isStockKey ? () => String( patched.own.onBeforeCompile || '' ) : users || stock() );

	};

	set( patched.own[ name ] );
	// A hook that calls the previous hook calls ours too. The patch is applied once, see `patchedShader`.
	Object.defineProperty( material, name, { configurable: true, enumerable: true, get: () => both, set } );

}

/** The mark of a patched shader. */
const MARK = '// ltcforge: gloss of rectangular lights';

/** A fragment shader with our gloss. */
function patchedShader( shader, glsl ) {

	if ( shader.includes( MARK ) ) return shader;
	for ( const [ chunk, lines ] of Object.entries( PATCHES ) ) {

		// A user's hook may have inserted the text of the chunk already.
		shader = shader.replace( `#include <${ chunk }>`, () => ShaderChunk[ chunk ] );
		for ( const [ line, by ] of lines ) {

			requireOnce( shader, line, 'the fragment shader, after the material\'s own onBeforeCompile,' );
			shader = shader.replace( placesOf( line ), () => typeof by === 'function' ? by( `${ MARK }\n${ glsl }` ) : by );

		}

	}

	return shader;

}

/** The place of a line in a text. three's builds leave out white space that its sources have. */
function placesOf( line ) {

	return new RegExp( line.trim().split( /\s+/ ).map( ( word ) => word.replace( /[^\w]/g, '\\$&' ) ).join( '\\s+' ), 'g' );

}

function requireOnce( text, line, where ) {

	if ( ( text.match( placesOf( line ) ) || [] ).length === 1 ) return;
	throw new Error( `${ where } of three.js r${ REVISION } must contain \`${ line.trim() }\` exactly once; this patch is for r187` );

}

function requireText( text, needed, command ) {

	if ( typeof text !== 'string' || ! text.includes( needed ) ) throw new TypeError( `the shader must be the output of \`${ command }\`` );

}

function requireMaterial( material ) {

	if ( material && material.isNodeMaterial ) throw new TypeError( `${ material.type } is a node material of WebGPURenderer: use ltcforge-three/webgpu` );
	if ( ! material || ! material.isMeshStandardMaterial ) {

		throw new TypeError( `${ material && material.type || material } has no GGX lobe: MeshStandardMaterial and MeshPhysicalMaterial have one` );

	}

}
