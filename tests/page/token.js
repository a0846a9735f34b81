// A service that wants a token: the page asks for it, sends it with everything, and keeps it nowhere.

import { createHash } from 'node:crypto';
import { readFile } from 'node:fs/promises';

import { ENDLESS, SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open, complaints } ) => {

	const digest = await service.fit( SMALL );
	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const page = await open( 'viewer' );
	const refused = [];
	// As a service with tokens answers.
	await page.route( '**/v1/**', ( route ) => {

		if ( route.request().headers().authorization === 'Bearer open-sesame' ) return route.continue();
		refused.push( new URL( route.request().url() ).pathname );
		return route.fulfill( { status: 401, contentType: 'application/problem+json', headers: { 'www-authenticate': 'Bearer' }, body: JSON.stringify( { type: '/problems/no-token', title: 'A token is needed', status: 401, detail: 'this service wants a token' } ) } );

	} );
	await page.evaluate( () => location.hash = '#/tables' );
	const dialog = page.getByRole( 'dialog' );
	await dialog.getByLabel( 'Token' ).fill( 'wrong' );
	await dialog.getByRole( 'button' ).click();
	await dialog.getByText( 'refused this token' ).waitFor();
	const dialogs = await dialog.count();
	await dialog.getByLabel( 'Token' ).fill( 'open-sesame' );
	await page.keyboard.press( 'Enter' );
	await page.locator( '.picture img[src]' ).waitFor();
	const before = refused.length;

	await page.evaluate( ( hash ) => location.hash = hash, `#/tables/${ digest }` );
	await page.locator( '.plots img[src]' ).first().waitFor();
	const [ download ] = await Promise.all( [ page.waitForEvent( 'download' ), page.getByRole( 'link', { name: /Download/ } ).click() ] );
	const saved = `sha256:${ createHash( 'sha256' ).update( await readFile( await download.path() ) ).digest( 'hex' ) }`;
	const name = download.suggestedFilename();

	// A job, by its stream.
	await page.evaluate( ( hash ) => location.hash = hash, `#/jobs/${ id }` );
	await page.locator( '.state.running' ).waitFor();
	const first = await page.locator( '.facts dd' ).first().textContent();
	await page.waitForFunction( ( first ) => document.querySelector( '.facts dd' ).textContent !== first, first );
	await fetch( `${ service.url }/v1/jobs/${ id }`, { method: 'DELETE' } );
	await page.locator( '.state.cancelled' ).waitFor();
	const later = refused.length - before;

	const kept = await page.evaluate( () => localStorage.length + sessionStorage.length + document.cookie.length );
	await page.reload();
	await dialog.waitFor();
	// The browser tells of each answer that is no success.
	const others = complaints.splice( 0 ).filter( ( text ) => ! text.includes( '401' ) );
	return { digest, saved, name, dialogs, later, kept, others };

} );
