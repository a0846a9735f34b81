// three.js with WebGPURenderer, which falls back to WebGL 2 without WebGPU. Everything else is as in three.js.

import * as THREE from 'three/webgpu';
import { RectAreaLightTexturesLib } from 'three/addons/lights/RectAreaLightTexturesLib.js';

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/** Draws every picture, as in three.js. */
export async function draw( tables, dielectric, isMixed ) {

	const load = async ( folder ) => ( await import( `${ folder }/ltc.js` ) ).createLTC( THREE );
	THREE.RectAreaLightNode.setLTC( tables ? await load( tables ) : RectAreaLightTexturesLib.init() );
	const renderer = new THREE.WebGPURenderer( { canvas: document.createElement( 'canvas' ) } );
	await renderer.init();
	const isWebGPU = renderer.backend.isWebGPUBackend === true;

	const plastic = new THREE.MeshStandardMaterial( { color: 0x000000 } );
	const metal = new THREE.MeshStandardMaterial( { metalness: 1 } );
	if ( dielectric ) {

		const { bindOwnTables, mixTables } = await import( '/docs/dielectrics_three_webgpu.js' );
		( isMixed ? mixTables : bindOwnTables )( isMixed ? metal : plastic, await load( dielectric ) );

	}

	const scene = new THREE.Scene();
	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 2 * table.halfX, 2 * table.halfZ ), metal );
	floor.rotation.x = - Math.PI / 2;
	const lamp = new THREE.RectAreaLight( 0xffffff, 1, light.width, light.height );
	// The light shines along -z.
	const [ x, y, z ] = light.axes.map( ( axis ) => new THREE.Vector3( ...axis ) );
	lamp.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	lamp.position.set( ...light.centre );
	scene.add( floor, lamp );

	const target = new THREE.RenderTarget( width, height, { type: THREE.FloatType } );
	const drawn = [];
	for ( const { f0, roughness, view } of pictures ) {

		// Plastic in three.js has an f0 of 0.04.
		const isPlastic = f0 === 0.04;
		floor.material = isPlastic && ! isMixed ? plastic : metal;
		metal.color.setScalar( isPlastic ? 0 : f0 );
		metal.metalness = isPlastic ? 0 : 1;
		floor.material.roughness = roughness;
		const camera = new THREE.PerspectiveCamera( view.fov, width / height, 0.1, 100 );
		camera.position.set( ...view.eye );
		camera.lookAt( ...view.target );
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const read = new Float32Array( ( await renderer.readRenderTargetPixelsAsync( target, 0, 0, width, height ) ).buffer );
		// WebGPU starts at the top, and its rows are multiples of 256 bytes.
		const stride = isWebGPU ? Math.ceil( 16 * width / 256 ) * 64 : 4 * width;
		drawn.push( isWebGPU ? Array.from( { length: width * height }, ( _, i ) => read[ Math.floor( i / width ) * stride + 4 * ( i % width ) ] ) : redFromTop( read ) );

	}

	renderer.dispose();
	return drawn;

}
