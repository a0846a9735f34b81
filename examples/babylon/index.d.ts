// Area lights on anisotropic GGX for Babylon.js. Types of Babylon's are not imported, since there are two packages of it.

/** A material that is lit by the shader of PBRMaterial. */
export interface GgxMaterial {
	readonly anisotropy: { isEnabled: boolean; intensity: number; legacy: boolean };
	isMetallicWorkflow(): boolean;
}

/** The global BABYLON, or these of `@babylonjs/core`. */
export interface Babylon {
	MaterialPluginBase: new ( ...args: any[] ) => { name: string };
	RegisterClass( name: string, type: any ): void;
	ShaderStore: { IncludesShadersStore: Record<string, string> };
}

/**
 * Lights a material's gloss by Babylon's rectangular lights in closed form.
 *
 * @param material - Gets a plugin. Throws if its shader is another, or that of another Babylon.
 * @param normalsGlsl - What `ltcforge shader --model normals --language glsl-es` prints: a module of `ltcforge-babylon/shaders`.
 */
export function withClosedFormAreaLights<M extends GgxMaterial>( material: M, normalsGlsl: string, babylon: Babylon ): M;

/** Gives a material Babylon's own area lights back. */
export function withoutAreaLights<M extends { getClassName(): string }>( material: M ): M;

/** The plugin's class, by whose name Babylon finds it in the file of a scene, once this was called. */
export function areaLightsPlugin<B extends Babylon>( babylon: B ): B['MaterialPluginBase'];

/** Sets GGX alpha along the tangent and across it, in (0, 1], as Babylon's `roughness` and `anisotropy`. */
export function setAlphas( material: GgxMaterial, alphaX: number, alphaY: number ): void;
