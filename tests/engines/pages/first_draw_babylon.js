// Measures the first draw of a floor in Babylon.js.

import { lightsOf, surfaces } from '/examples/common/scene.js';
import { withClosedFormAreaLights } from '/examples/babylon/ggx_area_light.js';
import { library } from './babylon.js';
import { textOf } from './first_draw_text.js';

/** Milliseconds from a first draw to the pixels of a floor under these lights. */
export async function firstDraw( way, lights ) {

	globalThis.BABYLON = await library();
	const { litScene, render } = await import( '/examples/babylon/lit_scene.js' );
	const text = await textOf( 'babylon', way );
	const engine = new BABYLON.Engine( Object.assign( document.createElement( 'canvas' ), { width: 32, height: 32 } ), false );
	const milliseconds = async ( patch ) => {

		const scene = litScene( engine, lightsOf( lights ), patch, [ surfaces[ 0 ] ] );
		const start = performance.now();
		const pixels = await render( scene, 32, 32 );
		if ( pixels.every( ( value, i ) => i % 4 === 3 || value === 0 ) ) throw new Error( 'nothing was drawn' );
		return performance.now() - start;

	};

	// The start of the context and of the unlit lamps is not measured.
	await milliseconds( ( material ) => Object.assign( material, { unlit: true } ) );
	return milliseconds( ( material ) => text ? withClosedFormAreaLights( material, text, BABYLON ) : material );

}
