// Runs Lighthouse on the list of tables and on a table, for `make lighthouse`. Fails if a score is below 95. Only this
// script needs the package `lighthouse`.

import lighthouse from 'lighthouse';

import { withWorld } from './world.js';

/** The port on which Chromium listens for Lighthouse. */
const PORT = 9333;

await withWorld( async ( { service } ) => {

	const digests = [];
	for ( const recipe of [ { preset: 'draft' }, { preset: 'draft', precision: 'f16' } ] ) digests.push( await service.fit( recipe ) );
	const scores = {};
	for ( const [ name, hash ] of Object.entries( { tables: 'tables', table: `tables/${ digests[ 0 ] }` } ) ) {

		// In the first run, the service renders the pictures. The second run is measured.
		for ( let run = 0; run < 2; run ++ ) {

			const { lhr } = await lighthouse( `${ service.url }/#/${ hash }`, { port: PORT, logLevel: 'error' } );
			scores[ name ] = Object.fromEntries( Object.values( lhr.categories ).map( ( { id, score } ) => [ id, Math.round( 100 * score ) ] ) );

		}

	}

	const least = Math.min( ...Object.values( scores ).flatMap( Object.values ) );
	if ( least < 95 ) process.exitCode = 1;
	return { scores };

}, [ '--adapter', 'cpu' ], [ `--remote-debugging-port=${ PORT }` ] );
