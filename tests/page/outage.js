// The service stops and starts again while pages are open.

import { ENDLESS, SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open, complaints } ) => {

	const digest = await service.fit( SMALL );
	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const pages = {};
	/** Every page, and an element that appears once it is complete. */
	const places = { job: [ `jobs/${ id }`, '.state.running' ], jobs: [ 'jobs', '.state.running' ], tables: [ 'tables', '.picture img[src]' ], table: [ `tables/${ digest }`, '.maps' ], form: [ 'new', 'aside dd' ], compare: [ 'compare', '.compare' ], viewer: [ 'viewer?show=model', '.facts' ] };
	for ( const [ name, [ hash, ready ] ] of Object.entries( places ) ) {

		pages[ name ] = await open( hash );
		await pages[ name ].locator( ready ).first().waitFor();

	}

	const all = Object.values( pages );
	await service.stop();
	// Every page notices this on its own, although most pages make no calls.
	for ( const page of all ) await page.locator( '#service.down', { hasText: 'does not respond' } ).waitFor();
	// A page that failed to load is shown once the service is running again.
	await pages.compare.evaluate( () => location.hash = '#/jobs' );
	await pages.compare.getByRole( 'heading', { name: 'Cannot show this page' } ).waitFor();
	// The list of tables notices the service only later, when there is another table.
	await pages.tables.route( '**/healthz', ( route ) => route.abort() );
	await service.start();
	for ( const page of all ) if ( page !== pages.tables ) await page.locator( '#service.up' ).waitFor();
	await pages.compare.locator( '.state.running' ).waitFor();
	await fetch( `${ service.url }/v1/jobs/${ id }`, { method: 'DELETE' } );
	// Each page updates on its own.
	for ( const page of [ pages.job, pages.jobs ] ) await page.locator( '.state.cancelled' ).waitFor();
	await service.fit( { ...SMALL, precision: 'f16' } );
	await pages.jobs.locator( '.state.done' ).nth( 1 ).waitFor();
	await pages.tables.unroute( '**/healthz' );
	await pages.tables.locator( '#service.up' ).waitFor();
	await pages.tables.locator( '.list tbody tr', { hasText: 'f16' } ).waitFor();
	// The browser reports the failed connections. It must not report anything else.
	const others = complaints.splice( 0 ).filter( ( text ) => ! /ERR_CONNECTION_REFUSED|ERR_FAILED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|ERR_INCOMPLETE_CHUNKED_ENCODING|status of 503/.test( text ) );
	return { others };

}, [ '--workers', '1' ] );
