// Area lights on anisotropic GGX for PlayCanvas. They replace the lookup of linearly transformed cosines, which supports
// isotropic lobes only, by the closed form from `ltcforge shader --model normals --language glsl-es`. It needs no table.
//
// This works on StandardMaterial with PlayCanvas' lights of shape rectangle, `gloss`, `anisotropyIntensity` and clearcoat, by
// shader chunks of the material. Diffuse light, disks and spheres do not change.

import { SHADERLANGUAGE_GLSL, ShaderChunks, StandardMaterial } from 'playcanvas';

import { collect, closedForm, PATCHES } from './patches.js';

export { setAlphas } from './alphas.js';

/** The mark of a patched chunk. */
const MARK = '// ltcforge: gloss of rectangular lights';

/** The chunk that only this patch uses. */
const COLLECT = 'ltcforgeCollectPS';

/** The version of chunks for a material without one, so that debug builds do not complain. */
const CHUNKS_VERSION = '2.8';

/**
 * Lights a material's gloss and clearcoat by PlayCanvas' rectangular lights, in closed form.
 *
 * @param {import('playcanvas').StandardMaterial} material - The material. It gets shader chunks, and is updated.
 * @param {string} normalsGlsl - The output of `ltcforge shader --model normals --language glsl-es`, with any rule.
 * @param {import('playcanvas').GraphicsDevice} device - The device of the application, whose chunks are changed for this material.
 * @returns {import('playcanvas').StandardMaterial} The material.
 */
export function withClosedFormAreaLights( material, normalsGlsl, device ) {

	requireText( normalsGlsl );
	if ( ! ( material instanceof StandardMaterial ) ) throw new TypeError( `${ material && material.constructor.name } has no GGX lobe: StandardMaterial has one` );
	if ( ! device || ! device.isWebGL2 ) throw new TypeError( 'these chunks are for WebGL 2: the third argument must be a graphicsDevice with WebGL 2' );

	const chunks = material.getShaderChunks( SHADERLANGUAGE_GLSL );
	const patched = Object.entries( PATCHES ).map( ( [ name, lines ] ) => {

		if ( chunks.has( name ) && ! chunks.get( name ).includes( MARK ) ) throw new Error( `the material has a chunk ${ name } of its own, which this patch would replace` );
		return [ name, patchedChunk( name, ShaderChunks.get( device, SHADERLANGUAGE_GLSL ).get( name ) || '', lines, normalsGlsl ) ];

	} );
	for ( const [ name, chunk ] of patched ) chunks.set( name, chunk );
	chunks.set( COLLECT, collect );
	if ( ! material.shaderChunksVersion ) material.shaderChunksVersion = CHUNKS_VERSION;
	material.update();
	return material;

}

/**
 * Gives a material PlayCanvas' own area lights back, and keeps the user's chunks.
 *
 * @param {import('playcanvas').StandardMaterial} material - The material. An unpatched material does not change.
 * @returns {import('playcanvas').StandardMaterial} The material.
 */
export function withoutAreaLights( material ) {

	if ( ! material.hasShaderChunks ) return material;
	const chunks = material.getShaderChunks( SHADERLANGUAGE_GLSL );
	for ( const name of Object.keys( PATCHES ) ) if ( chunks.has( name ) && chunks.get( name ).includes( MARK ) ) chunks.delete( name );
	chunks.delete( COLLECT );
	material.update();
	return material;

}

/** A chunk with our gloss. */
function patchedChunk( name, chunk, lines, normalsGlsl ) {

	for ( const [ line, by ] of lines ) {

		if ( ( chunk.match( placesOf( line ) ) || [] ).length !== 1 ) {

			throw new Error( `chunk ${ name } of this PlayCanvas must contain \`${ line }\` exactly once; this patch is for 2.23` );

		}

		chunk = chunk.replace( placesOf( line ), () => by === closedForm ? closedForm( normalsGlsl ) : by );

	}

	return `${ MARK }\n${ chunk }`;

}

/** The place of a line in a text. Some builds of PlayCanvas leave out white space. */
function placesOf( line ) {

	return new RegExp( line.split( /\s+/ ).map( ( word ) => word.replace( /[^\w]/g, '\\$&' ) ).join( '\\s+' ), 'g' );

}

function requireText( text ) {

	if ( typeof text === 'string' && text.includes( 'normals_rectangle(' ) && text.includes( 'NormalsView normals_view(' ) ) return;
	throw new TypeError( 'the shader must be the output of `ltcforge shader --model normals --language glsl-es`' );

}
