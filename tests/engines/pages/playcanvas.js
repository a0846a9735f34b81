// PlayCanvas: StandardMaterial, an omni light with the shape of a rectangle. Radiance is colour times intensity times a
// window that ends at the light's range. Gloss is f0 A + (1 - f0) F of the table times the light's part of the lobe.
// PlayCanvas reads the table at (1 - gloss)^2, the alpha of its other lights, but the table expects the root of alpha.
// Therefore area lights are sharper than other lights on the same material. Gloss is set here so that the table is read
// at the intended roughness. The light shines from both sides.

import * as pc from 'playcanvas';

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/** Draws every picture, like the function for three.js, but without its third argument. `tables` is required. */
export async function draw( tables, dielectric ) {

	const app = new pc.Application( document.createElement( 'canvas' ), { graphicsDeviceOptions: { antialias: false } } );
	app.autoRender = false;
	app.start();
	const load = async ( folder ) => {

		const luts = new pc.Asset( 'luts', 'json', { url: `${ folder }/area-light-luts.json` } );
		await new Promise( ( loaded, failed ) => {

			luts.ready( loaded );
			luts.on( 'error', failed );
			app.assets.add( luts );
			app.assets.load( luts );

		} );
		return luts.resource;

	};
	const metals = await load( tables );
	app.setAreaLightLuts( metals.LTC_MAT_1, metals.LTC_MAT_2 );
	app.scene.lighting.areaLightsEnabled = true;
	app.scene.ambientLight = new pc.Color( 0, 0, 0 );

	const material = new pc.StandardMaterial();
	material.useMetalness = true;
	material.useFog = false;
	// Metal and plastic. Only one of them is visible at a time.
	const floors = [ 0, 1 ].map( () => {

		const floor = new pc.Entity();
		floor.addComponent( 'render', { type: 'plane', material } );
		floor.setLocalScale( 2 * table.halfX, 1, 2 * table.halfZ );
		app.root.addChild( floor );
		return floor;

	} );
	if ( dielectric ) {

		const { bindOwnTables, tableTextures } = await import( '/docs/dielectrics_playcanvas.js' );
		const plastics = await load( dielectric );
		bindOwnTables( floors[ 1 ].render.meshInstances, tableTextures( app.graphicsDevice, plastics.LTC_MAT_1, plastics.LTC_MAT_2 ) );

	}

	const lamp = new pc.Entity();
	lamp.addComponent( 'light', {
		type: 'omni', shape: pc.LIGHTSHAPE_RECT, range: 1000, intensity: 1, color: new pc.Color( 1, 1, 1 ), castShadows: false,
	} );
	// The sides of the light run along x and z. It shines along -y, and scale is its size.
	const [ x, y, z ] = light.axes.map( ( axis ) => new pc.Vec3( ...axis ) );
	const turned = new pc.Mat4().set( [ x.x, x.y, x.z, 0, - z.x, - z.y, - z.z, 0, y.x, y.y, y.z, 0, 0, 0, 0, 1 ] );
	lamp.setLocalRotation( new pc.Quat().setFromMat4( turned ) );
	lamp.setLocalPosition( ...light.centre );
	lamp.setLocalScale( light.width, 1, light.height );
	app.root.addChild( lamp );

	const colorBuffer = new pc.Texture( app.graphicsDevice, {
		width, height, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST,
	} );
	const renderTarget = new pc.RenderTarget( { colorBuffer, depth: true } );
	const camera = new pc.Entity();
	camera.addComponent( 'camera', {
		clearColor: new pc.Color( 0, 0, 0, 1 ), nearClip: 0.1, farClip: 100, renderTarget,
		toneMapping: pc.TONEMAP_LINEAR, gammaCorrection: pc.GAMMA_NONE,
	} );
	app.root.addChild( camera );

	const drawn = [];
	for ( const { f0, roughness, view } of pictures ) {

		floors.forEach( ( floor, i ) => floor.enabled = i === Number( f0 === 0.04 ) );
		// Plastic in PlayCanvas has an f0 of 0.04.
		material.metalness = f0 === 0.04 ? 0 : 1;
		// Colours are not linear.
		const colour = f0 === 0.04 ? 0 : f0 ** ( 1 / 2.2 );
		material.diffuse = new pc.Color( colour, colour, colour );
		material.gloss = 1 - Math.sqrt( roughness );
		material.update();
		camera.camera.fov = view.fov;
		camera.setPosition( ...view.eye );
		camera.lookAt( ...view.target );
		app.renderNextFrame = true;
		app.tick();
		drawn.push( redFromTop( await colorBuffer.read( 0, 0, width, height, { renderTarget, immediate: true } ) ) );

	}

	app.destroy();
	return drawn;

}
