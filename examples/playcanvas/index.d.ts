// Area lights on anisotropic GGX for PlayCanvas.

import type { GraphicsDevice, StandardMaterial } from 'playcanvas';

/**
 * Lights a material's gloss and clearcoat by PlayCanvas' rectangular lights, in closed form.
 *
 * @param material - The material. It gets shader chunks, and is updated. Throws for a material with such chunks, or for another version of PlayCanvas.
 * @param normalsGlsl - The output of `ltcforge shader --model normals --language glsl-es`: a module of `ltcforge-playcanvas/shaders`.
 * @param device - The application's `graphicsDevice`, with WebGL 2.
 */
export function withClosedFormAreaLights<M extends StandardMaterial>( material: M, normalsGlsl: string, device: GraphicsDevice ): M;

/** Gives a material PlayCanvas' own area lights back, and keeps the user's chunks. */
export function withoutAreaLights<M extends StandardMaterial>( material: M ): M;

/** Sets GGX alpha along the tangent and across it, in (0, 1], by PlayCanvas' `gloss` and `anisotropyIntensity`. */
export function setAlphas( material: StandardMaterial, alphaX: number, alphaY: number ): void;
