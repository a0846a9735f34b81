// Draws area lights with real engines, and compares them with the truth. Prints one JSON document.
//
//   node run.js --ltcforge PROGRAM --chromium PROGRAM [--exports FOLDER [--dielectric FOLDER] | --tables FILE] [--only ENGINE] [--pictures FOLDER]
//
// Every engine draws every view at every roughness, with four sets of tables: the stock tables, the stock numbers
// loaded like other tables, wrong tables, and ours. Our tables are the files of `ltcforge export --for ENGINE -o
// FOLDER/ENGINE`, or of FILE. With --dielectric, every engine also draws with two sets: the set of --exports for metal,
// and this set for plastic. Each material has its own textures, and in three.js one material also mixes both by
// metalness. An error is the mean absolute difference in linear radiance.
//
// With --pictures, it draws fewer and larger pictures instead, and writes ENGINE.png for each engine: stock, ours,
// truth, and both errors.

import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { reflected } from '../../examples/common/truth.js';
import { openPage, withBrowser } from './browser.js';
import { fromFile, repacked, stock, wrong } from './tables.js';
import { height, pictures, pointsOf, query, questionOf, views, width } from './world.js';

const HERE = fileURLToPath( new URL( '.', import.meta.url ) );

/** The engine whose files each engine reads. `three_webgpu` is three.js with WebGPURenderer. */
const ENGINES = { three: 'three', three_webgpu: 'three', babylon: 'babylon', playcanvas: 'playcanvas' };

/** The truth of each picture, at the pixels that show the table. */
async function truths( ltcforge ) {

	// The light does not depend on the reflectance.
	const questions = new Map();
	for ( const { roughness, view } of pictures ) {

		const points = pointsOf( view );
		const pixels = points.flatMap( ( point, i ) => point ? [ i ] : [] );
		questions.set( `${ roughness } ${ view.eye }`, { pixels, rows: pixels.map( ( i ) => questionOf( roughness, view, points[ i ] ) ) } );

	}

	const answers = await reflected( ltcforge, [ ...questions.values() ].flatMap( ( { rows } ) => rows ) );
	let next = 0;
	for ( const question of questions.values() ) question.answers = question.pixels.map( () => answers[ next ++ ] );
	return pictures.map( ( { f0, roughness, view } ) => {

		const { pixels, answers } = questions.get( `${ roughness } ${ view.eye }` );
		return { pixels, radiance: answers.map( ( { energy, fresnel } ) => f0 * ( energy - fresnel ) + fresnel ) };

	} );

}

/** Mean absolute error of each picture. */
function errorsOf( drawn, expected ) {

	return drawn.map( ( picture, number ) => {

		const { pixels, radiance } = expected[ number ];
		const total = pixels.reduce( ( sum, pixel, i ) => sum + Math.abs( picture[ pixel ] - radiance[ i ] ), 0 );
		return total / pixels.length;

	} );

}

/** The factor that makes errors of linear radiance visible. */
const ERROR_SCALE = 10;

/** The columns of the picture by `writePictures`. */
const COLUMNS = [ 'stock tables', 'ours', 'truth', `${ ERROR_SCALE } x error, stock`, `${ ERROR_SCALE } x error, ours` ];

/** The font of all pictures in the docs. */
const FONT = new URL( '../../src/view/picture/font/dejavu_sans.ttf', import.meta.url );

/** Writes a row for each picture: by the stock tables, by our tables, the truth, and the errors of both. */
async function writePictures( browser, engine, drawn, truth ) {

	const rows = pictures.map( ( _, number ) => {

		const { pixels, radiance } = truth[ number ];
		const nothing = () => new Array( width * height ).fill( 0 );
		const [ expected, ...errors ] = [ nothing(), nothing(), nothing() ];
		const masked = [ 'stock', 'ours' ].map( ( set, i ) => {

			const masked = nothing();
			pixels.forEach( ( pixel, n ) => {

				masked[ pixel ] = drawn[ set ][ number ][ pixel ];
				expected[ pixel ] = radiance[ n ];
				errors[ i ][ pixel ] = ERROR_SCALE * Math.abs( masked[ pixel ] - radiance[ n ] );

			} );
			return masked;

		} );
		return [ ...masked, expected, ...errors ];

	} );
	const page = await browser.newPage();
	const labels = pictures.map( ( { f0, roughness } ) => `F0 ${ f0 }, roughness ${ roughness }` );
	const font = `url(data:font/ttf;base64,${ ( await readFile( FONT ) ).toString( 'base64' ) })`;
	const address = await page.evaluate( async ( { rows, width, height, columns, labels, font } ) => {

		const gap = 4, head = 20;
		const canvas = document.createElement( 'canvas' );
		Object.assign( canvas, { width: columns.length * ( width + gap ) - gap, height: head + rows.length * ( height + gap ) - gap } );
		const context = canvas.getContext( '2d' );
		document.fonts.add( await new FontFace( 'labels', font ).load() );
		context.fillStyle = 'rgb(24, 24, 24)';
		context.fillRect( 0, 0, canvas.width, canvas.height );
		context.fillStyle = 'white';
		context.textBaseline = 'middle';
		context.font = '12px labels';
		const write = ( text, x, y ) => context.fillText( text, x + gap, y, width - 2 * gap );
		columns.forEach( ( text, x ) => write( text, x * ( width + gap ), head / 2 ) );
		rows.forEach( ( row, y ) => row.forEach( ( radiance, x ) => {

			const image = new ImageData( width, height );
			radiance.forEach( ( value, i ) => {

				const clamped = Math.min( Math.max( value, 0 ), 1 );
				const shown = clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * clamped ** ( 1 / 2.4 ) - 0.055;
				image.data.set( [ 255 * shown, 255 * shown, 255 * shown, 255 ], 4 * i );

			} );
			context.putImageData( image, x * ( width + gap ), head + y * ( height + gap ) );

		} ) );
		labels.forEach( ( text, y ) => write( text, 0, head + y * ( height + gap ) + height - head / 2 ) );
		return canvas.toDataURL( 'image/png' );

	}, { rows, width, height, columns: COLUMNS, labels, font } );
	await page.close();
	await writeFile( join( values.pictures, `${ engine }.png` ), Buffer.from( address.split( ',' )[ 1 ], 'base64' ) );

}

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, exports: { type: 'string' }, tables: { type: 'string' },
	only: { type: 'string' }, dielectric: { type: 'string' }, pictures: { type: 'string' },
} } );

const sets = { again: stock(), wrong: wrong( stock() ) };
if ( values.tables ) sets.ours = await fromFile( values.tables );

const answers = {};
for ( const [ name, set ] of Object.entries( sets ) ) {

	for ( const [ path, pack ] of Object.entries( repacked ) ) answers[ `/tables/${ name }/${ path }` ] = async () => pack( set );

}

const folders = { '/': HERE, '/node_modules/': `${ HERE }/node_modules`, '/docs/': `${ HERE }/../../docs/engines` };
if ( values.exports ) folders[ '/tables/ours/' ] = values.exports;
if ( values.dielectric ) folders[ '/tables/dielectric/' ] = values.dielectric;
const server = await serve( folders, answers );
const address = `http://127.0.0.1:${ server.address().port }`;

// Both renderers of three.js share a picture.
const engines = values.pictures ? new Set( Object.values( ENGINES ) ) : Object.keys( ENGINES );

const names = values.exports ? [ ...Object.keys( sets ), 'ours' ] : Object.keys( sets );

/** The pictures of an engine with a set of tables, or its own tables, and with a set for dielectrics. */
async function drawn( browser, engine, tables, dielectric, isMixed ) {

	const page = await openPage( browser, engine, `${ address }/pages/?engine=${ engine }&${ query }` );
	await page.waitForFunction( 'window.draw' );
	const at = ( set ) => set && `${ address }/tables/${ set }/${ ENGINES[ engine ] }`;
	const pictures = await page.evaluate( ( words ) => window.draw( ...words ), [ at( tables ), at( dielectric ), isMixed ] );
	await page.close();
	return pictures;

}

const report = { errors: {}, same: {} };
try {

	const truth = truths( values.ltcforge );
	// WebGPURenderer falls back to WebGL 2 without WebGPU.
	await withBrowser( values.chromium, async ( browser ) => {

		for ( const engine of values.only ? [ values.only ] : engines ) {

			// Only the package of three.js contains its tables.
			const isThree = ENGINES[ engine ] === 'three';
			const all = { stock: await drawn( browser, engine, isThree ? null : 'again' ) };
			for ( const set of names ) all[ set ] = await drawn( browser, engine, set );
			if ( values.dielectric ) all.both = await drawn( browser, engine, 'ours', 'dielectric' );
			if ( values.dielectric && isThree ) all.mixed = await drawn( browser, engine, 'ours', 'dielectric', true );
			report.errors[ engine ] = {};
			for ( const [ set, shown ] of Object.entries( all ) ) report.errors[ engine ][ set ] = errorsOf( shown, await truth );
			if ( values.pictures ) await writePictures( browser, engine, all, await truth );
			report.same[ engine ] = JSON.stringify( all.stock ) === JSON.stringify( all.again );

		}

	}, [ '--enable-unsafe-webgpu' ] );

} finally {

	server.close();

}

report.pictures = pictures.map( ( { f0, roughness, view } ) => ( { f0, roughness, view: views.indexOf( view ) } ) );
console.log( JSON.stringify( report ) );
