// The viewer by WebGPU beside the viewer by WebGL 2: the same scenes, the same pixels. Prints null for them where the browser
// has no adapter.

import { glb, texturedSphere } from './glb.js';
import { withWorld } from './world.js';

/** Of a reference: two frames of the viewer. */
const SAMPLES = 16;

await withWorld( async ( { service, open } ) => {

	const page = await open( 'tables' );
	if ( ! await page.evaluate( async () => navigator.gpu && await navigator.gpu.requestAdapter() !== null ) ) return { off: null };
	const reflected = await service.fit( { preset: 'draft' } );
	const twoLobes = await service.fit( { preset: 'draft', fresnel: 'two_lobes' } );
	const blended = await service.fit( { preset: 'draft', fresnel: 'blended_lobes' } );
	const sheen = await service.fit( { preset: 'draft', brdf: 'charlie', range: { ratio: [ 1, 1 ], phi: [ 0, 0 ] } } );
	const plastic = { metal: 'plastic', alpha_x: 0.3, alpha_y: 0.2, exposure: 8 };
	const signs = { light_picture: 'signs', light_width: 0.8, light_height: 0.5 };
	const both = { lights: 2, light_shape: 'disk', light2_shape: 'tube', light2_height: 0.1 };
	const all = { ...both, lights: 4, light3_shape: 'line', light4_shape: 'hexagon' };
	const scenes = {
		normals: all, normals_picture: { ...signs, lights: 2 }, floor: { surface: 'floor', alpha_x: 0.1, alpha_y: 0.05, exposure: 4 }, ball: { surface: 'shader_ball' },
		table: { table: reflected, ...all, light_shape: 'sphere' }, table_picture: { table: reflected, ...signs },
		kt2022: { table: 'kt2022' }, plastic: { table: twoLobes, ...plastic }, blended: { table: blended, ...plastic }, engines: { table: 'engines', ...signs, lights: 2, light2_shape: 'sphere' },
	};
	/** Places over the picture. */
	const places = Array.from( { length: 400 }, ( _, i ) => [ 130 + 13 * ( i % 20 ), 130 + 13 * Math.floor( i / 20 ) ] );
	/** Pixels at the places as soon as the reference has so many samples; it has none where it is not shown. Without a scene that which is there is drawn by another. */
	const drawn = ( scene, by, samples = 0 ) => page.evaluate( async ( { hash, by, name, places, samples } ) => {

		const seen = () => document.querySelector( '.stage canvas' );
		const before = seen();
		const choice = document.querySelector( '#view-drawn_by' );
		if ( hash ) location.hash = hash;
		else {

			choice.value = by;
			choice.dispatchEvent( new Event( 'change' ) );

		}

		// Each frame of the viewer begins after this has seen the one before.
		do await new Promise( ( done ) => requestAnimationFrame( done ) );
		while ( seen() === before || ! ( Number( seen()?.dataset.samples ) >= samples ) );
		const canvas = seen();
		const file = new Promise( ( done ) => canvas.toBlob( done ) );
		const told = `${ canvas.dataset.samples } samples by ${ document.querySelector( '.facts' ).textContent.match( /WebG.*$/ ) }`;
		if ( told !== `${ samples } samples by ${ name }` ) throw new Error( told );
		// Chromium's software GPU has pictures of WebGPU as files alone.
		const image = await createImageBitmap( await file );
		const context = Object.assign( document.createElement( 'canvas' ), { width: image.width, height: image.height } ).getContext( '2d' );
		context.drawImage( image, 0, 0 );
		return places.flatMap( ( [ x, y ] ) => [ ...context.getImageData( x, y, 1, 1 ).data ].slice( 0, 3 ) );

	}, { hash: scene && `#/viewer?${ new URLSearchParams( { ...scene, drawn_by: by } ) }`, by, name: { webgl2: 'WebGL 2', webgpu: 'WebGPU' }[ by ], places, samples } );

	const off = {};
	const bright = {};
	const apart = ( one, other ) => one.reduce( ( most, byte, i ) => Math.max( most, Math.abs( byte - other[ i ] ) ), 0 );
	for ( const [ name, scene ] of Object.entries( scenes ) ) {

		const [ gl, gpu ] = [ await drawn( { ...scene, show: 'model' }, 'webgl2' ), await drawn( { ...scene, show: 'model' }, 'webgpu' ) ];
		off[ name ] = apart( gl, gpu );
		bright[ name ] = Math.max( ...gpu );

	}

	// References of as many samples: on average, as a sample at the border of two texels or of a light may fall on either.
	const reference = {};
	for ( const [ name, scene ] of Object.entries( { ggx: { ...both, light3_picture: 'signs', lights: 3 }, sheen: { table: sheen, metal: 'white', alpha_x: 0.4, alpha_y: 0.4, exposure: 4 } } ) ) {

		const [ gl, gpu ] = [ await drawn( { ...scene, show: 'reference' }, 'webgl2', SAMPLES ), await drawn( { ...scene, show: 'reference' }, 'webgpu', SAMPLES ) ];
		reference[ name ] = { off: gl.reduce( ( sum, byte, i ) => sum + Math.abs( byte - gpu[ i ] ), 0 ) / gl.length, bright: Math.max( ...gpu ) };

	}

	// By itself WebGPU is not chosen where the processor has to draw.
	await page.evaluate( () => location.hash = '#/viewer?show=model' );
	await page.locator( '.page-viewer .facts', { hasText: 'WebGL 2' } ).waitFor();
	await page.locator( '#view-drawn_by' ).selectOption( 'webgpu' );
	await page.locator( '.page-viewer .facts', { hasText: 'WebGPU' } ).waitFor();
	const linked = await page.evaluate( () => location.hash.includes( 'drawn_by=webgpu' ) );

	// Textures of a mesh, all of them with tangents of the file, some without; the mesh stays while something else draws it.
	const image = async ( ...pixels ) => Buffer.from( await page.evaluate( ( pixels ) => {

		const canvas = Object.assign( document.createElement( 'canvas' ), { width: pixels.length, height: 2 } );
		pixels.forEach( ( pixel, x ) => [ 0, 1 ].forEach( ( y ) => canvas.getContext( '2d' ).putImageData( new ImageData( new Uint8ClampedArray( [ ...pixel, 255 ] ), 1, 1 ), x, y ) ) );
		return canvas.toDataURL().split( ',' )[ 1 ];

	}, pixels ), 'base64' );
	// Four texels a pixel and more: the smaller levels, which are read, have the mean of the stripes.
	const wide = await image( ...Array.from( { length: 4096 }, ( _, x ) => [ 255 - x / 32, 90 + x / 32, x % 2 ? 250 : 0 ] ) );
	const material = { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicRoughnessTexture: { index: 1 } }, normalTexture: { index: 2 } };
	const images = [ wide, await image( [ 0, 120, 255 ], [ 0, 200, 40 ], [ 0, 120, 255 ] ), await image( [ 128, 160, 250 ], [ 150, 128, 250 ] ) ];
	for ( const [ name, file ] of Object.entries( { textured: texturedSphere( 32, material, images ), places: texturedSphere( 32, { ...material, pbrMetallicRoughness: { baseColorTexture: { index: 0 }, roughnessFactor: 0.6 } }, images, false ) } ) ) {

		await page.evaluate( () => location.hash = '#/viewer?show=model&exposure=2&drawn_by=webgl2' );
		await page.locator( '.page-viewer .facts', { hasText: 'WebGL 2' } ).waitFor();
		await page.locator( '#mesh' ).setInputFiles( { name: `${ name }.glb`, mimeType: 'model/gltf-binary', buffer: glb( file ) } );
		await page.locator( '.controls [role=status] p' ).first().waitFor();
		const [ gl, gpu ] = [ await drawn( null, 'webgl2' ), await drawn( null, 'webgpu' ) ];
		off[ name ] = apart( gl, gpu );
		bright[ name ] = Math.max( ...gpu );

	}

	return { off, bright, reference, linked };

}, [ '--adapter', 'cpu' ], [ '--enable-unsafe-webgpu' ] );
