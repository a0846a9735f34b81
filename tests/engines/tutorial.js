// Opens the page of docs/tutorial.md, and compares its pixels with the light that `ltcforge light` prints for the same
// table.
//
//   node tutorial.js --ltcforge PROGRAM --chromium PROGRAM --folder FOLDER [--picture FILE]
//
// FOLDER contains the page and the files of the tutorial's commands. Prints one JSON document: the differences of the
// picture's bytes from the light by the table and from the truth, the number of lit pixels, and the errors of the
// browser.

import { execFileSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, folder: { type: 'string' }, picture: { type: 'string' },
} } );

// The scene in examples/webgl/index.html.
const WIDTH = 480, HEIGHT = 320;
const EYE = [ 0, - 3, 1.2 ];
const ALPHA = [ 0.03, 0.25 ];
const F0 = 0.56;
const RADIANCE = [ 1, 0.85, 0.6 ];
const LIGHT = [ [ - 0.8, 2, 0.2 ], [ - 0.8, 2, 1.2 ], [ 0.8, 2, 1.2 ], [ 0.8, 2, 0.2 ] ];

/** The distance between compared pixels, in rows and columns. */
const STEP = 12;

/** The compared pixels: column and row from the top left, and the point of the floor in the pixel. */
function floorPoints() {

	const points = [];
	for ( let row = STEP / 2; row < HEIGHT; row += STEP ) for ( let column = STEP / 2; column < WIDTH; column += STEP ) {

		const [ x, y ] = [ ( 2 * ( column + 0.5 ) - WIDTH ) / HEIGHT, ( HEIGHT - 2 * ( row + 0.5 ) ) / HEIGHT ];
		const ray = [ 0.4 * x, 1, 0.4 * y - 0.25 ];
		const distance = - EYE[ 2 ] / ray[ 2 ];
		const point = EYE.map( ( value, i ) => value + distance * ray[ i ] );
		// Behind the light, the floor is dark or hidden.
		if ( ray[ 2 ] < 0 && point[ 1 ] < LIGHT[ 0 ][ 1 ] - 0.01 ) points.push( { column, row, point } );

	}

	return points;

}

/** The light of radiance one that the floor reflects at each point: by the table and by the truth. */
function reflected( points ) {

	const rows = points.map( ( point ) => {

		const [ x, y, z ] = EYE.map( ( value, i ) => value - point[ i ] );
		const corners = LIGHT.map( ( corner ) => corner.map( ( value, i ) => value - point[ i ] ) );
		return [ ...ALPHA, Math.acos( z / Math.hypot( x, y, z ) ), Math.atan2( y, x ), 1, ...corners.flat() ].join( ',' );

	} );
	const tables = join( values.folder, 'tables' );
	const table = join( tables, readdirSync( tables ).find( ( name ) => name.endsWith( '.safetensors' ) ) );
	const words = [ 'light', '-', '--model', 'ltc', '--table', table, '--f0', `${ F0 }`, '--truth' ];
	const [ names, ...lines ] = execFileSync( values.ltcforge, words, { input: `${ rows.join( '\n' ) }\n`, encoding: 'utf8' } ).trimEnd().split( '\n' );
	const [ byTable, truth ] = [ 'reflected', 'true_reflected' ].map( ( name ) => names.split( ',' ).indexOf( name ) );
	return lines.map( ( line ) => line.split( ',' ) ).map( ( numbers ) => ( { byTable: Number( numbers[ byTable ] ), truth: Number( numbers[ truth ] ) } ) );

}

/** The byte of a pixel that shows this radiance. */
function byteOf( radiance ) {

	const x = Math.min( Math.max( radiance, 0 ), 1 );
	return 255 * ( x <= 0.0031308 ? 12.92 * x : 1.055 * x ** ( 1 / 2.4 ) - 0.055 );

}

/** The bytes of the picture, four for each pixel from the top left. */
async function picture( browser, address, faults ) {

	const page = await openPage( browser, 'tutorial', 'about:blank', faults );
	await page.setViewportSize( { width: WIDTH, height: HEIGHT } );
	await page.goto( address );
	const failed = new Promise( ( _, reject ) => page.on( 'pageerror', reject ) );
	await Promise.race( [ page.waitForFunction( 'document.querySelector( "canvas" ).dataset.state === "drawn"' ), failed ] );
	const shot = ( await page.screenshot( { path: values.picture } ) ).toString( 'base64' );
	return page.evaluate( async ( shot ) => {

		const image = await createImageBitmap( await ( await fetch( `data:image/png;base64,${ shot }` ) ).blob() );
		const context = new OffscreenCanvas( image.width, image.height ).getContext( '2d' );
		context.drawImage( image, 0, 0 );
		return [ ...context.getImageData( 0, 0, image.width, image.height ).data ];

	}, shot );

}

const server = await serve( { '/': values.folder } );
try {

	const faults = [];
	const bytes = await withBrowser( values.chromium, ( browser ) => picture( browser, `http://127.0.0.1:${ server.address().port }/`, faults ) );
	const points = floorPoints();
	const answers = reflected( points.map( ( { point } ) => point ) );
	const report = { pixels: points.length, lit: 0, off: 0, fromTruth: 0, faults };
	points.forEach( ( { column, row }, n ) => RADIANCE.forEach( ( radiance, channel ) => {

		const byte = bytes[ 4 * ( row * WIDTH + column ) + channel ];
		const { byTable, truth } = answers[ n ];
		report.off = Math.max( report.off, Math.abs( byte - byteOf( radiance * byTable ) ) );
		report.fromTruth += Math.abs( byte - byteOf( radiance * truth ) ) / ( 3 * points.length );
		if ( channel === 0 && byte > 100 ) report.lit ++;

	} ) );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
