// Draws the scene with Babylon.js alone and with the three rules of the closed form, and shows the truth next to them.

import { compare, height, lamps, width } from '../common/page.js';
import { fromTop } from '../common/pixels.js';
import { withClosedFormAreaLights } from './ggx_area_light.js';
import { litScene, render, tableOf } from './lit_scene.js';
import balanced from './shaders/normals_balanced.glsl.js';
import fast from './shaders/normals_fast.glsl.js';
import fine from './shaders/normals_fine.glsl.js';

const engine = new BABYLON.Engine( Object.assign( document.createElement( 'canvas' ), { width, height } ), false );
const pictures = {};
for ( const [ name, text ] of Object.entries( { stock: null, fast, balanced, fine } ) ) {

	const scene = litScene( engine, lamps, ( material ) => text ? withClosedFormAreaLights( material, text, BABYLON ) : material );
	if ( ! text ) await tableOf( scene );
	pictures[ name ] = fromTop( await render( scene, width, height ), width, height );
	scene.dispose();

}

await compare( 'Babylon.js', pictures );
