// three.js: MeshStandardMaterial, RectAreaLight. Radiance is colour times intensity; alpha is roughness^2, roughness at
// least 0.045; gloss is f0 A + (f90 - f0) F of the table times the light's part of the lobe.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/**
 * Draws every picture.
 *
 * @param {?string} tables - Address of the folder of the tables' files; nothing for those that three brings along.
 * @param {?string} dielectric - Address of the folder of those for dielectrics; nothing where one set lights all.
 * @returns {Promise<number[][]>} The red channel of each, linear, from the top left.
 */
export async function draw( tables, dielectric ) {

	RectAreaLightUniformsLib.init();
	if ( tables ) {

		const { createLTC } = await import( `${ tables }/ltc.js` );
		Object.assign( THREE.UniformsLib, createLTC( THREE ) );

	}

	const plastic = new THREE.MeshStandardMaterial( { color: 0x000000 } );
	if ( dielectric ) {

		const { createLTC } = await import( `${ dielectric }/ltc.js` );
		bindOwnTables( plastic, createLTC( THREE ) );

	}

	const renderer = new THREE.WebGLRenderer( { canvas: document.createElement( 'canvas' ) } );
	// Else three takes the tables in half floats.
	if ( ! renderer.extensions.has( 'OES_texture_float_linear' ) ) throw new Error( 'float textures are not filtered here' );

	const scene = new THREE.Scene();
	const metal = new THREE.MeshStandardMaterial( { metalness: 1 } );
	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 2 * table.halfX, 2 * table.halfZ ), metal );
	floor.rotation.x = - Math.PI / 2;
	const lamp = new THREE.RectAreaLight( 0xffffff, 1, light.width, light.height );
	// It shines along -z.
	const [ x, y, z ] = light.axes.map( ( axis ) => new THREE.Vector3( ...axis ) );
	lamp.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	lamp.position.set( ...light.centre );
	scene.add( floor, lamp );

	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	const pixels = new Float32Array( 4 * width * height );
	const drawn = pictures.map( ( { f0, roughness, view } ) => {

		// three's plastic has an f0 of 0.04.
		floor.material = f0 === 0.04 ? plastic : metal;
		metal.color.setScalar( f0 );
		floor.material.roughness = roughness;
		const camera = new THREE.PerspectiveCamera( view.fov, width / height, 0.1, 100 );
		camera.position.set( ...view.eye );
		camera.lookAt( ...view.target );
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
		return redFromTop( pixels );

	} );

	renderer.dispose();
	return drawn;

}

/** Lights a material by tables of its own; the same function stands in docs/engines.md. */
function bindOwnTables( material, tables ) {

	material.onBeforeCompile = ( shader ) => {

		// three assigns the tables of all materials later, without effect.
		shader.uniforms.ltc_1 = { get value() { return tables.LTC_FLOAT_1; }, set value( _ ) {} };
		shader.uniforms.ltc_2 = { get value() { return tables.LTC_FLOAT_2; }, set value( _ ) {} };

	};

}
