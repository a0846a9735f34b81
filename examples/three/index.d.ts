// Area lights on anisotropic GGX for WebGLRenderer of three.js.

import type { Material, MeshPhysicalMaterial, MeshStandardMaterial, Texture, WebGLRenderer } from 'three';
import type { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

/** A table's textures and numbers as the shader takes them. Materials share it. */
export interface AreaLightTable {
	readonly uniforms: Record<string, { value: unknown }>;
	/** Frees the textures, once no material uses them. */
	dispose(): void;
}

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights in closed form.
 *
 * @param material - Patched in place. Throws if it has no GGX lobe, or if this three.js has other shaders.
 * @param normalsGlsl - What `ltcforge shader --model normals --language glsl-es` prints: a module of `ltcforge-three/shaders`.
 */
export function withClosedFormAreaLights<M extends MeshStandardMaterial>( material: M, normalsGlsl: string ): M;

/** The same with a table. `tableGlsl` is what `ltcforge shader --layout reflected --language glsl-es` prints. */
export function withTableAreaLights<M extends MeshStandardMaterial>( material: M, tableGlsl: string, table: AreaLightTable ): M;

/** Pictures on the first lights of a scene, in three's order, prefiltered on the GPU. Materials share them. */
export class LightPictures {
	/**
	 * @param prefilterGlsl - What `ltcforge shader --as prefilter --language glsl-es` prints: `ltcforge-three/shaders/prefilter.glsl.js`.
	 * @param width - Texels along the lights' width, best square on them.
	 * @param height - Texels along their height.
	 * @param layers - How many lights have a picture; 1.
	 */
	constructor( prefilterGlsl: string, width: number, height: number, layers?: number );
	/** Prefilters a picture, a canvas or a video's frame for a light: whenever it changes, before the surfaces are drawn. */
	update( renderer: WebGLRenderer, texture: Texture, layer?: number ): void;
	/** Frees the textures, once no material uses them. */
	dispose(): void;
}

/**
 * As {@link withClosedFormAreaLights}, where lights have pictures.
 *
 * @param texturedGlsl - What `ltcforge shader --model normals --textured 4 --language glsl-es` prints.
 */
export function withPictureAreaLights<M extends MeshStandardMaterial>( material: M, texturedGlsl: string, pictures: LightPictures ): M;

/** Takes the patch off a material, and leaves its own hooks. */
export function withoutAreaLights<M extends Material>( material: M ): M;

/** Loads what `ltcforge export --for wgpu` wrote. The address of the folder ends with a slash. */
export function loadTable( address: string | URL, loader: KTX2Loader ): Promise<AreaLightTable>;

/** Sets GGX alpha along the tangent and across it, in (0, 1], as three's `roughness`, `anisotropy` and `anisotropyRotation`. */
export function setAlphas( material: MeshStandardMaterial | MeshPhysicalMaterial, alphaX: number, alphaY: number ): void;
