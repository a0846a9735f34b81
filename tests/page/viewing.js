// Uses the viewer: drags, adds and removes lights, reloads the link, and loses the WebGL context.

import { SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open } ) => {

	const page = await open( 'viewer?rotation=0.3&size=512&spp=64&glow=off' );
	/** Bytes from the left half of the image, which shows the model. */
	const bytes = () => page.evaluate( () => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		return [ ...context.getImageData( 180, 200, 70, 100 ).data ];

	} );
	await page.locator( '.page-viewer .facts' ).waitFor();

	// Drags the camera and the light. Reloading the page shows the same scene.
	const stage = await page.locator( '.stage svg' ).boundingBox();
	const drag = async ( x, y, dx = 60, dy = 30 ) => {

		await page.mouse.move( stage.x + x, stage.y + y );
		await page.mouse.down();
		await page.mouse.move( stage.x + x + dx, stage.y + y + dy, { steps: 3 } );
		await page.mouse.up();

	};

	await drag( stage.width * 0.6, stage.height * 0.9 );
	await page.waitForFunction( () => location.hash.includes( 'camera_azimuth' ) );
	const before = await page.locator( '.stage polygon' ).getAttribute( 'points' );
	const middle = before.split( ' ' ).map( ( pair ) => pair.split( ',' ).map( Number ) ).reduce( ( [ a, b ], [ x, y ] ) => [ a + x / 4, b + y / 4 ], [ 0, 0 ] );
	await drag( ( middle[ 0 ] + 1 ) / 2 * stage.width, ( middle[ 1 ] + 1 ) / 2 * stage.height );
	await page.waitForFunction( () => location.hash.includes( 'light_x' ) );
	await page.locator( '#view-split' ).fill( '0.3' );
	await page.waitForFunction( () => location.hash.includes( 'split=0.3' ) );
	const hash = await page.evaluate( () => location.hash );
	const value = await page.locator( '#view-light_x' ).inputValue();
	await page.reload();
	await page.locator( '#view-light_x' ).waitFor();
	const kept = await page.locator( '#view-light_x' ).inputValue() === value && await page.locator( '#view-split' ).inputValue() === '0.3' && await page.evaluate( () => location.hash ) === hash;
	await page.locator( '#view-split' ).fill( '0.5' );
	// The wheel, keys, the border and a double click. The page must not scroll.
	const number = ( name ) => page.locator( `#view-${ name }` ).inputValue().then( Number );
	await page.mouse.move( stage.x + stage.width * 0.7, stage.y + stage.height * 0.9 );
	await page.mouse.wheel( 0, 200 );
	await page.waitForFunction( () => location.hash.includes( 'camera_distance' ) );
	const gestures = { zoomed: await number( 'camera_distance' ), scrolled: await page.evaluate( () => window.scrollY ) };
	await page.locator( '.stage svg' ).focus();
	for ( const key of [ '+', '+', 'ArrowLeft', ']' ] ) await page.keyboard.press( key );
	gestures.keys = [ await number( 'camera_distance' ), await number( 'camera_azimuth' ), await number( 'split' ) ];
	await page.mouse.move( stage.x + stage.width * 0.55, stage.y + stage.height * 0.1 );
	await page.mouse.down();
	await page.mouse.move( stage.x + stage.width * 0.75, stage.y + stage.height * 0.1, { steps: 4 } );
	await page.mouse.up();
	gestures.border = await number( 'split' );
	await page.mouse.dblclick( stage.x + stage.width * 0.3, stage.y + stage.height * 0.9 );
	gestures.reset = [ await number( 'camera_distance' ), await number( 'camera_azimuth' ), await number( 'camera_elevation' ) ];
	const handle = await page.locator( '.stage .turn' ).boundingBox();
	await drag( handle.x + handle.width / 2 - stage.x, handle.y + handle.height / 2 - stage.y, - 25, 25 );
	const moved = await page.locator( '.stage .turn' ).boundingBox();
	gestures.turned = [ moved.x - handle.x, moved.y - handle.y ];
	// Two fingers that move apart zoom in.
	const client = await page.context().newCDPSession( page );
	const [ x, y ] = [ stage.x + stage.width * 0.6, stage.y + stage.height * 0.85 ];
	const touch = ( type, half ) => client.send( 'Input.dispatchTouchEvent', { type, touchPoints: half ? [ x - half, x + half ].map( ( x, id ) => ( { x, y, id } ) ) : [] } );
	await touch( 'touchStart', 20 );
	for ( const half of [ 25, 30, 35, 40 ] ) await touch( 'touchMove', half );
	await touch( 'touchEnd' );
	gestures.pinched = await number( 'camera_distance' );
	await page.mouse.dblclick( stage.x + stage.width * 0.3, stage.y + stage.height * 0.9 );
	await page.locator( '#view-light_yaw' ).fill( '0' );
	await page.locator( '#view-light_pitch' ).fill( '0' );
	// Adds a light, makes it a tube, drags it away from the camera, and removes it.
	await page.getByRole( 'button', { name: 'Add' } ).click();
	await page.locator( '#view-light_shape' ).selectOption( 'tube' );
	const outlines = await page.locator( '.stage polygon' ).count();
	const z = Number( await page.locator( '#view-light_z' ).inputValue() );
	await page.keyboard.down( 'Shift' );
	const box = await page.locator( '.stage polygon' ).nth( 1 ).boundingBox();
	await drag( box.x + box.width / 2 - stage.x, box.y + box.height / 2 - stage.y );
	await page.keyboard.up( 'Shift' );
	await page.waitForFunction( ( z ) => Number( document.querySelector( '#view-light_z' ).value ) !== z, z );
	const linked = await page.evaluate( () => location.hash.includes( 'lights=2' ) && location.hash.includes( 'light2_shape=tube' ) );
	await page.getByRole( 'button', { name: 'Remove' } ).click();
	// The next frame removes its outline.
	await page.waitForFunction( () => document.querySelectorAll( '.stage polygon' ).length < 2 );
	const left = await page.locator( '.stage polygon' ).count();

	// After the context is restored, the image is the same as before.
	const beforeLoss = await bytes();
	await page.evaluate( () => {

		const lost = document.querySelector( '.stage canvas' ).getContext( 'webgl2' ).getExtension( 'WEBGL_lose_context' );
		lost.loseContext();
		document.querySelector( '.stage canvas' ).dataset.samples = '';
		setTimeout( () => lost.restoreContext(), 100 );

	} );
	await page.waitForFunction( () => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= 64 );
	const restored = Math.max( ...( await bytes() ).map( ( byte, i ) => Math.abs( byte - beforeLoss[ i ] ) ) );

	// The viewer rejects a table without a reference.
	const diffuse = await service.fit( { preset: 'draft', brdf: 'oren_nayar', fit: SMALL.fit } );
	await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?table=${ diffuse }` );
	const refused = await page.locator( '.page-viewer .notice' ).textContent();

	// A table with a list of materials, with numbers of 16 bits.
	const listed = await service.fit( { ...SMALL, layout: 'materials', precision: 'f16', materials: [ { alpha: 0.3 } ], resolution: { theta: 2, phi: 2 } } );
	await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?table=${ listed }&size=256&spp=8` );
	const ofList = await page.locator( '.page-viewer .figures tbody th' ).first().textContent();

	// Occluders hide parts of the light, in the truth and in a model with shadows.
	const shadows = {};
	for ( const way of [ 'off', '4' ] ) {

		await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?table=ltc-formula&occluders=ball_and_box&shadows=${ way }&size=256&spp=512&alpha_x=0.3&alpha_y=0.2` );
		await page.waitForFunction( ( way ) => location.hash.includes( `shadows=${ way }` ) && Number( document.querySelector( '.stage canvas' )?.dataset.samples ) >= 512, way );
		shadows[ way ] = await page.evaluate( () => JSON.parse( document.querySelector( '.stage canvas' ).dataset.errors ).sides[ 0 ].mean );

	}

	return { shadows, gestures, kept, outlines, linked, left, restored, refused, ofList };

} );
