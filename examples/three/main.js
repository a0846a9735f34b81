// Draws the scene with three.js alone, with a table, with an LTC without a table and with the three rules of the closed form, and shows the truth next to them.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

import { compare, height, lamps, width } from '../common/page.js';
import { fromTop } from '../common/pixels.js';
import { camera as eye } from '../common/scene.js';
import { loadTable, withClosedFormAreaLights, withTableAreaLights } from './ggx_area_light.js';
import { litScene } from './lit_scene.js';
import formula from './shaders/ltc_formula.glsl.js';
import balanced from './shaders/normals_balanced.glsl.js';
import fast from './shaders/normals_fast.glsl.js';
import fine from './shaders/normals_fine.glsl.js';
import tableGlsl from './shaders/table.glsl.js';

/** A picture as numbers: linear radiance, four floats a pixel, from the top left. */
function render( renderer, scene ) {

	const camera = new THREE.PerspectiveCamera( eye.fov, width / height, 0.1, 100 );
	camera.position.set( ...eye.eye );
	camera.lookAt( ...eye.target );
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	renderer.setRenderTarget( target );
	renderer.render( scene, camera );
	const pixels = new Float32Array( width * height * 4 );
	renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
	renderer.setRenderTarget( null );
	target.dispose();
	return fromTop( pixels, width, height );

}

const renderer = new THREE.WebGLRenderer();
const table = await loadTable( 'table/', new KTX2Loader().detectSupport( renderer ) );
// Stock three needs its tables. Our table and the closed form do not.
RectAreaLightUniformsLib.init();

await compare( 'three.js', {
	stock: render( renderer, litScene( lamps, ( material ) => material ) ),
	table: render( renderer, litScene( lamps, ( material ) => withTableAreaLights( material, tableGlsl, table ) ) ),
	...Object.fromEntries( Object.entries( { formula, fast, balanced, fine } ).map( ( [ rule, text ] ) =>
		[ rule, render( renderer, litScene( lamps, ( material ) => withClosedFormAreaLights( material, text ) ) ) ] ) ),
} );
