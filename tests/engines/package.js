// Tests the packed npm package of an example in a browser: its effect on materials of the engine, and the page of its
// README. Prints one JSON document.
//
//   node package.js --ltcforge PROGRAM --chromium PROGRAM --engine babylon --package FOLDER [--picture FILE]

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';
import { litShare, pageOfReadme } from './readme.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, engine: { type: 'string' }, package: { type: 'string' }, picture: { type: 'string' },
} } );

const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const server = await serve( {
	'/': at( '.' ), '/examples/': at( '../../examples/' ), '/package/': values.package,
	[ `/node_modules/ltcforge-${ values.engine }/` ]: values.package,
}, { '/readme.html': () => pageOfReadme( values.package ) } );
const address = `http://127.0.0.1:${ server.address().port }`;

/** The largest and the mean difference between two pictures. */
function apart( one, other ) {

	const differences = one.map( ( value, i ) => Math.abs( value - other[ i ] ) );
	return { most: Math.max( ...differences ), mean: differences.reduce( ( sum, value ) => sum + value, 0 ) / differences.length };

}

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const page = await openPage( browser, 'package', `${ address }/pages/?engine=patch_${ values.engine }`, faults );
		await page.waitForFunction( 'window.draw' );
		const { pictures, ...rest } = await page.evaluate( 'window.draw()' );
		await page.close();
		const from = ( name ) => Object.fromEntries( Object.entries( pictures ).map( ( [ other, picture ] ) => [ other, apart( picture, pictures[ name ] ) ] ) );
		return { fromOurs: from( 'ours' ), fromStock: from( 'stock' ), ...rest, readme: await litShare( browser, `${ address }/readme.html`, faults, values.picture ), faults };

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
