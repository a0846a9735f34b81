// WebGPURenderer with the patch of examples/three: the scene of examples/three by stock three.js and by each rule, under
// clearcoat too, and the milliseconds to each first draw.

import * as THREE from 'three/webgpu';
import { RectAreaLightTexturesLib } from 'three/addons/lights/RectAreaLightTexturesLib.js';
import { setAlphas, withClosedFormAreaLights, withoutAreaLights } from '/example/webgpu.js';
import { axesOf, camera as eye, lightsOf, surfaces } from '/example/scene.js';

function place( object, surface, turned = 1 ) {

	const [ x, y, z ] = axesOf( surface ).map( ( axis ) => new THREE.Vector3( ...axis ) );
	object.matrixAutoUpdate = false;
	object.matrix.makeBasis( x.multiplyScalar( turned ), y, z.multiplyScalar( turned ) ).setPosition( ...surface.centre );
	return object;

}

function geometryOf( surface ) {

	const geometry = surface.radii ? new THREE.RingGeometry( ...surface.radii, 512 ) : new THREE.PlaneGeometry( ...surface.size );
	const { position } = geometry.attributes;
	const tangents = new Float32Array( position.count * 4 );
	for ( let i = 0; i < position.count; i ++ ) {

		const angle = surface.radii ? Math.atan2( position.getY( i ), position.getX( i ) ) : 0;
		tangents.set( [ Math.cos( angle ), Math.sin( angle ), 0, 1 ], 4 * i );

	}

	geometry.setAttribute( 'tangent', new THREE.BufferAttribute( tangents, 4 ) );
	return geometry;

}

function sceneOf( patch, lights, isNode, only ) {

	const scene = new THREE.Scene();
	for ( const surface of only === undefined ? surfaces : [ surfaces[ only ] ] ) {

		const material = new ( isNode ? THREE.MeshPhysicalNodeMaterial : THREE.MeshPhysicalMaterial )( { metalness: 1, color: new THREE.Color( ...surface.f0 ) } );
		setAlphas( material, ...surface.alpha );
		scene.add( place( new THREE.Mesh( geometryOf( surface ), patch( material ) ), surface ) );

	}

	for ( const lamp of lights ) {

		const colour = new THREE.Color( ...lamp.radiance );
		scene.add( place( new THREE.RectAreaLight( colour, 1, lamp.width, lamp.height ), lamp, - 1 ) );
		scene.add( place( new THREE.Mesh( new THREE.PlaneGeometry( lamp.width, lamp.height ), new THREE.MeshBasicMaterial( { color: colour } ) ), lamp ) );

	}

	return scene;

}

/**
 * @param {{ width: number, height: number, lights: number, forceWebGL: boolean, only?: number, ways?: string[] }} what
 * @returns {Promise<Object>} The backend, pictures from the top left, four numbers a pixel, and milliseconds.
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
		// WebGPU aligns rows to 256 bytes, which these are, and begins at the top; WebGL begins at the bottom.
		if ( read.length !== 4 * width * height ) throw new Error( `${ read.length } numbers were read` );
		const stride = 4 * width;
		const rows = Array.from( { length: height }, ( _, row ) => {

			const from = ( forceWebGL ? height - 1 - row : row ) * stride;
			return [ ...read.subarray( from, from + 4 * width ) ];

		} );
		return { milliseconds, pixels: rows.flat() };

	};

	const texts = async ( rule ) => ( {
		wgsl: ( await import( `/example/shaders/normals_${ rule }.wgsl.js` ) ).default,
		glsl: ( await import( `/example/shaders/normals_${ rule }.glsl.js` ) ).default,
	} );
	const lamps = lightsOf( lights );
	await render( sceneOf( ( material ) => new THREE.MeshBasicMaterial( { color: material.color } ), [], false ) );
	const of = {};
	for ( const way of ways || [ 'stock', 'fast', 'balanced', 'fine', 'node', 'clone', 'undone' ] ) {

		const text = way === 'stock' ? null : await texts( [ 'fast', 'fine' ].includes( way ) ? way : 'balanced' );
		const patch = {
			stock: ( material ) => material,
			clone: ( material ) => withClosedFormAreaLights( material, text ).clone(),
			undone: ( material ) => withoutAreaLights( withClosedFormAreaLights( material, text ) ),
		}[ way ] || ( ( material ) => withClosedFormAreaLights( material, text ) );
		of[ way ] = await render( sceneOf( patch, lamps, way === 'node', only ) );

	}

	let refusal = null;
	try {

		withClosedFormAreaLights( new THREE.MeshBasicNodeMaterial(), await texts( 'fast' ) );

	} catch ( error ) {

		refusal = error.message;

	}

	return { backend: renderer.backend.constructor.name, of, refusal };

}
