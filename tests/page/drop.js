// Drops a scene on the list of tables: picture, its own light, plan, planned table, errors of materials, and the files for an
// engine. Then does the same with the keyboard only.

import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';

import { glb, sphere } from './glb.js';
import { unzipped } from './unzipped.js';
import { withWorld } from './world.js';

const AXE = await readFile( createRequire( import.meta.url ).resolve( 'axe-core/axe.min.js' ), 'utf8' );

await withWorld( async ( { open } ) => {

	// A small window, because drivers without a GPU draw slowly.
	const viewport = { width: 900, height: 650 };
	const page = await open( 'tables', { viewport } );
	await page.locator( 'h1' ).waitFor();
	// In the viewer, the light is at (0, 0, 3), with sides of length 1 and 0.5.
	const lit = sphere( 24, { name: 'blue plastic', pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 0.5, baseColorFactor: [ 0.05, 0.1, 0.5, 1 ] } } );
	lit.document.extensionsUsed = [ 'EXT_lights_area' ];
	lit.document.extensions = { EXT_lights_area: { lights: [ { type: 'rect', size: 1, rect: { aspect: 2 }, intensity: 100 } ] } };
	lit.document.nodes.push( { translation: [ 4, 5, 12 ], extensions: { EXT_lights_area: { light: 0 } } } );
	lit.document.scenes[ 0 ].nodes.push( 2 );
	const scene = [ ...glb( lit ) ];
	const data = await page.evaluateHandle( ( bytes ) => {

		const data = new DataTransfer();
		data.items.add( new File( [ new Uint8Array( bytes ) ], 'ball.glb' ) );
		return data;

	}, scene );
	await page.dispatchEvent( 'main', 'drop', { dataTransfer: data } );
	const panel = page.locator( '.scene' );
	// The picture follows the advice of the plan, and then the user.
	await page.waitForFunction( () => /closed form/.test( document.querySelector( '.page-viewer .shown .figures tbody th' )?.textContent ) );
	const advised = await page.locator( '.page-viewer .shown .figures tbody th' ).first().textContent();
	await page.getByRole( 'button', { name: 'Fit the planned table' } ).click();
	await page.waitForFunction( () => /planned table/.test( document.querySelector( '.page-viewer .shown .figures tbody th' )?.textContent ) );
	const digest = await page.evaluate( () => new URLSearchParams( location.hash.split( '?' )[ 1 ] ).get( 'table' ) );
	const sentence = await panel.locator( 'p' ).first().textContent();
	await page.waitForFunction( () => /%/.test( document.querySelector( '.scene tbody td:last-child' ).textContent ) );
	const material = await panel.locator( 'tbody tr' ).first().innerText();
	const light = await Promise.all( [ 'x', 'y', 'z', 'width', 'height' ].map( ( name ) => page.locator( `#view-light_${ name }` ).inputValue().then( Number ) ) );

	// The diffuse part is visible: the lit half of the sphere is blue.
	const blue = await page.evaluate( () => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		const [ red, , blue ] = context.getImageData( Math.round( 0.3 * canvas.width ), Math.round( 0.6 * canvas.height ), 1, 1 ).data;
		return [ red, blue ];

	} );
	// The ball of the material: both halves, left and right of the middle.
	const ball = await page.waitForFunction( () => {

		const swatch = document.querySelector( '.swatch' );
		return swatch.width > 1 && [ 24, 40 ].map( ( x ) => [ ...swatch.getContext( '2d' ).getImageData( x, 24, 1, 1 ).data ] );

	} );
	const halves = await ball.jsonValue();
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

	// Another size of the window starts the picture again.
	const errors = [];
	for ( const height of [ 900, 650 ] ) {

		const before = await page.locator( '.stage canvas' ).getAttribute( 'width' );
		await page.setViewportSize( { width: 900, height } );
		await page.waitForFunction( ( before ) => document.querySelector( '.stage canvas' ).getAttribute( 'width' ) !== before, before );
		await page.waitForFunction( () => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= 16 );
		errors.push( await page.evaluate( () => JSON.parse( document.querySelector( '.stage canvas' ).dataset.errors ).sides[ 0 ].mean ) );

	}

	// A reload keeps the file and the choice of the left side. Without the file, the page says what is missing.
	await page.locator( '#model' ).selectOption( 'engines' );
	await page.reload();
	await page.waitForFunction( () => document.querySelector( '#view-surface' )?.value === 'mesh' );
	await page.waitForFunction( () => document.querySelector( '.scene p' )?.textContent );
	const reloaded = await page.locator( '#model' ).inputValue();
	// All sources and shaders of the viewer, compressed.
	const sources = await page.evaluate( () => [ location.href, ...performance.getEntriesByType( 'resource' ).map( ( { name } ) => name ) ].filter( ( name ) => ! /\/v1\/|healthz|version|published/.test( name ) ) );
	let size = 0;
	for ( const source of new Set( sources ) ) size += gzipSync( Buffer.from( await ( await fetch( source ) ).arrayBuffer() ) ).length;
	await page.evaluate( () => new Promise( ( done ) => indexedDB.deleteDatabase( 'ltcforge' ).onsuccess = done ) );
	await page.reload();
	const missing = await page.locator( '.controls .notice' ).textContent();
	// The same with the keyboard only: open a file, choose both sides, move the border, choose an engine, and save the files.
	await page.close();
	const keys = await open( 'viewer?size=256&spp=16', { viewport } );
	await keys.waitForFunction( () => document.querySelector( '.stage canvas' )?.dataset.samples === '16' );
	const presses = async ( done, key = 'Tab' ) => {

		for ( let i = 0; i < 120; i ++ ) {

			if ( await keys.evaluate( done ) ) return;
			await keys.keyboard.press( key );

		}

		throw new Error( `no element after 120 times ${ key }: ${ done }` );

	};

	await presses( () => document.activeElement.id === 'mesh' );
	const chooser = keys.waitForEvent( 'filechooser' );
	await keys.keyboard.press( 'Space' );
	await ( await chooser ).setFiles( { name: 'keys.glb', mimeType: 'model/gltf-binary', buffer: Buffer.from( scene ) } );
	await keys.waitForFunction( () => /closed form/.test( document.querySelector( '.page-viewer .shown .figures tbody th' )?.textContent ) && document.querySelector( '.scene p' )?.textContent );
	await presses( () => document.activeElement.id === 'model' );
	await keys.keyboard.press( 'Home' );
	await presses( () => document.activeElement.value === 'engines', 'ArrowDown' );
	await presses( () => document.activeElement.id === 'against' );
	await presses( () => document.activeElement.value === 'ltc-formula', 'ArrowDown' );
	await presses( () => document.activeElement.matches( '.stage svg' ) );
	await keys.keyboard.press( ']' );
	const keyed = await keys.evaluate( () => Object.fromEntries( [ ...new URLSearchParams( location.hash.split( '?' )[ 1 ] ) ].filter( ( [ name ] ) => [ 'table', 'against', 'split' ].includes( name ) ) ) );
	await presses( () => document.activeElement.id === 'view-engine' );
	await presses( () => document.activeElement.value === 'wgpu', 'ArrowDown' );
	await presses( () => document.activeElement.matches( '.scene .primary' ) );
	const savedByKeys = keys.waitForEvent( 'download' );
	await keys.keyboard.press( 'Enter' );
	keyed.saved = ( await savedByKeys ).suggestedFilename();
	return { light, keyed, halves, advised, errors, reloaded, size, digest, sentence, material, blue, violations, name: download.suggestedFilename(), names: Object.keys( files ).sort(), readme: files[ 'README.md' ], missing };

} );
