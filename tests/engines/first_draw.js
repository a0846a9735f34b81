// Measures an engine's first draw, which compiles its shader, for ways of lighting and numbers of lights. Prints table
// rows for docs/engines.md: medians, in milliseconds and relative to the stock engine.
//
//   node first_draw.js [--engine three] [--chromium PROGRAM] [--runs 3] [--lights 1,2,4,8] [--ways stock,fast,balanced,fine] [--clearcoat] [--unclustered]
//
// Run `npm run build` in the folder of the example first. Additional options are --ways table and --clearcoat for
// three.js, and --unclustered for PlayCanvas. Each run starts its own browser, without a shader cache.

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	engine: { type: 'string', default: 'three' },
	chromium: { type: 'string', default: '/usr/bin/chromium-headless-shell' },
	runs: { type: 'string', default: '3' },
	lights: { type: 'string', default: '1,2,4,8' },
	ways: { type: 'string', default: 'stock,fast,balanced,fine' },
	clearcoat: { type: 'boolean' }, unclustered: { type: 'boolean' },
} } );

// This switches off Mesa's cache. The flag below switches off Chromium's cache.
process.env.MESA_SHADER_CACHE_DISABLE = 'true';
const FLAGS = [ '--disable-gpu-program-cache', '--disable-gpu-shader-disk-cache' ];

const here = fileURLToPath( new URL( '.', import.meta.url ) );
const server = await serve( { '/': here, '/examples/': `${ here }../../examples`, '/node_modules/': `${ here }node_modules` } );
const address = `http://127.0.0.1:${ server.address().port }/pages/first_draw.html`;

async function firstDraw( way, lights ) {

	return withBrowser( values.chromium, async ( browser ) => {

		const page = await openPage( browser, way, `${ address }?engine=${ values.engine }&way=${ way }&lights=${ lights }${ values.clearcoat ? '&clearcoat' : '' }${ values.unclustered ? '&unclustered' : '' }` );
		const failed = new Promise( ( _, reject ) => page.on( 'pageerror', reject ) );
		await Promise.race( [ page.waitForFunction( 'window.milliseconds' ), failed ] );
		return page.evaluate( 'window.milliseconds' );

	}, FLAGS );

}

try {

	const ways = values.ways.split( ',' );
	console.log( `| lights | ${ ways.join( ' | ' ) } |\n|${ '---|'.repeat( ways.length + 1 ) }` );
	for ( const lights of values.lights.split( ',' ) ) {

		const times = ways.map( () => [] );
		for ( let run = 0; run < Number( values.runs ); run ++ ) {

			for ( const [ i, way ] of ways.entries() ) times[ i ].push( await firstDraw( way, lights ) );

		}

		const medians = times.map( ( those ) => those.sort( ( a, b ) => a - b )[ Math.floor( those.length / 2 ) ] );
		console.log( `| ${ lights } | ${ medians.map( ( ms, i ) => `${ Math.round( ms ) }${ i ? ` (${ ( ms / medians[ 0 ] ).toFixed( 1 ) })` : '' }` ).join( ' | ' ) } |` );

	}

} finally {

	server.close();

}
