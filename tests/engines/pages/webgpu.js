// WebGPURenderer with the patch of examples/three: the scene of examples/three by stock three.js, by ltc-formula and by each rule, also
// under clearcoat, and the milliseconds of each first draw.

import * as THREE from 'three/webgpu';
import { RectAreaLightTexturesLib } from 'three/addons/lights/RectAreaLightTexturesLib.js';
import { camera as eye, lightsOf, surfaces } from '/examples/common/scene.js';
import { litScene } from '/examples/three/lit_scene.js';
import { withClosedFormAreaLights, withoutAreaLights } from '/examples/three/webgpu.js';

/**
 * @param {{ width: number, height: number, lights: number, forceWebGL: boolean, only?: number, ways?: string[] }} what
 * @returns {Promise<Object>} The backend, pictures from the top left with four numbers per pixel, milliseconds, and how often the shader
 * under one light and under four names the functions of a light.
 */
export async function draw( { width, height, lights, forceWebGL, only, ways } ) {

	THREE.RectAreaLightNode.setLTC( RectAreaLightTexturesLib.init() );
	const renderer = new THREE.WebGPURenderer( { forceWebGL } );
	await renderer.init();
	const camera = new THREE.PerspectiveCamera( eye.fov, width / height, 0.1, 100 );
	camera.position.set( ...eye.eye );
	camera.lookAt( ...eye.target );
	const target = new THREE.RenderTarget( width, height, { type: THREE.FloatType } );
	const render = async ( scene ) => {

		const start = performance.now();
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const read = new Float32Array( ( await renderer.readRenderTargetPixelsAsync( target, 0, 0, width, height ) ).buffer );
		const milliseconds = performance.now() - start;
		// WebGPU aligns rows to 256 bytes, and these rows are already aligned. WebGPU starts at the top, and WebGL at the
		// bottom.
		if ( read.length !== 4 * width * height ) throw new Error( `${ read.length } numbers were read` );
		const stride = 4 * width;
		const rows = Array.from( { length: height }, ( _, row ) => {

			const from = ( forceWebGL ? height - 1 - row : row ) * stride;
			return [ ...read.subarray( from, from + 4 * width ) ];

		} );
		return { milliseconds, pixels: rows.flat() };

	};

	const texts = async ( rule ) => {

		const name = rule === 'formula' ? 'ltc_formula' : `normals_${ rule }`;
		return {
			wgsl: ( await import( `/examples/three/shaders/${ name }.wgsl.js` ) ).default,
			glsl: ( await import( `/examples/three/shaders/${ name }.glsl.js` ) ).default,
		};

	};
	const lamps = lightsOf( lights );
	await render( litScene( [], ( material ) => new THREE.MeshBasicMaterial( { color: material.color } ) ) );
	const of = {};
	for ( const way of ways || [ 'stock', 'formula', 'fast', 'balanced', 'fine', 'node', 'clone', 'undone' ] ) {

		const text = way === 'stock' ? null : await texts( [ 'formula', 'fast', 'fine' ].includes( way ) ? way : 'balanced' );
		const patch = {
			stock: ( material ) => material,
			clone: ( material ) => withClosedFormAreaLights( material, text ).clone(),
			undone: ( material ) => withoutAreaLights( withClosedFormAreaLights( material, text ) ),
		}[ way ] || ( ( material ) => withClosedFormAreaLights( material, text ) );
		of[ way ] = await render( litScene( lamps, patch, {
			Material: way === 'node' ? THREE.MeshPhysicalNodeMaterial : THREE.MeshPhysicalMaterial,
			shown: only === undefined ? surfaces : [ surfaces[ only ] ],
		} ) );

	}

	const named = [];
	for ( const count of ways ? [] : [ 1, 4 ] ) {

		const text = await texts( 'fast' );
		const scene = litScene( lightsOf( count ), ( material ) => withClosedFormAreaLights( Object.assign( material, { clearcoat: 1 } ), text ) );
		const { fragmentShader } = await renderer.debug.getShaderAsync( scene, camera, scene.children[ 0 ] );
		named.push( fragmentShader.match( /(gloss_base|gloss_coat|LTC_Evaluate|fn\d+)\b/g ).length );

	}

	let refusal = null;
	try {

		withClosedFormAreaLights( new THREE.MeshBasicNodeMaterial(), await texts( 'fast' ) );

	} catch ( error ) {

		refusal = error.message;

	}

	return { backend: renderer.backend.constructor.name, of, named, refusal };

}
