// A browser that needs no GPU and no display, and pages that say what goes wrong in them.

import { chromium } from 'playwright-core';

/** WebGL2 by Mesa's rasterizer on the processor. */
const FLAGS = [ '--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist' ];

/** Longer than any run takes on two busy cores: a browser that hangs must not hang the tests. */
const DEADLINE = 170_000;

/** Runs `work` with a browser, and ends it. */
export async function withBrowser( program, work ) {

	const deadline = setTimeout( () => {

		console.error( `not done after ${ DEADLINE / 1000 } s` );
		process.exit( 1 );

	}, DEADLINE );
	const browser = await chromium.launch( { executablePath: program, args: FLAGS } );
	try {

		return await work( browser );

	} finally {

		clearTimeout( deadline );
		await browser.close();

	}

}

/** A page whose errors are printed. `faults` collects them. */
export async function openPage( browser, name, address, faults = [] ) {

	const page = await browser.newPage();
	const tell = ( text ) => {

		faults.push( text );
		console.error( `${ name }: ${ text }` );

	};

	page.on( 'console', ( message ) => message.type() === 'error' && tell( message.text() ) );
	page.on( 'pageerror', ( error ) => tell( error.message ) );
	await page.goto( address );
	return page;

}
