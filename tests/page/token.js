// Tests a service that needs a token. The page asks for the token, sends it with every request, and does not store it.

import { createHash } from 'node:crypto';
import { spawnSync } from 'node:child_process';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';

import { ENDLESS, LTCFORGE, SMALL, withWorld } from './world.js';

const { stdout } = spawnSync( LTCFORGE, [ 'token', 'new', 'page', '--scope', 'submit' ], { encoding: 'utf8' } );
const [ token ] = /ltcforge_\S+/.exec( stdout );
const [ line ] = /page submit .*/.exec( stdout );

await withWorld( async ( { service, open, complaints } ) => {

	service.token = token;
	const digest = await service.fit( SMALL );
	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const page = await open( 'tables' );
	const refused = [];
	page.on( 'response', ( response ) => response.status() === 401 && refused.push( response.url() ) );
	const dialog = page.getByRole( 'dialog' );
	await dialog.getByLabel( 'Token' ).fill( 'wrong' );
	await dialog.getByRole( 'button', { name: 'Continue' } ).click();
	await dialog.getByText( 'rejected this token' ).waitFor();
	const dialogs = await dialog.count();
	await dialog.getByLabel( 'Token' ).fill( token );
	await page.keyboard.press( 'Enter' );
	await page.locator( '.picture img[src]' ).waitFor();
	const before = refused.length;

	await page.evaluate( ( hash ) => location.hash = hash, `#/tables/${ digest }` );
	await page.locator( '.plots img[src]' ).first().waitFor();
	const [ download ] = await Promise.all( [ page.waitForEvent( 'download' ), page.getByRole( 'link', { name: /Download/ } ).click() ] );
	const saved = `sha256:${ createHash( 'sha256' ).update( await readFile( await download.path() ) ).digest( 'hex' ) }`;
	const name = download.suggestedFilename();

	// A job, followed by its event stream.
	await page.evaluate( ( hash ) => location.hash = hash, `#/jobs/${ id }` );
	await page.locator( '.state.running' ).waitFor();
	const first = await page.locator( '.facts dd' ).first().textContent();
	await page.waitForFunction( ( first ) => document.querySelector( '.facts dd' ).textContent !== first, first );
	await service.call( `/v1/jobs/${ id }`, undefined, 'DELETE' );
	await page.locator( '.state.cancelled' ).waitFor();
	const later = refused.length - before;

	const kept = await page.evaluate( () => localStorage.length + sessionStorage.length + document.cookie.length );
	await page.reload();
	await dialog.waitFor();
	const axe = await readFile( createRequire( import.meta.url ).resolve( 'axe-core/axe.min.js' ), 'utf8' );
	await page.evaluate( axe );
	const { violations } = await page.evaluate( () => window.axe.run( document ) );
	// Without a token, the page explains why it shows nothing.
	await page.keyboard.press( 'Escape' );
	const without = await page.locator( '.notice' ).first().textContent();
	// The browser reports every response with an error status.
	const others = complaints.splice( 0 ).filter( ( text ) => ! text.includes( '401' ) );
	return { digest, saved, name, dialogs, later, kept, violations: violations.map( ( { id } ) => id ), without, others };

}, [ '--token-list', line ] );
