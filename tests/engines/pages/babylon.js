// Babylon.js: PBRMaterial, RectAreaLight. Alpha is roughness^2. With the colours c of the light and f0 of the material,
// gloss is c (c f0 A + (1 - c) F) of the table times the light's part of the lobe. Babylon uses the light's specular
// colour where other engines use f0. Therefore plastic is white metal here under a light of colour 0.04, divided by
// this colour. Babylon fetches its table from its own server, whose `core` folder Tools.AssetBaseUrl replaces.

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/** Draws every picture, like the function for three.js, but without its third argument. `tables` is required. */
export async function draw( tables, dielectric ) {

	const BABYLON = await library();
	BABYLON.Tools.AssetBaseUrl = tables;
	// The camera takes its aspect ratio from the canvas, not from the render target.
	const canvas = Object.assign( document.createElement( 'canvas' ), { width, height } );
	const engine = new BABYLON.Engine( canvas, false );
	const scene = new BABYLON.Scene( engine );
	scene.useRightHandedSystem = true;
	scene.clearColor = new BABYLON.Color4( 0, 0, 0, 1 );
	// Linear radiance: no tone mapping and no gamma at the end of the material.
	scene.imageProcessingConfiguration.applyByPostProcess = true;

	const floor = BABYLON.MeshBuilder.CreateGround( 'table', { width: 2 * table.halfX, height: 2 * table.halfZ }, scene );
	const material = new BABYLON.PBRMaterial( 'metal', scene );
	material.metallic = 1;
	material.albedoColor = BABYLON.Color3.White();
	// The table is fitted to single scattering. This option would add an approximation of multiple scattering.
	material.brdf.useEnergyConservation = false;
	floor.material = material;
	const plastic = material.clone( 'plastic' );
	if ( dielectric ) {

		const { bindOwnTables, loadTables } = await import( '/docs/dielectrics_babylon.js' );
		bindOwnTables( plastic, await loadTables( `${ dielectric }/areaLights/areaLightsLTC.bin`, scene ) );

	}

	const lamp = new BABYLON.RectAreaLight( 'lamp', BABYLON.Vector3.Zero(), light.width, light.height, scene );
	// The light shines along -z and rotates only with its parent.
	const holder = new BABYLON.TransformNode( 'holder', scene );
	const [ x, y, z ] = light.axes.map( ( axis ) => new BABYLON.Vector3( ...axis ) );
	holder.rotationQuaternion = BABYLON.Quaternion.RotationQuaternionFromAxis( x.negate(), y, z.negate() );
	holder.position.set( ...light.centre );
	lamp.parent = holder;

	const camera = new BABYLON.FreeCamera( 'camera', BABYLON.Vector3.Zero(), scene );
	camera.minZ = 0.1;
	camera.maxZ = 100;
	const target = new BABYLON.RenderTargetTexture( 'target', { width, height }, scene, {
		type: BABYLON.Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: BABYLON.Texture.NEAREST_SAMPLINGMODE,
	} );
	target.activeCamera = camera;
	target.renderList = [ floor ];
	scene.customRenderTargets.push( target );

	// Textures report that they are ready before their numbers are loaded, so this waits for the table.
	const { LTC1, LTC2 } = scene._ltcTextures;
	await Promise.all( [ LTC1, LTC2 ].map( ( texture ) => updated( BABYLON, texture ) ) );

	const drawn = [];
	for ( const { f0, roughness, view } of pictures ) {

		lamp.specular = new BABYLON.Color3( f0, f0, f0 );
		floor.material = f0 === 0.04 ? plastic : material;
		floor.material.roughness = roughness;
		camera.fov = view.fov * Math.PI / 180;
		camera.position.set( ...view.eye );
		camera.setTarget( new BABYLON.Vector3( ...view.target ) );
		await scene.whenReadyAsync( true );
		scene.render();
		drawn.push( redFromTop( await target.readPixels() ).map( ( x ) => x / f0 ) );

	}

	engine.dispose();
	return drawn;

}

/** Resolves when a texture has its numbers. Fails if Babylon logs that the numbers are missing. */
function updated( BABYLON, texture ) {

	return new Promise( ( resolve, reject ) => {

		BABYLON.Logger.OnNewCacheEntry = ( entry ) => {

			if ( entry.includes( 'LTC' ) ) reject( new Error( entry ) );

		};
		const update = texture.update.bind( texture );
		texture.update = ( data ) => {

			update( data );
			resolve();

		};

	} );

}

/** Loads the script of Babylon, which is not a module. */
export function library() {

	return new Promise( ( resolve, reject ) => {

		if ( window.BABYLON ) return resolve( window.BABYLON );
		const script = document.createElement( 'script' );
		script.src = '/node_modules/babylonjs/babylon.js';
		script.onload = () => resolve( window.BABYLON );
		script.onerror = () => reject( new Error( `no ${ script.src }` ) );
		document.head.append( script );

	} );

}
