// Area lights on anisotropic GGX for PlayCanvas.

import type { GraphicsDevice, StandardMaterial } from 'playcanvas';

/**
 * Lights a material's gloss and clearcoat by PlayCanvas' rectangular lights in closed form.
 *
 * @param material - Gets shader chunks, and is updated. Throws if it has such chunks, or if those of this PlayCanvas are others.
 * @param normalsGlsl - What `ltcforge shader --model normals --language glsl-es` prints: a module of `ltcforge-playcanvas/shaders`.
 * @param device - The application's `graphicsDevice`, of WebGL 2.
 */
export function withClosedFormAreaLights<M extends StandardMaterial>( material: M, normalsGlsl: string, device: GraphicsDevice ): M;

/** Gives a material PlayCanvas' own area lights back, and leaves chunks of the user's. */
export function withoutAreaLights<M extends StandardMaterial>( material: M ): M;

/** Sets GGX alpha along the tangent and across it, in (0, 1], as PlayCanvas' `gloss` and `anisotropyIntensity`. */
export function setAlphas( material: StandardMaterial, alphaX: number, alphaY: number ): void;
