// From the form for a recipe to the downloaded table. Then a job that is watched across a reload and cancelled in
// another tab, and a job that fails.

import { createHash } from 'node:crypto';
import { readFile } from 'node:fs/promises';

import { ENDLESS, SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open } ) => {

	const page = await open( 'new' );
	await page.getByLabel( 'draft' ).check();
	for ( const axis of [ 'alpha', 'ratio', 'theta', 'phi' ] ) await page.locator( `#field-resolution-${ axis }` ).fill( '2' );
	for ( const [ name, value ] of Object.entries( SMALL.fit ) ) await page.locator( `#field-fit-${ name }` ).fill( String( value ) );
	await page.locator( 'aside dd', { hasText: /^16$/ } ).waitFor();
	const document = JSON.parse( await page.getByRole( 'textbox', { name: 'Recipe as JSON' } ).inputValue() );
	// Reloading the page keeps the recipe.
	await page.reload();
	await page.locator( 'aside dd', { hasText: /^16$/ } ).waitFor();
	const reloaded = JSON.parse( await page.getByRole( 'textbox', { name: 'Recipe as JSON' } ).inputValue() );
	await page.getByRole( 'button', { name: 'Submit' } ).click();
	await page.getByRole( 'link', { name: 'Open the table' } ).click();
	await page.getByRole( 'heading', { name: 'Quality' } ).waitFor();
	const digest = await page.getByRole( 'textbox', { name: 'Digest' } ).textContent();
	const saved = async ( link ) => {

		const [ download ] = await Promise.all( [ page.waitForEvent( 'download' ), link.click() ] );
		return `sha256:${ createHash( 'sha256' ).update( await readFile( await download.path() ) ).digest( 'hex' ) }`;

	};

	const table = await saved( page.getByRole( 'link', { name: /Download/ } ) );
	await page.getByText( 'wgpu', { exact: true } ).click();
	const file = page.locator( '.files tr' ).first();
	const exported = { saved: await saved( file.getByRole( 'link' ) ), digest: await file.locator( 'code' ).getAttribute( 'title' ) };

	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const [ list, other ] = [ await open( 'jobs' ), await open( `jobs/${ id }` ) ];
	const running = other.locator( '.state.running' );
	await running.waitFor();
	await other.reload();
	await running.waitFor();
	// Only the event stream updates the page of a job.
	const done = () => other.locator( '.facts dd' ).first().textContent();
	const first = await done();
	await other.waitForFunction( ( first ) => document.querySelector( '.facts dd' ).textContent !== first, first );
	await list.locator( 'tr', { has: list.locator( '.running' ) } ).getByRole( 'button', { name: 'Cancel' } ).click();
	await list.locator( '.state.cancelled' ).waitFor();
	await other.locator( '.state.cancelled' ).waitFor();
	const { state } = await service.call( `/v1/jobs/${ id }` );

	// Both pages show why a job failed. The job can be submitted again.
	await service.fail( { ...SMALL, precision: 'f16' } );
	await list.reload();
	const failed = list.locator( 'tr', { has: list.locator( '.state.failed' ) } );
	const reasons = [ await failed.locator( '.reason' ).textContent() ];
	await failed.getByRole( 'link' ).click();
	reasons.push( await list.locator( '.notice' ).textContent() );
	await list.getByRole( 'button', { name: 'Submit again' } ).click();
	await list.locator( '.state.done' ).waitFor();
	return { reasons, document, reloaded, digest, table, exported, cancelled: state };

}, [ '--workers', '1' ] );
