// Tests the package of examples/three, as npm packs it, in a browser. Prints one JSON document: the effect of its patch
// on materials, the errors of its pictures of clearcoat, and the lit share of the page in its README.
//
//   node patch.js --ltcforge PROGRAM --chromium PROGRAM --package FOLDER [--picture FILE]

import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { reflected } from '../../examples/common/truth.js';
import { openPage, withBrowser } from './browser.js';
import { litShare, pageOfReadme } from './readme.js';
import { coated, pointsOf, questionOf, views } from './world.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, package: { type: 'string' }, picture: { type: 'string' },
} } );

/** The truth at the pixels of the floor with a coat as in three.js: the base times the transmission of the coat, plus the coat. */
async function truthOfCoat() {

	const points = pointsOf( views[ 1 ] );
	const pixels = points.flatMap( ( point, i ) => point ? [ i ] : [] );
	const layers = [ coated.roughness, coated.clearcoatRoughness ];
	const answers = await reflected( values.ltcforge, layers.flatMap( ( roughness ) => pixels.map( ( i ) => questionOf( roughness, views[ 1 ], points[ i ] ) ) ) );
	return pixels.map( ( pixel, n ) => {

		const coat = answers[ pixels.length + n ];
		const toEye = views[ 1 ].eye.map( ( value, k ) => value - points[ pixel ][ k ] );
		const cosine = toEye[ 1 ] / Math.hypot( ...toEye );
		// three.js has exp2( - 5.55473 x - 6.98316 ) for Schlick's fifth power.
		const through = 1 - 0.04 - 0.96 * 2 ** ( ( - 5.55473 * cosine - 6.98316 ) * cosine );
		return { pixel, radiance: answers[ n ].energy * through + 0.04 * ( coat.energy - coat.fresnel ) + coat.fresnel };

	} );

}

const here = fileURLToPath( new URL( '.', import.meta.url ) );
const server = await serve( {
	'/': here, '/example/': values.package, '/node_modules/': join( here, 'node_modules' ), '/node_modules/ltcforge-three/': values.package,
}, { '/readme.html': () => pageOfReadme( values.package ) } );
const address = `http://127.0.0.1:${ server.address().port }`;

try {

	const truth = await truthOfCoat();
	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const page = await openPage( browser, 'patch', `${ address }/pages/?engine=patch_three`, faults );
		await page.waitForFunction( 'window.draw' );
		const { pictures, ...rest } = await page.evaluate( 'window.draw()' );
		await page.close();

		const errors = {};
		const brightness = {};
		for ( const [ name, picture ] of Object.entries( pictures ) ) {

			errors[ name ] = truth.reduce( ( sum, { pixel, radiance } ) => sum + Math.abs( picture[ pixel ] - radiance ), 0 ) / truth.length;
			// The brightness relative to `ours`, at pixels that are not dark.
			const ratios = truth.filter( ( { radiance } ) => radiance > 0.01 ).map( ( { pixel } ) => picture[ pixel ] / pictures.ours[ pixel ] );
			brightness[ name ] = [ Math.min( ...ratios ), Math.max( ...ratios ) ];

		}

		const same = Object.keys( pictures ).filter( ( name ) => JSON.stringify( pictures[ name ] ) === JSON.stringify( pictures.ours ) );
		const undone = JSON.stringify( pictures.undone ) === JSON.stringify( pictures.stock );
		return { errors, brightness, same, undone, ...rest, readme: await litShare( browser, `${ address }/readme.html`, faults, values.picture ), faults };

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
