// The shaders of the viewer. Their texts are in folder `glsl`.

import { reach } from '../service/api.js';

const NAMES = [ 'blended_lobes', 'covered', 'diffuse', 'display', 'edge', 'engines', 'errors', 'estevez', 'formula', 'ggx', 'glow', 'lights', 'mesh', 'mesh_vertex', 'neubelt', 'normals', 'one', 'outlines', 'reflected', 'sampled_lights', 'sampling', 'sheen', 'sides', 'sum', 'surface', 'surface_point', 'targets', 'truth', 'two_lobes', 'visible' ];

let texts = null;

/** Loads the texts. No shader can be made before. */
export async function loadShaders() {
	texts ??= Object.fromEntries( await Promise.all( NAMES.map( async ( name ) => [ name, await ( await reach( `/page/glsl/${ name }.glsl` ) ).text() ] ) ) );
}

/** A shader from texts by their names. Without precisions, the values of a sampler may have 16 bits. */
function shader( names, shapes = 0, before = '' ) {
	const precise = [ 'float', 'int', 'sampler2D', 'sampler2DArray' ].map( ( type ) => `precision highp ${ type };\n` ).join( '' );
	return `#version 300 es\n${ before }\n${ precise }#define SHAPES_USED ${ shapes }\n${ names.map( ( name ) => texts[ name ] ).join( '\n' ) }`;
}

/** The bits of `SHAPES_USED` for occluders, and for models with shadows. */
export const [ OCCLUDED, SHADOWED ] = [ 32, 64 ];

/** The sphere or the floor. The texts of surfaces write position, tangent frame and material to textures. */
export const surfaceShader = () => shader( [ 'targets', 'surface' ] );

export const meshVertex = () => shader( [ 'mesh_vertex' ] );

export const meshShader = ( isTextured ) => shader( [ 'targets', 'mesh' ], 0, isTextured ? '#define TEXTURED' : '' );

/** The lights and occluders as the camera sees them. `shapes` has a bit for each shape of the lights. */
export const glowShader = ( shapes ) => shader( [ 'lights', 'sampled_lights', 'glow' ], shapes );

/** The final image. */
export const displayShader = () => shader( [ 'sides', 'display' ] );

/** The errors of both sides. */
export const errorsShader = () => shader( [ 'sides', 'errors' ] );

/** The texts of the scattering models that the truth supports. */
const BRDFS = { ggx: [ 'ggx' ], charlie: [ 'estevez', 'sheen' ], charlie_neubelt: [ 'neubelt', 'sheen' ] };

/** Whether the truth supports a scattering model. */
export const hasReference = ( brdf ) => Object.hasOwn( BRDFS, brdf );

/** Adds samples of a scattering model to the truth. */
export const referenceShader = ( brdf, shapes ) => shader( [ 'surface_point', 'lights', 'sampled_lights', 'sampling', ...BRDFS[ brdf ], 'truth' ], shapes );

/** The visible part of each light at each pixel. `text` are the samplers of the service. */
export const shadowShader = ( brdf, text, shapes ) => shader( [ 'surface_point', 'lights', 'sampled_lights', 'outlines', 'sampling', ...BRDFS[ brdf ], 'visible' ], shapes, text );

/** The kinds of models that do not use the lobes of a table. */
const OTHERS = { normals: [ 'outlines', 'normals', 'reflected' ], engines: [ 'outlines', 'edge', 'engines', 'reflected' ], diffuse: [ 'outlines', 'edge', 'diffuse' ] };

/** The name of the sampler with all levels of the pictures, by kind of model. */
export const picturesOf = ( kind ) => `${ Object.hasOwn( OTHERS, kind ) ? kind : 'ltc' }_pictures`;

/** A kind of model: in `OTHERS`, or a way to use the lobes of a table or formula. `text` is the shader text of the service. */
export const modelShader = ( kind, text, shapes ) => shader( [ 'surface_point', 'lights', ...( OTHERS[ kind ] ?? [ 'covered', kind, 'reflected' ] ), 'sum' ], shapes, text );
