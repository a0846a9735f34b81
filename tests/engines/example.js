// Opens examples/three and prints as JSON the mean errors that it shows, and what the browser complains of.
//
//   node example.js --ltcforge PROGRAM --chromium PROGRAM [--size WIDTHxHEIGHT] [--lights COUNT] [--picture FILE]

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve, truthAnswer } from '../../examples/three/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' },
	size: { type: 'string', default: '72x54' }, lights: { type: 'string', default: '1' }, picture: { type: 'string' },
} } );

process.env.LTCFORGE = values.ltcforge;
const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const server = await serve( { '/': at( '../../examples/three/' ), '/three/': at( 'node_modules/three' ) }, { '/truth': truthAnswer } );
const [ width, height ] = values.size.split( 'x' );

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const page = await openPage( browser, 'example', `http://127.0.0.1:${ server.address().port }/?width=${ width }&height=${ height }&lights=${ values.lights }`, faults );
		const failed = new Promise( ( _, reject ) => page.on( 'pageerror', reject ) );
		await Promise.race( [ page.waitForFunction( 'window.errors' ), failed ] );
		if ( values.picture ) {

			await page.setViewportSize( { width: 3 * Number( width ) + 56, height: 2 * Number( height ) + 104 } );
			await page.screenshot( { path: values.picture, fullPage: true } );

		}

		return { errors: await page.evaluate( 'window.errors' ), faults };

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
