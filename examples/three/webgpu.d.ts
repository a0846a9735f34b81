// Area lights on anisotropic GGX for WebGPURenderer of three.js.

import type { Material, MeshPhysicalMaterial, MeshStandardMaterial } from 'three';
import type { MeshStandardNodeMaterial } from 'three/webgpu';

/** What `ltcforge shader --model normals` prints in WGSL and GLSL ES: modules of `ltcforge-three/shaders`. */
export interface ClosedFormTexts {
	wgsl: string;
	/** For where WebGPURenderer falls back on WebGL 2. */
	glsl?: string;
}

/** Lights a material's gloss and clearcoat by three's rectangular lights in closed form. Patches it in place. */
export function withClosedFormAreaLights<M extends MeshStandardMaterial | MeshStandardNodeMaterial>( material: M, texts: ClosedFormTexts ): M;

/** Takes the patch off a material. */
export function withoutAreaLights<M extends Material>( material: M ): M;

/** Sets GGX alpha along the tangent and across it, in (0, 1], as three's `roughness`, `anisotropy` and `anisotropyRotation`. */
export function setAlphas( material: MeshStandardMaterial | MeshPhysicalMaterial, alphaX: number, alphaY: number ): void;
