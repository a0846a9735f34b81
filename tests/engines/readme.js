// Opens the page in a package's README.

import { readFile } from 'node:fs/promises';
import { join } from 'node:path';

import { openPage } from './browser.js';

/** The page in the README of a package. */
export async function pageOfReadme( folder ) {

	const readme = await readFile( join( folder, 'README.md' ), 'utf8' );
	return /```html\n([\s\S]*?)```/.exec( readme )[ 1 ];

}

/** The share of pixels of a page that are lit. */
export async function litShare( browser, address, faults, picture ) {

	const page = await openPage( browser, 'readme', 'about:blank', faults );
	await page.setViewportSize( { width: 480, height: 320 } );
	await page.goto( address );
	await page.waitForFunction( 'document.querySelector( "canvas" )' );
	// Babylon compiles shaders in the background.
	await page.waitForFunction( '! window.BABYLON || BABYLON.EngineStore.LastCreatedScene?.isReady()' );
	// The second frame shows the result of the first.
	await page.evaluate( () => new Promise( ( done ) => requestAnimationFrame( () => requestAnimationFrame( done ) ) ) );
	const shot = ( await page.screenshot( { path: picture } ) ).toString( 'base64' );
	return page.evaluate( async ( shot ) => {

		const image = await createImageBitmap( await ( await fetch( `data:image/png;base64,${ shot }` ) ).blob() );
		const context = new OffscreenCanvas( image.width, image.height ).getContext( '2d' );
		context.drawImage( image, 0, 0 );
		const { data } = context.getImageData( 0, 0, image.width, image.height );
		let lit = 0;
		for ( let i = 0; i < data.length; i += 4 ) if ( data[ i ] > 60 ) lit ++;
		return 4 * lit / data.length;

	}, shot );

}
