// Compares pictures on a light in examples/three with `ltcforge light --texture` for the same pixels. Prints one JSON
// document: differences of colours, errors for invalid inputs, and whether the example's page changes over time.
//
//   node textured.js --ltcforge PROGRAM --chromium PROGRAM

import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { lightsOf, seenBy, surfaces } from '../../examples/common/scene.js';
import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: { ltcforge: { type: 'string' }, chromium: { type: 'string' } } } );
const [ width, height ] = [ 72, 54 ];
const lights = lightsOf( 1 );

/** The pixels that show a surface. */
const points = Array.from( { length: width * height }, ( _, pixel ) => ( { pixel, ...seenBy( pixel % width, Math.floor( pixel / width ), width, height, lights ) } ) )
	.filter( ( { surface } ) => surface >= 0 );

/** The red, green and blue of these pixels under a picture, by the program in f64. */
function byTheProgram( folder, png ) {

	const path = join( folder, 'shown.png' );
	writeFileSync( path, Buffer.from( png.split( ',' )[ 1 ], 'base64' ) );
	const rows = points.map( ( { surface, view: [ x, y, z ], corners: [ [ first, ...others ] ] } ) =>
		// The first corner is the upper left of the picture.
		[ ...surfaces[ surface ].alpha, Math.acos( z ), Math.atan2( y, x ), 1, ...others.flat(), ...first ].join( ',' ) );
	const { stdout, status, stderr } = spawnSync( values.ltcforge, [ 'light', '-', '--texture', path ], { input: rows.join( '\n' ) + '\n', encoding: 'utf8', maxBuffer: 1e8 } );
	if ( status !== 0 ) throw new Error( stderr );
	const [ names, ...lines ] = stdout.trimEnd().split( '\n' );
	const at = [ 'energy', 'fresnel', 'red', 'green', 'blue' ].map( ( name ) => names.split( ',' ).indexOf( name ) );
	return lines.map( ( line, i ) => {

		const numbers = line.split( ',' );
		const [ energy, fresnel, ...colours ] = at.map( ( column ) => Number( numbers[ column ] ) );
		return colours.map( ( colour, channel ) => energy === 0 ? 0
			: lights[ 0 ].radiance[ channel ] * colour / energy * ( surfaces[ points[ i ].surface ].f0[ channel ] * ( energy - fresnel ) + fresnel ) );

	} );

}

/** The mean and the largest difference. `expected` has three numbers for each pixel of `points`. */
function apart( drawn, expected ) {

	const off = points.flatMap( ( { pixel }, i ) => expected[ i ].map( ( value, channel ) => Math.abs( drawn[ 4 * pixel + channel ] - value ) ) );
	return { most: Math.max( ...off ), mean: off.reduce( ( sum, value ) => sum + value, 0 ) / off.length };

}

const colours = ( drawn ) => points.map( ( { pixel } ) => drawn.slice( 4 * pixel, 4 * pixel + 3 ) );

/** Whether the example's page changes after a while, by the content of its light. */
async function moves( browser, address, faults ) {

	const page = await openPage( browser, 'textured', `${ address }/three/textured.html?width=96&height=64`, faults );
	const shot = async () => ( await page.locator( 'canvas' ).screenshot() ).toString( 'base64' );
	const changed = {};
	for ( const what of [ 'picture', 'video' ] ) {

		await page.selectOption( '#show', what );
		// The change needs a few frames until it is visible.
		const frames = ( count ) => page.evaluate( ( left ) => new Promise( ( done ) => {

			const next = () => left -- > 0 ? requestAnimationFrame( next ) : done();
			next();

		} ), count );
		await frames( 3 );
		const before = await shot();
		await frames( 12 );
		changed[ what ] = await shot() !== before;

	}

	await page.close();
	return changed;

}

const at = ( path ) => fileURLToPath( new URL( path, import.meta.url ) );
const server = await serve( {
	'/': at( '../../examples/' ), '/pages/': at( 'pages/' ), '/node_modules/': at( 'node_modules/' ), '/three/node_modules/': at( 'node_modules/' ),
} );
const address = `http://127.0.0.1:${ server.address().port }`;
const folder = mkdtempSync( join( tmpdir(), 'ltcforge-' ) );

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const faults = [];
		const page = await openPage( browser, 'textured', `${ address }/pages/?engine=textured_three`, faults );
		await page.waitForFunction( 'window.draw' );
		const { drawn, kinds, pngs, refusals } = await page.evaluate( `window.draw( ${ width }, ${ height } )` );
		await page.close();
		const errors = Object.fromEntries( Object.entries( pngs ).map( ( [ name, png ] ) => [ name, apart( drawn[ name ], byTheProgram( folder, png ) ) ] ) );
		errors.white = apart( drawn.white, colours( drawn.plain ) );
		for ( const name of [ 'second', 'layer' ] ) errors[ name ] = apart( drawn[ name ], colours( drawn.plainSecond ) );
		errors.stream = apart( drawn.stream, colours( drawn.picture ) );
		const byKind = Object.fromEntries( Object.entries( kinds ).map( ( [ name, picture ] ) => [ name, apart( picture, colours( drawn.picture ) ) ] ) );
		const changes = { picture: apart( drawn.picture, colours( drawn.colour ) ), later: apart( drawn.later, colours( drawn.start ) ) };
		return { errors, kinds: byKind, changes, refusals, moves: await moves( browser, address, faults ), faults };

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();
	rmSync( folder, { recursive: true } );

}
