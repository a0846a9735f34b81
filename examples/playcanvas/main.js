// Draws the scene with PlayCanvas alone and with the three rules of the closed form, and shows the truth next to them.

import { compare, height, lamps, width } from '../common/page.js';
import { fromTop } from '../common/pixels.js';
import { withClosedFormAreaLights } from './ggx_area_light.js';
import { application, litScene, render } from './lit_scene.js';
import balanced from './shaders/normals_balanced.glsl.js';
import fast from './shaders/normals_fast.glsl.js';
import fine from './shaders/normals_fine.glsl.js';

/** PlayCanvas' own table, which is not in its package. The closed form needs none. */
const TABLE = 'https://raw.githubusercontent.com/playcanvas/engine/main/examples/assets/json/area-light-luts.json';

// With ?unclustered, the shader contains the code of each light.
const app = application( ! new URLSearchParams( location.search ).has( 'unclustered' ) );
const table = await ( await fetch( TABLE ) ).json();
app.setAreaLightLuts( table.LTC_MAT_1, table.LTC_MAT_2 );

const pictures = {};
for ( const [ name, text ] of Object.entries( { stock: null, fast, balanced, fine } ) ) {

	const scene = litScene( app, lamps, ( material ) => text ? withClosedFormAreaLights( material, text, app.graphicsDevice ) : material );
	pictures[ name ] = fromTop( await render( app, scene, width, height ), width, height );
	scene.destroy();

}

await compare( 'PlayCanvas', pictures );
