// Compares textures of a glTF file in the viewer with equal factors, and checks notes about textures that are not
// shown.

import { glb, texturedSphere } from './glb.js';
import { withWorld } from './world.js';

await withWorld( async ( { open } ) => {

	const page = await open( 'viewer?size=512&glow=off&diffuse=off&spp=2&show=model&exposure=2' );
	// Without a plan, the model stays the same.
	await page.route( '**/v1/plans*', ( route ) => route.fulfill( { json: { summary: [ 'no plan' ], plan: { scene: { lights: [], materials: [] }, tables: [] } } } ) );
	await page.locator( '.page-viewer .facts' ).waitFor();
	/** The bytes of an image that is one row of pixels. */
	const image = async ( type, ...pixels ) => Buffer.from( await page.evaluate( ( [ type, pixels ] ) => {

		const canvas = Object.assign( document.createElement( 'canvas' ), { width: pixels.length, height: 1 } );
		pixels.forEach( ( pixel, x ) => canvas.getContext( '2d' ).putImageData( new ImageData( new Uint8ClampedArray( [ ...pixel, 255 ] ), 1, 1 ), x, 0 ) );
		return canvas.toDataURL( `image/${ type }`, 1 ).split( ',' )[ 1 ];

	}, [ type, pixels ] ), 'base64' );
	let files = 0;
	/** Opens a file. Returns its note. */
	const noteOf = async ( scene ) => {

		const name = `scene${ ++ files }.glb`;
		await page.locator( '#mesh' ).setInputFiles( { name, mimeType: 'model/gltf-binary', buffer: glb( scene ) } );
		await page.waitForFunction( ( name ) => document.querySelector( '#view-surface' ).selectedOptions[ 0 ].textContent === name, name );
		return page.locator( '.controls [role=status] p' ).textContent();

	};

	/** The middle of the image with a file, 200 pixels per side. */
	const shown = async ( scene ) => {

		await noteOf( scene );
		// The file appears in the second frame.
		return page.evaluate( () => new Promise( ( done ) => requestAnimationFrame( () => requestAnimationFrame( () => {

			const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
			Object.assign( copy, { width: canvas.width, height: canvas.height } );
			const context = copy.getContext( '2d' );
			context.drawImage( canvas, 0, 0 );
			done( [ ...context.getImageData( 156, 156, 200, 200 ).data ] );

		} ) ) ) );

	};

	const apart = ( one, other ) => one.reduce( ( most, byte, i ) => Math.max( most, Math.abs( byte - other[ i ] ) ), 0 );
	const linear = ( byte ) => byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ( ( byte / 255 + 0.055 ) / 1.055 ) ** 2.4;
	const [ colour, rough ] = [ [ 200, 150, 100 ], [ 0, 160, 204 ] ];
	const textured = { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicRoughnessTexture: { index: 1 } } };
	const factors = { pbrMetallicRoughness: { baseColorFactor: [ ...colour.map( linear ), 1 ], roughnessFactor: rough[ 1 ] / 255, metallicFactor: rough[ 2 ] / 255 } };
	const plain = await shown( texturedSphere( 48, factors, [] ) );
	const constant = apart( plain, await shown( texturedSphere( 48, textured, [ await image( 'png', colour ), await image( 'png', rough ) ] ) ) );
	const jpeg = apart( plain, await shown( texturedSphere( 48, textured, [ await image( 'jpeg', colour ), await image( 'jpeg', rough ) ] ) ) );

	// The left half of the texture is red, and the right half is blue. Measures red at the left and at the right of the
	// image.
	const two = await shown( texturedSphere( 48, { pbrMetallicRoughness: { roughnessFactor: 0.9, baseColorTexture: { index: 0 } } }, [ await image( 'png', [ 255, 0, 0 ], [ 0, 0, 255 ] ) ] ) );
	const red = ( from ) => {

		const sums = [ 0, 0, 0 ];
		for ( let y = 0; y < 200; y ++ ) for ( let x = from; x < from + 60; x ++ ) for ( let c = 0; c < 3; c ++ ) sums[ c ] += two[ 4 * ( 200 * y + x ) + c ];
		return sums[ 0 ] / ( sums[ 0 ] + sums[ 2 ] );

	};

	// Normals that lean upwards by 15 degrees move the middle of the highlight downwards.
	const leaning = [ 128, Math.round( 127.5 * ( 1 + Math.sin( 0.26 ) ) ), Math.round( 127.5 * ( 1 + Math.cos( 0.26 ) ) ) ];
	const normals = { pbrMetallicRoughness: { roughnessFactor: 0.6 }, normalTexture: { index: 0 } };
	const middle = ( bytes ) => {

		let [ sum, all ] = [ 0, 0 ];
		for ( let i = 0; i < bytes.length; i += 4 ) [ sum, all ] = [ sum + bytes[ i ] * Math.floor( i / 800 ), all + bytes[ i ] ];
		return sum / all;

	};

	const lean = await shown( texturedSphere( 48, normals, [ await image( 'png', leaning ) ] ) );
	const level = await shown( texturedSphere( 48, normals, [ await image( 'png', [ 128, 128, 255 ] ) ] ) );
	const without = await shown( texturedSphere( 48, normals, [ await image( 'png', leaning ) ], false ) );

	// Textures that are not shown.
	const wide = await image( 'png', colour );
	wide.writeUInt32BE( 65536, 16 );
	const cut = ( await image( 'png', colour ) ).subarray( 0, 30 );
	const other = { ...textured, normalTexture: { index: 2 }, occlusionTexture: { index: 1 } };
	const notes = await noteOf( texturedSphere( 4, other, [ Buffer.from( 'RIFF, a WebP' ), wide, cut ] ) );
	const turned = { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicRoughnessTexture: { index: 0, texCoord: 1 } }, normalTexture: { index: 0, extensions: { KHR_texture_transform: {} } } };
	const outside = texturedSphere( 4, turned, [] );
	Object.assign( outside.document, { images: [ { uri: 'https://example.com/colour.png' } ], textures: [ { source: 0 } ] } );
	const beside = await noteOf( outside );
	return { bright: apart( plain.filter( ( _, i ) => i % 4 === 0 ), Array( 40_000 ).fill( 0 ) ), constant, jpeg, halves: [ red( 0 ), red( 140 ) ], moved: middle( lean ) - middle( level ), derived: apart( lean, without ), notes, beside };

} );
