// Area lights on anisotropic GGX for WebGLRenderer of three.js.

import type { Material, MeshStandardMaterial, Texture, WebGLRenderer } from 'three';
import type { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

/** A table's textures and numbers, as uniforms of the shader. Materials share it. */
export interface AreaLightTable {
	readonly uniforms: Record<string, { value: unknown }>;
	/** Frees the textures. Call this when no material uses them. */
	dispose(): void;
}

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights, in closed form.
 *
 * @param material - The material, which is patched in place. Throws if it has no GGX lobe, or for another version of three.js.
 * @param glsl - The output of `ltcforge shader --language glsl-es` for `--model normals` or `--model ltc-formula`: a module of
 * `ltcforge-three/shaders`.
 */
export function withClosedFormAreaLights<M extends MeshStandardMaterial>( material: M, glsl: string ): M;

/** Like {@link withClosedFormAreaLights}, with a table. `tableGlsl` is the output of `ltcforge shader --layout reflected --language glsl-es`. */
export function withTableAreaLights<M extends MeshStandardMaterial>( material: M, tableGlsl: string, table: AreaLightTable ): M;

/** Pictures on the first lights of a scene, in three's order, prefiltered on the GPU. Materials share them. */
export class LightPictures {
	/**
	 * @param prefilterGlsl - The output of `ltcforge shader --as prefilter --language glsl-es`: `ltcforge-three/shaders/prefilter.glsl.js`.
	 * @param width - Texels along the lights' width; they should be square on the lights.
	 * @param height - Texels along the lights' height.
	 * @param layers - The number of lights with pictures; default 1.
	 */
	constructor( prefilterGlsl: string, width: number, height: number, layers?: number );
	/** Prefilters a picture, a canvas or a video's frame for a light. Call this whenever it changes, before the surfaces are drawn. */
	update( renderer: WebGLRenderer, texture: Texture, layer?: number ): void;
	/** Frees the textures. Call this when no material uses them. */
	dispose(): void;
}

/**
 * Like {@link withClosedFormAreaLights}, for lights with pictures.
 *
 * @param texturedGlsl - The output of `ltcforge shader --model normals --textured 4 --language glsl-es`.
 */
export function withPictureAreaLights<M extends MeshStandardMaterial>( material: M, texturedGlsl: string, pictures: LightPictures ): M;

/** Removes the patch from a material, and keeps the user's own hooks. */
export function withoutAreaLights<M extends Material>( material: M ): M;

/** Loads a table from `ltcforge export --for wgpu`. The address of the folder ends with a slash. */
export function loadTable( address: string | URL, loader: KTX2Loader ): Promise<AreaLightTable>;

/** The fields that {@link setAlphas} sets in a standard or physical material, or in a node material. */
export interface GgxMaterial {
	readonly type: string;
	roughness: number;
	anisotropy?: number;
	anisotropyRotation?: number;
}

/** Sets GGX alpha along the tangent and across it, in (0, 1], by three's `roughness`, `anisotropy` and `anisotropyRotation`. */
export function setAlphas( material: GgxMaterial, alphaX: number, alphaY: number ): void;
