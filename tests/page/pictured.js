// Pictures on lights. Compares the viewer's pixels with `ltcforge light --texture` for the same surfaces, and its
// reference with `--truth`. Then it opens files.

import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { camera, METALS, placed, read } from '../../src/server/page/viewer/scene.js';
import { LTCFORGE, withWorld } from './world.js';

const SIZE = 512;

/** Twenty pixels on the sphere, around the highlight. */
const PLACES = Array.from( { length: 20 }, ( _, i ) => {

	const [ angle, radius ] = [ 2.4 * i, 50 * Math.sqrt( ( i + 0.5 ) / 20 ) ];
	return [ Math.round( 205 + radius * Math.cos( angle ) ), Math.round( 220 + radius * Math.sin( angle ) ) ];

} );

const dot = ( a, b ) => a.reduce( ( sum, x, i ) => sum + x * b[ i ], 0 );
const plus = ( a, b, by = 1 ) => a.map( ( x, i ) => x + by * b[ i ] );
const unit = ( v ) => v.map( ( x ) => x / Math.sqrt( dot( v, v ) ) );
const cross = ( a, b ) => [ 0, 1, 2 ].map( ( i ) => a[ ( i + 1 ) % 3 ] * b[ ( i + 2 ) % 3 ] - a[ ( i + 2 ) % 3 ] * b[ ( i + 1 ) % 3 ] );

/** The input line of `ltcforge light` for a pixel of the sphere: surface, view, and corners of the light in the tangent frame. */
function line( scene, [ x, y ] ) {

	const { eye, right, up, forward } = camera( scene );
	const at = [ x, y ].map( ( pixel ) => ( pixel + 0.5 ) / SIZE * 2 - 1 );
	const ray = unit( plus( plus( forward, right, at[ 0 ] ), up, - at[ 1 ] ) );
	const closest = - dot( eye, ray );
	const nearest = plus( eye, ray, closest );
	const normal = unit( plus( nearest, ray, - Math.sqrt( 1 - dot( nearest, nearest ) ) ) );
	const along = unit( [ normal[ 2 ], 0, - normal[ 0 ] ] );
	const frame = [ along, cross( normal, along ), normal ];
	const local = ( v ) => frame.map( ( axis ) => dot( v, axis ) );
	const view = local( unit( plus( eye, normal, - 1 ) ) );
	const corners = placed( scene.lights[ 0 ] ).vertices.flatMap( ( corner ) => local( plus( corner, normal, - 1 ) ) );
	return [ scene.alpha_x, scene.alpha_y, Math.acos( view[ 2 ] ), Math.atan2( view[ 1 ], view[ 0 ] ), 1, ...corners ].join( ',' );

}

/** The byte of the image for a radiance. */
const shownAs = ( radiance, exposure ) => {

	const y = 1 - Math.exp( - exposure * radiance );
	return 255 * ( y <= 0.0031308 ? 12.92 * y : 1.055 * y ** ( 1 / 2.4 ) - 0.055 );

};

/** The inverse of `shownAs` at exposure 1. */
const linear = ( byte ) => {

	const v = byte / 255;
	return - Math.log( 1 - ( v <= 0.04045 ? v / 12.92 : ( ( v + 0.055 ) / 1.055 ) ** 2.4 ) );

};

await withWorld( async ( { service, open } ) => {

	const folder = mkdtempSync( join( tmpdir(), 'ltcforge-' ) );
	const digest = await service.fit( { preset: 'draft' } );
	const page = await open( 'tables' );
	writeFileSync( join( folder, 'table' ), Buffer.from( await ( await fetch( `${ service.url }/v1/tables/${ digest }` ) ).arrayBuffer() ) );

	/** The colours that `ltcforge light` prints for all places. `begin` is the prefix of their columns. */
	function printed( scene, png, words, begin = '' ) {

		const path = join( folder, 'shown.png' );
		writeFileSync( path, Buffer.from( png.split( ',' )[ 1 ], 'base64' ) );
		const { stdout, stderr, status } = spawnSync( LTCFORGE, [ 'light', '-', '--texture', path, ...words ], { input: PLACES.map( ( place ) => line( scene, place ) ).join( '\n' ) + '\n', encoding: 'utf8', cwd: folder } );
		if ( status !== 0 ) throw new Error( stderr );
		const [ names, ...rows ] = stdout.trimEnd().split( '\n' ).map( ( row ) => row.split( ',' ) );
		return rows.map( ( row ) => [ 'red', 'green', 'blue' ].map( ( channel ) => Number( row[ names.indexOf( begin + channel ) ] ) ) );

	}

	const shown = async ( scene ) => {

		await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?${ new URLSearchParams( { size: SIZE, glow: 'off', diffuse: 'off', spp: 2, ...scene } ) }` );
		await page.locator( '.page-viewer .facts' ).waitFor();

	};

	const sampled = ( samples ) => page.waitForFunction( ( samples ) => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= samples, samples );

	/** Pixels of the image at places, and the picture on the light as a PNG. */
	const pixelsAt = ( places = PLACES ) => page.evaluate( ( places ) => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		return { pixels: places.map( ( [ x, y ] ) => [ ...context.getImageData( x, y, 1, 1 ).data ].slice( 0, 3 ) ), png: document.querySelector( '.screen' ).toDataURL() };

	}, places );
	const frame = () => page.evaluate( () => new Promise( ( done ) => requestAnimationFrame( () => requestAnimationFrame( done ) ) ) );
	const apart = ( one, other ) => Math.max( ...one.flat().map( ( value, i ) => Math.abs( value - other.flat()[ i ] ) ) );
	// Texels are square on this light.
	const light = { light_picture: 'signs', light_width: 0.8, light_height: 0.5, exposure: 2 };
	const [ f0 ] = METALS.plastic;
	const plastic = { ...light, metal: 'plastic', exposure: 8 };
	const byte = ( scene, png, words, begin ) => {

		const asked = read( new URLSearchParams( scene ) );
		return printed( asked, png, [ '--f0', String( f0 ), ...words ], begin ).map( ( colours ) => colours.map( ( colour ) => shownAs( asked.lights[ 0 ].intensity * colour, asked.exposure ) ) );

	};

	const off = {};
	const bright = {};
	for ( const [ name, scene, words ] of [
		[ 'normals', plastic, [] ],
		[ 'formula', { ...plastic, table: 'ltc-formula' }, [ '--model', 'ltc-formula' ] ],
		[ 'sharp', { ...plastic, alpha_x: 0.1, alpha_y: 0.05 }, [] ],
		[ 'table', { ...plastic, table: digest }, [ '--model', 'ltc', '--table', 'table' ] ],
	] ) {

		await shown( { ...scene, show: 'model' } );
		const { pixels, png } = await pixelsAt();
		const expected = byte( scene, png, words );
		off[ name ] = apart( pixels, expected );
		bright[ name ] = Math.max( ...expected.flat() );

	}

	// The picture of the second light is in another layer. The dim first light shows another picture.
	const second = { lights: 2, light2_x: - 1.3, light2_y: 1.4, light2_z: 1.2, light2_width: 0.8, light2_height: 0.5, light2_picture: 'signs' };
	await shown( { ...plastic, ...second, light_picture: 'disc', light_intensity: 0.1, show: 'model' } );
	const inTwo = ( await pixelsAt() ).pixels;
	const alone = ( await shown( { ...plastic, show: 'model' } ), await pixelsAt() ).pixels;
	off.second = apart( inTwo, alone );

	// Engines only use the mean. In each channel, the whole surface is darker by one factor.
	const round = { table: 'engines', metal: 'white', alpha_x: 0.4, alpha_y: 0.4, show: 'model', light_width: 0.8, light_height: 0.5 };
	const [ plainly, pictured ] = [ ( await shown( round ), await frame(), await pixelsAt() ).pixels, ( await shown( { ...round, light_picture: 'signs' } ), await pixelsAt() ).pixels ];
	const darker = [ 0, 1, 2 ].map( ( channel ) => plainly.map( ( pixel, i ) => linear( pictured[ i ][ channel ] ) / linear( pixel[ channel ] ) ).filter( ( _, i ) => plainly[ i ][ channel ] > 90 ) );
	const engines = darker.map( ( factors ) => [ Math.min( ...factors ), Math.max( ...factors ) ] );

	// Compare the reference with `--truth`.
	await shown( { ...plastic, show: 'reference', spp: 512 } );
	await sampled( 512 );
	const truly = await pixelsAt();
	const sum = ( pixels ) => pixels.flat().reduce( ( a, b ) => a + b, 0 );
	const reference = sum( truly.pixels ) / sum( byte( plastic, truly.png, [ '--truth' ], 'true_' ) ) - 1;
	// The mean error of the picture, against `--truth` at every sixth pixel of the sphere in each direction.
	const errors = {};
	for ( const [ name, table, words ] of [ [ 'normals', '', [ '--model', 'normals' ] ], [ 'ltc-formula', 'ltc-formula', [ '--model', 'ltc-formula' ] ], [ 'table', digest, [ '--model', 'ltc', '--table', 'table' ] ] ] ) {

		const scene = { table, metal: 'white', alpha_x: 0.4, alpha_y: 0.1, rotation: 0, light_width: 1.5, show: 'reference', spp: 256 };
		await shown( scene );
		await sampled( 256 );
		const told = await page.evaluate( () => JSON.parse( document.querySelector( '.stage canvas' ).dataset.errors ).sides[ 0 ].mean );
		const asked = read( new URLSearchParams( scene ) );
		const grid = Array.from( { length: 7225 }, ( _, i ) => [ 4 + 6 * ( i % 85 ), 4 + 6 * Math.floor( i / 85 ) ] ).map( ( place ) => line( asked, place ) ).filter( ( text ) => ! text.includes( 'NaN' ) );
		const { stdout, stderr, status } = spawnSync( LTCFORGE, [ 'light', '-', '--truth', '--f0', '1', ...words ], { input: grid.join( '\n' ) + '\n', encoding: 'utf8', cwd: folder } );
		if ( status !== 0 ) throw new Error( stderr );
		const [ names, ...rows ] = stdout.trimEnd().split( '\n' ).map( ( row ) => row.split( ',' ) );
		const [ ours, truth ] = [ 'reflected', 'true_reflected' ].map( ( name ) => rows.map( ( row ) => Number( row[ names.indexOf( name ) ] ) ) );
		const total = ( values ) => values.reduce( ( a, b ) => a + b, 0 );
		errors[ name ] = [ told, total( ours.map( ( value, i ) => Math.abs( value - truth[ i ] ) ) ) / total( truth ), grid.length ];

	}


	rmSync( folder, { recursive: true } );

	// A file of one colour gives the same light as no picture. The link does not contain the file.
	await shown( { light_width: 0.8, light_height: 0.5, show: 'model' } );
	const plain = ( await pixelsAt() ).pixels;
	const openFile = async ( name, mimeType, buffer ) => {

		await page.locator( '#picture' ).setInputFiles( { name, mimeType, buffer } );
		await page.waitForFunction( ( name ) => document.querySelector( '#view-light_picture' ).selectedOptions[ 0 ].textContent === name, name );
		await frame();

	};

	const white = await page.evaluate( () => {

		const canvas = Object.assign( document.createElement( 'canvas' ), { width: 7, height: 5 } );
		const context = canvas.getContext( '2d' );
		context.fillStyle = '#ffffff';
		context.fillRect( 0, 0, 7, 5 );
		return canvas.toDataURL().split( ',' )[ 1 ];

	} );
	await openFile( 'white.png', 'image/png', Buffer.from( white, 'base64' ) );
	await page.waitForFunction( () => document.querySelector( '.screen' ).width === 256 );
	await frame();
	const opened = { off: apart( ( await pixelsAt() ).pixels, plain ), linked: await page.evaluate( () => location.hash.includes( 'picture' ) ) };
	await page.locator( '#picture' ).setInputFiles( { name: 'no.png', mimeType: 'image/png', buffer: Buffer.from( 'no picture' ) } );
	const refused = await page.locator( '.controls .notice' ).textContent();

	// This page records a video: red, then blue.
	const film = await page.evaluate( () => new Promise( ( done ) => {

		const canvas = Object.assign( document.createElement( 'canvas' ), { width: 64, height: 40 } );
		const context = canvas.getContext( '2d' );
		const recorder = new MediaRecorder( canvas.captureStream( 30 ), { mimeType: 'video/webm' } );
		const parts = [];
		recorder.ondataavailable = ( { data } ) => parts.push( data );
		recorder.onstop = async () => done( [ ...new Uint8Array( await new Blob( parts ).arrayBuffer() ) ] );
		recorder.start();
		const start = performance.now();
		const draw = () => {

			context.fillStyle = performance.now() - start < 400 ? '#ff0000' : '#0000ff';
			context.fillRect( 0, 0, 64, 40 );
			if ( performance.now() - start < 800 ) requestAnimationFrame( draw );
			else recorder.stop();

		};

		draw();

	} ) );
	await openFile( 'film.webm', 'video/webm', Buffer.from( film ) );
	const colours = new Set();
	for ( const since = performance.now(); colours.size < 2 && performance.now() - since < 20_000; ) {

		await frame();
		const [ red, , blue ] = ( await pixelsAt() ).pixels[ 0 ];
		if ( red > 60 || blue > 60 ) colours.add( red > blue ? 'red' : 'blue' );

	}

	// Pause stops the video. The link contains the built-in video.
	await page.locator( '#view-light_picture' ).selectOption( 'disc' );
	await frame();
	const changes = async () => {

		const { png } = await pixelsAt();
		await frame();
		await frame();
		return png !== ( await pixelsAt() ).png;

	};

	const moves = await changes();
	await page.getByRole( 'button', { name: 'Pause' } ).click();
	await frame();
	const stops = ! await changes();
	const kept = await page.evaluate( () => location.hash.includes( 'light_picture=disc' ) );
	await page.reload();
	await page.locator( '.page-viewer .facts' ).waitFor();
	const again = await page.locator( '#view-light_picture' ).inputValue();
	return { errors, off, bright, engines, reference, opened, refused, colours: [ ...colours ].sort(), moves, stops, kept, again };

}, [ '--adapter', 'cpu' ] );
