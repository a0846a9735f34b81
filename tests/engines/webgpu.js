// WebGPURenderer with the patch of examples/three, by WebGPU and by its way back to WebGL 2. Prints as JSON the mean
// errors of linear radiance under `--lights` lights, and with `--milliseconds` the times to a first draw instead, as lines
// of a table.
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

/** What a page of a browser of its own draws. */
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

					// One surface, for a material that is compiled once.
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
			const told = await drawn( { lights: Number( values.lights ), forceWebGL }, faults );
			if ( ! told ) continue;
			const errors = Object.fromEntries( Object.entries( told.of ).map( ( [ way, { pixels } ] ) => [ way, meanError( pixels, expected, width, height ) ] ) );
			report[ told.backend ] = { errors, refusal: told.refusal, faults };

		}

		console.log( JSON.stringify( report ) );

	}

} finally {

	server.close();

}
