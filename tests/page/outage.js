// The service goes while a page is open, and comes back.

import { ENDLESS, SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open, complaints } ) => {

	const { id } = await service.call( '/v1/jobs', ENDLESS );
	const [ job, list, tables ] = [ await open( `jobs/${ id }` ), await open( 'jobs' ), await open( 'tables' ) ];
	for ( const page of [ job, list ] ) await page.locator( '.state.running' ).waitFor();
	await tables.getByText( 'No table is stored yet.' ).waitFor();
	await service.stop();
	await job.locator( '#service.down' ).waitFor();
	await service.start();
	for ( const page of [ job, list ] ) await page.locator( '#service.up' ).waitFor();
	// The browser says that nobody answered; there is nothing else to say.
	const others = complaints.splice( 0 ).filter( ( text ) => ! /ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|ERR_INCOMPLETE_CHUNKED_ENCODING|status of 503/.test( text ) );
	await fetch( `${ service.url }/v1/jobs/${ id }`, { method: 'DELETE' } );
	// Each by itself, without being touched.
	for ( const page of [ job, list ] ) await page.locator( '.state.cancelled' ).waitFor();
	await service.fit( SMALL );
	await list.locator( '.state.done' ).waitFor();
	return { others };

} );
