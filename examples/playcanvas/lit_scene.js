// The scene of the examples in PlayCanvas.

import * as pc from 'playcanvas';

import { glowOf, meshOf } from '../common/mesh.js';
import { axesOf, camera as eye, surfaces } from '../common/scene.js';
import { setAlphas } from './alphas.js';

/** An application that draws on request. By default PlayCanvas uses clustered lighting. */
export function application( isClustered = true ) {

	const app = new pc.Application( document.createElement( 'canvas' ), { graphicsDeviceOptions: { antialias: false } } );
	app.autoRender = false;
	app.start();
	app.scene.clusteredLightingEnabled = isClustered;
	app.scene.lighting.areaLightsEnabled = true;
	app.scene.ambientLight = new pc.Color( 0, 0, 0 );
	return app;

}

function entityOf( app, { positions, normals, tangents, uvs, indices }, material ) {

	const geometry = new pc.Geometry();
	// PlayCanvas takes the direction of the anisotropy from the tangents.
	Object.assign( geometry, { positions, normals, tangents, uvs, indices } );
	const entity = new pc.Entity();
	entity.addComponent( 'render', { meshInstances: [ new pc.MeshInstance( pc.Mesh.fromGeometry( app.graphicsDevice, geometry ), material ) ] } );
	return entity;

}

/** A light of PlayCanvas. An omni light emits from both sides, a spot light of half of all directions from one side. */
function lightOf( lamp ) {

	const light = new pc.Entity( 'light' );
	light.addComponent( 'light', {
		type: 'spot', shape: pc.LIGHTSHAPE_RECT, innerConeAngle: 89.99, outerConeAngle: 90, range: 1000, intensity: 1,
		color: new pc.Color( ...lamp.radiance ).gamma(), castShadows: false,
	} );
	// The sides of a light are along x and z. It emits along -y. Its scale is its size.
	const [ x, y, z ] = axesOf( lamp );
	const turned = new pc.Mat4().set( [ ...x, 0, ...z.map( ( value ) => - value ), 0, ...y, 0, 0, 0, 0, 1 ] );
	light.setLocalRotation( new pc.Quat().setFromMat4( turned ) );
	light.setLocalPosition( ...lamp.centre );
	light.setLocalScale( lamp.width, 1, lamp.height );
	return light;

}

/**
 * @param {Object[]} lamps - Lights as in scene.js.
 * @param {function(pc.StandardMaterial): pc.StandardMaterial} patch - Patches the material of a surface.
 * @param {Object[]} [shown] - The surfaces.
 * @returns {pc.Entity} Surfaces, lights and a camera below `app.root`. Destroy it before you create another.
 */
export function litScene( app, lamps, patch, shown = surfaces ) {

	const scene = new pc.Entity();
	app.root.addChild( scene );
	for ( const surface of shown ) {

		// PlayCanvas takes the f0 of metal from the colour. Plastic without diffuse light is metal of a dark colour.
		const material = new pc.StandardMaterial();
		material.useMetalness = true;
		material.metalness = 1;
		material.diffuse = new pc.Color( ...surface.f0 ).gamma();
		material.useFog = false;
		setAlphas( material, ...surface.alpha );
		scene.addChild( entityOf( app, meshOf( surface ), patch( material ) ) );

	}

	for ( const lamp of lamps ) {

		scene.addChild( lightOf( lamp ) );
		const glow = new pc.StandardMaterial();
		glow.useLighting = false;
		glow.diffuse = pc.Color.BLACK;
		glow.emissive = new pc.Color( ...lamp.radiance ).gamma();
		glow.update();
		scene.addChild( entityOf( app, glowOf( lamp ), glow ) );

	}

	const camera = new pc.Entity( 'camera' );
	camera.addComponent( 'camera', {
		clearColor: new pc.Color( 0, 0, 0, 1 ), nearClip: 0.1, farClip: 100, fov: eye.fov,
		toneMapping: pc.TONEMAP_LINEAR, gammaCorrection: pc.GAMMA_NONE,
	} );
	camera.setPosition( ...eye.eye );
	camera.lookAt( ...eye.target );
	scene.addChild( camera );
	return scene;

}

/** A picture as numbers: linear radiance, four floats a pixel, from the bottom left. */
export async function render( app, scene, width, height ) {

	const colorBuffer = new pc.Texture( app.graphicsDevice, {
		width, height, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST,
	} );
	const renderTarget = new pc.RenderTarget( { colorBuffer, depth: true } );
	scene.findByName( 'camera' ).camera.renderTarget = renderTarget;
	app.renderNextFrame = true;
	app.tick();
	const pixels = await colorBuffer.read( 0, 0, width, height, { renderTarget, immediate: true } );
	scene.findByName( 'camera' ).camera.renderTarget = null;
	renderTarget.destroy();
	colorBuffer.destroy();
	return pixels;

}
