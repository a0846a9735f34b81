// Opens an example and prints as JSON the mean errors that it shows, and what the browser complains of.
//
//   node example.js --ltcforge PROGRAM --chromium PROGRAM [--engine three] [--size WIDTHxHEIGHT] [--lights COUNT] [--picture FILE]

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve, truthAnswer } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, engine: { type: 'string', default: 'three' },
	size: { type: 'string', default: '72x54' }, lights: { type: 'string', default: '1' }, picture: { type: 'string' },
} } );

process.env.LTCFORGE = values.ltcforge;
const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const folders = { '/': at( '../../examples/' ), [ `/${ values.engine }/node_modules/` ]: at( 'node_modules/' ) };
const server = await serve( folders, { '/truth': truthAnswer } );
const [ width, height ] = values.size.split( 'x' );

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const page = await openPage( browser, values.engine, `http://127.0.0.1:${ server.address().port }/${ values.engine }/?width=${ width }&height=${ height }&lights=${ values.lights }`, faults );
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
