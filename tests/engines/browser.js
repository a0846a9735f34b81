// Starts a browser without GPU and display, and prints the errors of pages.

import { chromium } from 'playwright-core';

import { repacked, stock } from './tables.js';

/** Flags for WebGL 2 by Mesa's software rasteriser. */
const FLAGS = [ '--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist' ];

/**
 * The longest run of a browser in milliseconds. A run takes half a minute, or three minutes if five others share its two cores.
 * No other time is limited, so that a busy machine does not fail tests.
 */
const DEADLINE = 600_000;

/** Starts a browser with more flags, runs `work` with it, and closes it. */
export async function withBrowser( program, work, flags = [] ) {

	const deadline = setTimeout( () => {

		console.error( `not done after ${ DEADLINE / 1000 } s` );
		process.exit( 1 );

	}, DEADLINE );
	const browser = await chromium.launch( { executablePath: program, args: [ ...FLAGS, ...flags ], timeout: 0 } );
	try {

		return await work( browser );

	} finally {

		clearTimeout( deadline );
		await browser.close();

	}

}

/** The addresses of tables that engines fetch from their servers, and their files of stock tables. */
const TABLES = {
	'https://assets.babylonjs.com/core/areaLights/areaLightsLTC.bin': 'babylon/areaLights/areaLightsLTC.bin',
	'https://raw.githubusercontent.com/playcanvas/engine/main/examples/assets/json/area-light-luts.json': 'playcanvas/area-light-luts.json',
};

/** Opens a page. Its errors are printed and added to `faults`. The tables of engines are served from here. */
export async function openPage( browser, name, address, faults = [] ) {

	const page = await browser.newPage();
	page.setDefaultTimeout( 0 );
	const report = ( text ) => {

		faults.push( text );
		console.error( `${ name }: ${ text }` );

	};

	for ( const [ address, file ] of Object.entries( TABLES ) ) await page.route( address, ( route ) => route.fulfill( {
		body: Buffer.from( repacked[ file ]( stock() ) ), headers: { 'access-control-allow-origin': '*' },
	} ) );
	page.on( 'console', ( message ) => message.type() === 'error' && report( message.text() ) );
	page.on( 'pageerror', ( error ) => report( error.message ) );
	await page.goto( address );
	return page;

}
