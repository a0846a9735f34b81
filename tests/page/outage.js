// The service goes while a page is open, and comes back.

import { ENDLESS, SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open, complaints } ) => {

	const digest = await service.fit( SMALL );
	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const pages = {};
	/** Every page, and what it shows once its answers are there. */
	const places = { job: [ `jobs/${ id }`, '.state.running' ], jobs: [ 'jobs', '.state.running' ], tables: [ 'tables', '.picture img[src]' ], table: [ `tables/${ digest }`, '.maps' ], form: [ 'new', 'aside dd' ], compare: [ 'compare', '.compare' ], viewer: [ 'viewer?show=model', '.facts' ] };
	for ( const [ name, [ hash, ready ] ] of Object.entries( places ) ) {

		pages[ name ] = await open( hash );
		await pages[ name ].locator( ready ).first().waitFor();

	}

	const all = Object.values( pages );
	await service.stop();
	// Most of them have nothing to ask, and none is touched.
	for ( const page of all ) await page.locator( '#service.down', { hasText: 'does not answer' } ).waitFor();
	// A page that was not loaded yet is shown once the service is back.
	await pages.compare.evaluate( () => location.hash = '#/jobs' );
	await pages.compare.getByRole( 'heading', { name: 'Not shown' } ).waitFor();
	// The list of tables hears of the service when there is another table.
	await pages.tables.route( '**/healthz', ( route ) => route.abort() );
	await service.start();
	for ( const page of all ) if ( page !== pages.tables ) await page.locator( '#service.up' ).waitFor();
	await pages.compare.locator( '.state.running' ).waitFor();
	await fetch( `${ service.url }/v1/jobs/${ id }`, { method: 'DELETE' } );
	// Each by itself, without being touched.
	for ( const page of [ pages.job, pages.jobs ] ) await page.locator( '.state.cancelled' ).waitFor();
	await service.fit( { ...SMALL, precision: 'f16' } );
	await pages.jobs.locator( '.state.done' ).nth( 1 ).waitFor();
	await pages.tables.unroute( '**/healthz' );
	await pages.tables.locator( '#service.up' ).waitFor();
	await pages.tables.locator( '.list tbody tr', { hasText: 'f16' } ).waitFor();
	// The browser says that nobody answered; there is nothing else to say.
	const others = complaints.splice( 0 ).filter( ( text ) => ! /ERR_CONNECTION_REFUSED|ERR_FAILED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|ERR_INCOMPLETE_CHUNKED_ENCODING|status of 503/.test( text ) );
	return { others };

} );
