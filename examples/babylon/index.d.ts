// Area lights on anisotropic GGX for Babylon.js. Babylon's types are not imported, because there are two packages of it.

/** A material with the shader of PBRMaterial. */
export interface GgxMaterial {
	readonly anisotropy: { isEnabled: boolean; intensity: number; legacy: boolean };
	isMetallicWorkflow(): boolean;
}

/** The global BABYLON, or an object with these members of `@babylonjs/core`. */
export interface Babylon {
	MaterialPluginBase: new ( ...args: any[] ) => { name: string };
	RegisterClass( name: string, type: any ): void;
	ShaderStore: { IncludesShadersStore: Record<string, string> };
}

/**
 * Lights a material's gloss by Babylon's rectangular lights, in closed form.
 *
 * @param material - The material, which gets a plugin. Throws for another shader, or for another version of Babylon.
 * @param normalsGlsl - The output of `ltcforge shader --model normals --language glsl-es`: a module of `ltcforge-babylon/shaders`.
 */
export function withClosedFormAreaLights<M extends GgxMaterial>( material: M, normalsGlsl: string, babylon: Babylon ): M;

/** Gives a material Babylon's own area lights back. */
export function withoutAreaLights<M extends { getClassName(): string }>( material: M ): M;

/** The class of the plugin. After this call, Babylon finds it by name in the file of a scene. */
export function areaLightsPlugin<B extends Babylon>( babylon: B ): B['MaterialPluginBase'];

/** Sets GGX alpha along the tangent and across it, in (0, 1], by Babylon's `roughness` and `anisotropy`. */
export function setAlphas( material: GgxMaterial, alphaX: number, alphaY: number ): void;
