// Lighthouse on the list of tables and on a table: the least score of each category, for `make lighthouse`. It needs the
// package `lighthouse`, which no test does.

import lighthouse from 'lighthouse';

import { withWorld } from './world.js';

/** Where Chromium listens for who measures. */
const PORT = 9333;

await withWorld( async ( { service } ) => {

	const digests = [];
	for ( const recipe of [ { preset: 'draft' }, { preset: 'draft', precision: 'f16' } ] ) digests.push( await service.fit( recipe ) );
	const scores = {};
	for ( const [ name, hash ] of Object.entries( { tables: 'tables', table: `tables/${ digests[ 0 ] }` } ) ) {

		// The first run renders the pictures that the service then has.
		for ( let run = 0; run < 2; run ++ ) {

			const { lhr } = await lighthouse( `${ service.url }/#/${ hash }`, { port: PORT, logLevel: 'error' } );
			scores[ name ] = Object.fromEntries( Object.values( lhr.categories ).map( ( { id, score } ) => [ id, Math.round( 100 * score ) ] ) );

		}

	}

	const least = Math.min( ...Object.values( scores ).flatMap( Object.values ) );
	if ( least < 95 ) process.exitCode = 1;
	return { scores };

}, [ '--adapter', 'cpu' ], [ `--remote-debugging-port=${ PORT }` ] );
