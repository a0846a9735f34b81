// A browser that needs no GPU and no display, and pages that say what goes wrong in them.

import { chromium } from 'playwright-core';

import { repacked, stock } from './tables.js';

/** WebGL2 by Mesa's rasterizer on the processor. */
const FLAGS = [ '--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist' ];

/**
 * Milliseconds after which a browser is taken to hang. A run takes half a minute, and three where five others share its
 * two cores. No other time is limited, so that a busy machine fails no test.
 */
const DEADLINE = 600_000;

/** Runs `work` with a browser, started with more flags, and ends it. */
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

/** The tables that engines fetch from their servers, and the stock tables as they have them. */
const TABLES = {
	'https://assets.babylonjs.com/core/areaLights/areaLightsLTC.bin': 'babylon/areaLights/areaLightsLTC.bin',
	'https://raw.githubusercontent.com/playcanvas/engine/main/examples/assets/json/area-light-luts.json': 'playcanvas/area-light-luts.json',
};

/** A page whose errors are printed. `faults` collects them. Engines' tables come from here. */
export async function openPage( browser, name, address, faults = [] ) {

	const page = await browser.newPage();
	page.setDefaultTimeout( 0 );
	const tell = ( text ) => {

		faults.push( text );
		console.error( `${ name }: ${ text }` );

	};

	for ( const [ address, file ] of Object.entries( TABLES ) ) await page.route( address, ( route ) => route.fulfill( {
		body: Buffer.from( repacked[ file ]( stock() ) ), headers: { 'access-control-allow-origin': '*' },
	} ) );
	page.on( 'console', ( message ) => message.type() === 'error' && tell( message.text() ) );
	page.on( 'pageerror', ( error ) => tell( error.message ) );
	await page.goto( address );
	return page;

}
