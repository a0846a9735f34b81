// Opens the page with shadows of examples/three. For each estimate, prints the mean radiance and the mean difference from 1024
// rays per pixel, as JSON.
//
//   node shadows.js --ltcforge PROGRAM --chromium PROGRAM [--picture FILE]

import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: { ltcforge: { type: 'string' }, chromium: { type: 'string' }, picture: { type: 'string' } } } );
const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const server = await serve( { '/': at( '../../examples/' ), '/three/node_modules/': at( 'node_modules/' ) } );

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const size = values.picture ? '' : '?width=120&height=80';
		const page = await openPage( browser, 'shadows', `http://127.0.0.1:${ server.address().port }/three/shadows.html${ size }`, faults );
		await page.waitForFunction( 'window.radianceOf' );
		if ( values.picture ) await page.locator( 'canvas' ).screenshot( { path: values.picture } );
		const estimates = values.picture ? {} : await page.evaluate( () => {

			const colours = ( rays, way ) => window.radianceOf( rays, way ).filter( ( _, i ) => i % 4 < 3 );
			const truth = colours( 1024, 2 );
			const of = ( rays, way ) => {

				const drawn = colours( rays, way );
				const sum = ( values ) => values.reduce( ( total, value ) => total + value, 0 ) / values.length;
				return { mean: sum( drawn ), error: sum( drawn.map( ( value, i ) => Math.abs( value - truth[ i ] ) ) ) };

			};
			return { truth: of( 1024, 2 ), ratio: of( 4, 0 ), hidden: of( 4, 1 ), samples: of( 4, 2 ), 'solid angle': of( 4, 3 ) };

		} );
		await page.close();
		return { estimates, faults };

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
