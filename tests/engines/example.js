// Opens the examples. For each engine and number of lights, prints the mean errors on the page and the errors of the
// browser, as JSON.
//
//   node example.js --ltcforge PROGRAM --chromium PROGRAM [--engines three,babylon,playcanvas] [--lights 1,4] [--size WIDTHxHEIGHT] [--picture FILE]
//
// --picture writes a picture of the last page.

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve, truthAnswer } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' },
	engines: { type: 'string', default: 'three,babylon,playcanvas' }, lights: { type: 'string', default: '1,4' },
	size: { type: 'string', default: '72x54' }, picture: { type: 'string' },
} } );

process.env.LTCFORGE = values.ltcforge;
const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const engines = values.engines.split( ',' );
const folders = { '/': at( '../../examples/' ) };
for ( const engine of engines ) folders[ `/${ engine }/node_modules/` ] = at( 'node_modules/' );

// All engines are compared with the same truth.
const truths = new Map();
const answers = { '/truth': ( query ) => {

	if ( ! truths.has( `${ query }` ) ) truths.set( `${ query }`, truthAnswer( query ) );
	return truths.get( `${ query }` );

} };
const server = await serve( folders, answers );
const [ width, height ] = values.size.split( 'x' );

async function drawn( browser, engine, lights ) {

	const faults = [];
	const address = `http://127.0.0.1:${ server.address().port }/${ engine }/?width=${ width }&height=${ height }&lights=${ lights }`;
	const page = await openPage( browser, engine, address, faults );
	const failed = new Promise( ( _, reject ) => page.on( 'pageerror', reject ) );
	await Promise.race( [ page.waitForFunction( 'window.errors' ), failed ] );
	if ( values.picture ) {

		await page.setViewportSize( { width: 3 * Number( width ) + 56, height: 2 * Number( height ) + 104 } );
		await page.screenshot( { path: values.picture, fullPage: true } );

	}

	const errors = await page.evaluate( 'window.errors' );
	await page.close();
	return { errors, faults };

}

try {

	const report = Object.fromEntries( engines.map( ( engine ) => [ engine, {} ] ) );
	await withBrowser( values.chromium, async ( browser ) => {

		for ( const lights of values.lights.split( ',' ) ) for ( const engine of engines ) report[ engine ][ lights ] = await drawn( browser, engine, lights );

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
