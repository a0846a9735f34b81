// Area lights on anisotropic GGX for WebGPURenderer of three.js.

import type { Material, MeshStandardMaterial } from 'three';
import type { MeshStandardNodeMaterial } from 'three/webgpu';

/** The output of `ltcforge shader` for `--model normals` or `--model ltc-formula` in WGSL and GLSL ES: modules of `ltcforge-three/shaders`. */
export interface ClosedFormTexts {
	wgsl: string;
	/** The text for WebGPURenderer's fallback on WebGL 2. */
	glsl?: string;
}

/** Lights a material's gloss and clearcoat by three's rectangular lights, in closed form. Patches the material in place. */
export function withClosedFormAreaLights<M extends MeshStandardMaterial | MeshStandardNodeMaterial>( material: M, texts: ClosedFormTexts ): M;

/** Removes the patch from a material. */
export function withoutAreaLights<M extends Material>( material: M ): M;

export { setAlphas } from './index.js';
