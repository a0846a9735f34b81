// Measures the first draw of a floor in PlayCanvas.

import { lightsOf, surfaces } from '/examples/common/scene.js';
import { withClosedFormAreaLights } from '/examples/playcanvas/ggx_area_light.js';
import { application, litScene, render } from '/examples/playcanvas/lit_scene.js';
import { textOf } from './first_draw_text.js';

const TABLE = 'https://raw.githubusercontent.com/playcanvas/engine/main/examples/assets/json/area-light-luts.json';

/** Milliseconds from a first draw to the pixels of a floor under these lights. */
export async function firstDraw( way, lights, _, unclustered ) {

	const app = application( ! unclustered );
	const table = await ( await fetch( TABLE ) ).json();
	app.setAreaLightLuts( table.LTC_MAT_1, table.LTC_MAT_2 );
	const text = await textOf( 'playcanvas', way );
	const milliseconds = async ( patch ) => {

		const scene = litScene( app, lightsOf( lights ), patch, [ surfaces[ 0 ] ] );
		const start = performance.now();
		const pixels = await render( app, scene, 32, 32 );
		if ( pixels.every( ( value, i ) => i % 4 === 3 || value === 0 ) ) throw new Error( 'nothing was drawn' );
		scene.destroy();
		return performance.now() - start;

	};

	// The start of the context and of the unlit lamps is not measured.
	await milliseconds( ( material ) => {

		Object.assign( material, { useLighting: false } ).update();
		return material;

	} );
	return milliseconds( ( material ) => text ? withClosedFormAreaLights( material, text, app.graphicsDevice ) : material );

}
