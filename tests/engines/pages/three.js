// three.js: MeshStandardMaterial, RectAreaLight. Radiance is colour times intensity. Alpha is roughness^2, and
// roughness is at least 0.045. Gloss is f0 A + (f90 - f0) F of the table times the light's part of the lobe.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/**
 * Draws every picture.
 *
 * @param {?string} tables - Address of the folder of the tables' files; `null` for the tables of three.js.
 * @param {?string} dielectric - Address of the folder of the files for dielectrics; `null` if one set lights all materials.
 * @param {boolean} isMixed - Whether all pictures use one material, whose shader mixes both sets by metalness.
 * @returns {Promise<number[][]>} The red channel of each picture, linear, from the top left.
 */
export async function draw( tables, dielectric, isMixed ) {

	RectAreaLightUniformsLib.init();
	if ( tables ) {

		const { createLTC } = await import( `${ tables }/ltc.js` );
		Object.assign( THREE.UniformsLib, createLTC( THREE ) );

	}

	const plastic = new THREE.MeshStandardMaterial( { color: 0x000000 } );
	const metal = new THREE.MeshStandardMaterial( { metalness: 1 } );
	if ( dielectric ) {

		const { createLTC } = await import( `${ dielectric }/ltc.js` );
		const { bindOwnTables, mixTables } = await import( '/docs/dielectrics_three.js' );
		if ( isMixed ) mixTables( metal, createLTC( THREE ) );
		else bindOwnTables( plastic, createLTC( THREE ) );

	}

	const renderer = new THREE.WebGLRenderer( { canvas: document.createElement( 'canvas' ) } );
	// Otherwise three.js would use the half-float tables.
	if ( ! renderer.extensions.has( 'OES_texture_float_linear' ) ) throw new Error( 'float textures are not filtered here' );

	const scene = new THREE.Scene();
	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 2 * table.halfX, 2 * table.halfZ ), metal );
	floor.rotation.x = - Math.PI / 2;
	const lamp = new THREE.RectAreaLight( 0xffffff, 1, light.width, light.height );
	// The light shines along -z.
	const [ x, y, z ] = light.axes.map( ( axis ) => new THREE.Vector3( ...axis ) );
	lamp.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	lamp.position.set( ...light.centre );
	scene.add( floor, lamp );

	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	const pixels = new Float32Array( 4 * width * height );
	const shot = ( roughness, view ) => {

		floor.material.roughness = roughness;
		const camera = new THREE.PerspectiveCamera( view.fov, width / height, 0.1, 100 );
		camera.position.set( ...view.eye );
		camera.lookAt( ...view.target );
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
		return redFromTop( pixels );

	};
	const drawn = pictures.map( ( { f0, roughness, view } ) => {

		// Plastic in three.js has an f0 of 0.04.
		const isPlastic = f0 === 0.04;
		floor.material = isPlastic && ! isMixed ? plastic : metal;
		metal.color.setScalar( isPlastic ? 0 : f0 );
		metal.metalness = isPlastic ? 0 : 1;
		return shot( roughness, view );

	} );
	if ( isMixed ) requireMixed( metal, pictures.map( ( { roughness, view } ) => () => shot( roughness, view ) ) );

	renderer.dispose();
	return drawn;

}

/** Checks that a material with metalness 0.25 equals the mix of its pictures as metal and as dielectric. */
function requireMixed( material, shots ) {

	material.color.setScalar( 0.5 );
	const [ plastic, metal, quarter ] = [ 0, 1, 0.25 ].map( ( metalness ) => {

		material.metalness = metalness;
		return shots.map( ( shot ) => shot() ).flat();

	} );
	const difference = Math.max( ...quarter.map( ( value, i ) => Math.abs( value - 0.75 * plastic[ i ] - 0.25 * metal[ i ] ) ) );
	if ( ! ( difference < 1e-4 ) || Math.max( ...metal ) < 0.1 ) throw new Error( `a material that is a quarter metal differs by ${ difference }` );

}
