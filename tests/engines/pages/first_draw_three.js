// Measures the first draw of a floor in three.js.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { lightsOf, surfaces } from '/examples/common/scene.js';
import { loadTable, withClosedFormAreaLights, withTableAreaLights } from '/examples/three/ggx_area_light.js';
import { litScene } from '/examples/three/lit_scene.js';
import { textOf } from './first_draw_text.js';

/** Milliseconds from a first draw to the pixels of a floor under these lights. */
export async function firstDraw( way, lights, clearcoat ) {

	const renderer = new THREE.WebGLRenderer();
	const target = new THREE.WebGLRenderTarget( 32, 32 );
	const camera = new THREE.PerspectiveCamera( 40, 1, 0.1, 100 );
	camera.position.set( 0, 2, 3 );
	camera.lookAt( 0, 0, 0 );
	const milliseconds = ( scene ) => {

		const start = performance.now();
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const pixels = new Uint8Array( 4 * 32 * 32 );
		renderer.readRenderTargetPixels( target, 0, 0, 32, 32, pixels );
		if ( pixels.every( ( value, i ) => i % 4 === 3 || value === 0 ) ) throw new Error( 'nothing was drawn' );
		return performance.now() - start;

	};

	RectAreaLightUniformsLib.init();
	const text = await textOf( 'three', way );
	const table = way === 'table' && await loadTable( '/examples/three/table/', new KTX2Loader().detectSupport( renderer ) );
	const patch = ( material ) => {

		material.clearcoat = clearcoat ? 1 : 0;
		if ( table ) return withTableAreaLights( material, text, table );
		return text ? withClosedFormAreaLights( material, text ) : material;

	};
	const shown = [ surfaces[ 0 ] ];
	// The start of the context and of the lamps, which have basic materials, is not measured.
	milliseconds( litScene( lightsOf( lights ), ( material ) => new THREE.MeshBasicMaterial( { color: material.color } ), { shown } ) );
	return milliseconds( litScene( lightsOf( lights ), patch, { shown } ) );

}
