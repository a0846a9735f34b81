// Drops a scene on the list of tables: picture, plan, planned table, errors of materials, and the files for an engine.

import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';

import { glb, sphere } from './glb.js';
import { withWorld } from './world.js';

const AXE = await readFile( createRequire( import.meta.url ).resolve( 'axe-core/axe.min.js' ), 'utf8' );

/** The files of an archive without compression. Checks its checksums with those of gzip. */
function unzipped( bytes ) {

	const files = {};
	for ( let at = 0; bytes.readUInt32LE( at ) === 0x04034b50; ) {

		const [ checksum, length, name ] = [ bytes.readUInt32LE( at + 14 ), bytes.readUInt32LE( at + 22 ), bytes.readUInt16LE( at + 26 ) ];
		const data = bytes.subarray( at + 30 + name, at + 30 + name + length );
		if ( gzipSync( data ).readUInt32LE( gzipSync( data ).length - 8 ) !== checksum ) throw new Error( 'wrong checksum' );
		files[ bytes.toString( 'utf8', at + 30, at + 30 + name ) ] = data.toString();
		at += 30 + name + length;

	}

	return files;

}

await withWorld( async ( { open } ) => {

	const page = await open( 'tables' );
	await page.locator( 'h1' ).waitFor();
	const scene = [ ...glb( sphere( 24, { name: 'blue plastic', pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 0.5, baseColorFactor: [ 0.05, 0.1, 0.5, 1 ] } } ) ) ];
	const data = await page.evaluateHandle( ( bytes ) => {

		const data = new DataTransfer();
		data.items.add( new File( [ new Uint8Array( bytes ) ], 'ball.glb' ) );
		return data;

	}, scene );
	await page.dispatchEvent( 'main', 'drop', { dataTransfer: data } );
	const panel = page.locator( '.scene' );
	// At first, the picture uses the table of engines. Then it uses the planned table.
	const first = await page.locator( '.page-viewer .shown .figures tbody th' ).first().textContent();
	await page.waitForFunction( () => /planned table/.test( document.querySelector( '.page-viewer .shown .figures tbody th' )?.textContent ) );
	const digest = await page.evaluate( () => new URLSearchParams( location.hash.split( '?' )[ 1 ] ).get( 'table' ) );
	const sentence = await panel.locator( 'p' ).first().textContent();
	await page.waitForFunction( () => /%/.test( document.querySelector( '.scene tbody td:last-child' ).textContent ) );
	const material = await panel.locator( 'tbody tr' ).first().innerText();

	// The diffuse part is visible: the lit half of the sphere is blue.
	const blue = await page.evaluate( () => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		const [ red, , blue ] = context.getImageData( Math.round( 0.3 * canvas.width ), Math.round( 0.6 * canvas.height ), 1, 1 ).data;
		return [ red, blue ];

	} );
	const violations = [];
	await page.evaluate( AXE );
	for ( const colorScheme of [ 'light', 'dark' ] ) {

		await page.emulateMedia( { colorScheme } );
		const found = await page.evaluate( () => window.axe.run( document, { runOnly: [ 'wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice' ] } ) );
		violations.push( ...found.violations.map( ( { id, nodes } ) => `${ colorScheme }: ${ id }: ${ nodes[ 0 ].html.slice( 0, 120 ) }` ) );

	}

	// The files, with the keyboard.
	await page.locator( '#view-engine' ).selectOption( 'wgpu' );
	await page.locator( '#view-engine' ).focus();
	await page.keyboard.press( 'Tab' );
	const saved = page.waitForEvent( 'download' );
	await page.keyboard.press( 'Enter' );
	const download = await saved;
	const files = unzipped( await readFile( await download.path() ) );

	// A reload keeps the file. Without it, the page says what is missing.
	await page.reload();
	await page.waitForFunction( () => document.querySelector( '#view-surface' )?.value === 'mesh' );
	// All sources and shaders of the viewer, compressed.
	const sources = await page.evaluate( () => [ location.href, ...performance.getEntriesByType( 'resource' ).map( ( { name } ) => name ) ].filter( ( name ) => ! /\/v1\/|healthz|version|published/.test( name ) ) );
	let size = 0;
	for ( const source of new Set( sources ) ) size += gzipSync( Buffer.from( await ( await fetch( source ) ).arrayBuffer() ) ).length;
	await page.evaluate( () => new Promise( ( done ) => indexedDB.deleteDatabase( 'ltcforge' ).onsuccess = done ) );
	await page.reload();
	const missing = await page.locator( '.controls .notice' ).textContent();
	return { size, first, digest, sentence, material, blue, violations, name: download.suggestedFilename(), names: Object.keys( files ).sort(), readme: files[ 'README.md' ], missing };

} );
