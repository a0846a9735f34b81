// WebGPURenderer with the patch of examples/three, on WebGPU and on its fallback to WebGL 2. Prints the mean errors in
// linear radiance under `--lights` lights, as JSON. With `--milliseconds`, it instead prints the times of a first draw,
// as table rows.
//
//   node webgpu.js --ltcforge PROGRAM --chromium PROGRAM [--lights 4] [--milliseconds] [--runs 3]

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { meanError } from '../../examples/common/pixels.js';
import { serve } from '../../examples/common/serve.js';
import { truth } from '../../examples/common/truth.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string', default: '/usr/bin/chromium-headless-shell' },
	lights: { type: 'string', default: '4' }, milliseconds: { type: 'boolean' }, runs: { type: 'string', default: '3' },
} } );

const width = 64, height = 48;
const FLAGS = [ '--enable-unsafe-webgpu', '--disable-gpu-program-cache', '--disable-gpu-shader-disk-cache' ];
process.env.MESA_SHADER_CACHE_DISABLE = 'true';
const here = fileURLToPath( new URL( '.', import.meta.url ) );
const server = await serve( { '/': here, '/examples/': `${ here }../../examples`, '/node_modules/': `${ here }node_modules` } );

/** The result of a page in a new browser. */
async function drawn( what, faults ) {

	return withBrowser( values.chromium, async ( browser ) => {

		const page = await openPage( browser, 'webgpu', `http://127.0.0.1:${ server.address().port }/pages/webgpu.html`, faults );
		await page.waitForFunction( 'window.draw' );
		if ( ! what.forceWebGL && ! await page.evaluate( async () => navigator.gpu && await navigator.gpu.requestAdapter() !== null ) ) return null;
		return page.evaluate( ( what ) => window.draw( what ), { width, height, ...what } );

	}, FLAGS );

}

try {

	if ( values.milliseconds ) {

		const ways = [ 'stock', 'fast', 'balanced', 'fine' ];
		console.log( `| lights | ${ ways.join( ' | ' ) } |\n|${ '---|'.repeat( ways.length + 1 ) }` );
		for ( const lights of [ 1, 2, 4, 8 ] ) {

			const medians = [];
			for ( const way of ways ) {

				const times = [];
				for ( let run = 0; run < Number( values.runs ); run ++ ) {

					// Only one surface, so that only one material is compiled.
					times.push( ( await drawn( { lights, forceWebGL: false, only: 0, ways: [ way ] }, [] ) ).of[ way ].milliseconds );

				}

				medians.push( times.sort( ( a, b ) => a - b )[ Math.floor( times.length / 2 ) ] );

			}

			console.log( `| ${ lights } | ${ medians.map( ( ms, i ) => `${ Math.round( ms ) }${ i ? ` (${ ( ms / medians[ 0 ] ).toFixed( 1 ) })` : '' }` ).join( ' | ' ) } |` );

		}

	} else {

		const expected = await truth( values.ltcforge, width, height, Number( values.lights ) );
		const report = {};
		for ( const forceWebGL of [ false, true ] ) {

			const faults = [];
			const result = await drawn( { lights: Number( values.lights ), forceWebGL }, faults );
			if ( ! result ) continue;
			const errors = Object.fromEntries( Object.entries( result.of ).map( ( [ way, { pixels } ] ) => [ way, meanError( pixels, expected, width, height ) ] ) );
			report[ result.backend ] = { errors, named: result.named, refusal: result.refusal, faults };

		}

		console.log( JSON.stringify( report ) );

	}

} finally {

	server.close();

}
