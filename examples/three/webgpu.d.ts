// Area lights on anisotropic GGX for WebGPURenderer of three.js.

import type { Material, MeshPhysicalMaterial, MeshStandardMaterial } from 'three';
import type { MeshStandardNodeMaterial } from 'three/webgpu';

/** The output of `ltcforge shader --model normals` in WGSL and GLSL ES: modules of `ltcforge-three/shaders`. */
export interface ClosedFormTexts {
	wgsl: string;
	/** The text for WebGPURenderer's fallback on WebGL 2. */
	glsl?: string;
}

/** Lights a material's gloss and clearcoat by three's rectangular lights, in closed form. Patches the material in place. */
export function withClosedFormAreaLights<M extends MeshStandardMaterial | MeshStandardNodeMaterial>( material: M, texts: ClosedFormTexts ): M;

/** Removes the patch from a material. */
export function withoutAreaLights<M extends Material>( material: M ): M;

/** Sets GGX alpha along the tangent and across it, in (0, 1], by three's `roughness`, `anisotropy` and `anisotropyRotation`. */
export function setAlphas( material: MeshStandardMaterial | MeshPhysicalMaterial, alphaX: number, alphaY: number ): void;
