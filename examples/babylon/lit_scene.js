// The scene of the examples in Babylon.js, which is the global BABYLON.

import { glowOf, meshOf } from '../common/mesh.js';
import { axesOf, camera as eye, surfaces } from '../common/scene.js';
import { setAlphas } from './alphas.js';

/** The factor moved from the lights to the materials. Babylon uses a light's colour as a reflectance too, so it is at most one. */
const BRIGHTEST = 2;

function meshIn( scene, { positions, normals, tangents, uvs, indices }, material ) {

	const mesh = new BABYLON.Mesh( 'mesh', scene );
	// Babylon takes the direction of the anisotropy from the tangents. Its triangles run clockwise.
	Object.assign( new BABYLON.VertexData(), { positions, normals, tangents, uvs, indices: indices.toReversed() } ).applyToMesh( mesh );
	mesh.material = material;
	return mesh;

}

/** A light of Babylon, which emits along -z and rotates only with its parent. */
export function lightIn( scene, lamp ) {

	const holder = new BABYLON.TransformNode( 'holder', scene );
	const [ x, y, z ] = axesOf( lamp ).map( ( axis ) => new BABYLON.Vector3( ...axis ) );
	holder.rotationQuaternion = BABYLON.Quaternion.RotationQuaternionFromAxis( x.negate(), y, z.negate() );
	holder.position.set( ...lamp.centre );
	const light = new BABYLON.RectAreaLight( 'light', BABYLON.Vector3.Zero(), lamp.width, lamp.height, scene );
	light.specular = new BABYLON.Color3( ...lamp.radiance ).scale( 1 / BRIGHTEST );
	light.parent = holder;
	return light;

}

/**
 * @param {Object[]} lamps - Lights as in scene.js.
 * @param {function(Object): Object} patch - Patches the material of a surface.
 * @param {Object[]} [shown] - The surfaces.
 * @param {{ rightHanded?: boolean }} [options] - A left-handed scene is mirrored.
 */
export function litScene( engine, lamps, patch, shown = surfaces, { rightHanded = true } = {} ) {

	const scene = new BABYLON.Scene( engine );
	scene.useRightHandedSystem = rightHanded;
	scene.clearColor = new BABYLON.Color4( 0, 0, 0, 1 );
	// The output is linear radiance: no tone mapping and no gamma.
	scene.imageProcessingConfiguration.applyByPostProcess = true;

	for ( const surface of shown ) {

		// Babylon takes the f0 of metal from the colour. Plastic without diffuse light is metal of a dark colour.
		const material = new BABYLON.PBRMaterial( 'metal', scene );
		material.metallic = 1;
		material.albedoColor = new BABYLON.Color3( ...surface.f0 );
		material.directIntensity = BRIGHTEST;
		material.maxSimultaneousLights = Math.max( lamps.length, 1 );
		// The truth has a single reflection. This option would add an estimate of further reflections.
		material.brdf.useEnergyConservation = false;
		setAlphas( material, ...surface.alpha );
		meshIn( scene, meshOf( surface ), patch( material ) );

	}

	for ( const lamp of lamps ) {

		lightIn( scene, lamp );
		const glow = new BABYLON.PBRMaterial( 'glow', scene );
		glow.unlit = true;
		glow.albedoColor = new BABYLON.Color3( ...lamp.radiance );
		meshIn( scene, glowOf( lamp ), glow );

	}

	const camera = new BABYLON.FreeCamera( 'camera', new BABYLON.Vector3( ...eye.eye ), scene );
	camera.fov = eye.fov * Math.PI / 180;
	camera.minZ = 0.1;
	camera.maxZ = 100;
	camera.setTarget( new BABYLON.Vector3( ...eye.target ) );
	return scene;

}

/** A picture as numbers: linear radiance, four floats a pixel, from the bottom left. The engine's canvas has the same shape. */
export async function render( scene, width, height ) {

	const target = new BABYLON.RenderTargetTexture( 'target', { width, height }, scene, {
		type: BABYLON.Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: BABYLON.Texture.NEAREST_SAMPLINGMODE,
	} );
	target.activeCamera = scene.activeCamera;
	target.renderList = scene.meshes.slice();
	scene.customRenderTargets.push( target );
	await scene.whenReadyAsync( true );
	scene.render();
	const pixels = await target.readPixels();
	scene.customRenderTargets.pop();
	target.dispose();
	return pixels;

}

/** Waits for the table of Babylon's own area lights. Its textures are ready before they have numbers. */
export function tableOf( scene ) {

	const { LTC1, LTC2 } = scene._ltcTextures;
	return Promise.all( [ LTC1, LTC2 ].map( ( texture ) => new Promise( ( resolve ) => {

		const { update } = texture;
		texture.update = function ( data ) {

			update.call( this, data );
			resolve();

		};

	} ) ) );

}
