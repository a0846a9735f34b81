// The viewer's pixels beside those of previews, which the service's CPU renders, and its link.

import { withWorld } from './world.js';

/** Pixels a side, as the viewer has them. */
const SIZE = 512;

/** Twenty places that lie on the sphere, and on the floor below the horizon. */
const PLACES = Array.from( { length: 20 }, ( _, i ) => {

	const [ angle, radius ] = [ 2.4 * i, 100 * Math.sqrt( ( i + 0.5 ) / 20 ) ];
	return [ Math.round( SIZE / 2 + radius * Math.cos( angle ) ), Math.round( SIZE / 2 + radius * Math.sin( angle ) ) ];

} );

/** The names of previews for a scene of the viewer. */
function preview( { surface, table, ...scene } ) {

	const light = { light_centre: '-1.3,1.4,1.2', light_half_size: '0.7,0.45' };
	const camera = { camera_distance: 9, camera_elevation: 0.2, field_of_view: 0.5 };
	return new URLSearchParams( { scene: surface === 'floor' ? 'brushed_floor' : 'sphere', ...light, ...camera, ...( table ? { table } : { model: 'normals' } ), alpha_x: 0.5, alpha_y: 0.1, size: SIZE, ...scene } );

}

await withWorld( async ( { service, open } ) => {

	const reflected = await service.fit( { preset: 'draft' } );
	const round = await service.fit( { preset: 'draft', layout: 'ltc2017' } );
	const scenes = {
		normals: { rotation: 0.6, exposure: 2 },
		floor: { surface: 'floor', alpha_x: 0.2, alpha_y: 0.4 },
		reflected: { table: reflected, rotation: 0.6, camera_azimuth: 0.4 },
		round: { table: round, alpha_x: 0.3, alpha_y: 0.3 },
	};
	const page = await open( 'tables' );
	// Pixels of the picture in the page and of the service's, by places.
	const pixels = ( from, places ) => page.evaluate( async ( { from, places } ) => {

		const canvas = document.createElement( 'canvas' );
		const image = from ? await createImageBitmap( await ( await fetch( from ) ).blob() ) : document.querySelector( '.stage canvas' );
		Object.assign( canvas, { width: image.width, height: image.height } );
		const context = canvas.getContext( '2d' );
		context.drawImage( image, 0, 0 );
		return places.map( ( [ x, y ] ) => [ ...context.getImageData( x, y, 1, 1 ).data ].slice( 0, 3 ) );

	}, { from, places } );
	const apart = ( one, other ) => Math.max( ...one.flat().map( ( value, i ) => Math.abs( value - other.flat()[ i ] ) ) );
	const shown = async ( scene ) => {

		await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?${ new URLSearchParams( scene ) }` );
		await page.locator( '.stage polygon[points]' ).waitFor( { state: 'attached' } );

	};

	const off = {};
	const bright = {};
	for ( const [ name, scene ] of Object.entries( scenes ) ) {

		await shown( { ...scene, show: 'model' } );
		const [ ours, theirs ] = [ await pixels( null, PLACES ), await pixels( `v1/preview?${ preview( scene ) }`, PLACES ) ];
		off[ name ] = apart( ours, theirs );
		bright[ name ] = Math.max( ...theirs.flat() );

	}

	// The reference once it is still, over a grid.
	const grid = Array.from( { length: 400 }, ( _, i ) => [ 20 + 24 * ( i % 20 ), 20 + 24 * Math.floor( i / 20 ) ] );
	await shown( { show: 'reference', rotation: 0.3 } );
	await page.waitForFunction( () => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= 1024 );
	const sum = ( pixels ) => pixels.flat().reduce( ( a, b ) => a + b, 0 );
	const [ ours, theirs ] = [ sum( await pixels( null, grid ) ), sum( await pixels( `v1/preview?${ preview( { rotation: 0.3, mode: 'reference', spp: 1024 } ) }`, grid ) ) ];

	// The light is dragged and the camera turned; a page that is loaded again shows the same.
	const stage = await page.locator( '.stage svg' ).boundingBox();
	const drag = async ( x, y ) => {

		await page.mouse.move( stage.x + x, stage.y + y );
		await page.mouse.down();
		await page.mouse.move( stage.x + x + 60, stage.y + y + 30, { steps: 3 } );
		await page.mouse.up();

	};

	await drag( stage.width / 2, stage.height * 0.9 );
	await page.waitForFunction( () => location.hash.includes( 'camera_azimuth' ) );
	const before = await page.locator( '.stage polygon' ).getAttribute( 'points' );
	const middle = before.split( ' ' ).map( ( pair ) => pair.split( ',' ).map( Number ) ).reduce( ( [ a, b ], [ x, y ] ) => [ a + x / 4, b + y / 4 ], [ 0, 0 ] );
	await drag( ( middle[ 0 ] + 1 ) / 2 * stage.width, ( middle[ 1 ] + 1 ) / 2 * stage.height );
	await page.waitForFunction( () => location.hash.includes( 'light_x' ) );
	const hash = await page.evaluate( () => location.hash );
	const value = await page.locator( '#view-light_x' ).inputValue();
	await page.reload();
	await page.locator( '#view-light_x' ).waitFor();
	const kept = await page.locator( '#view-light_x' ).inputValue() === value && await page.evaluate( () => location.hash ) === hash;
	// A table that the reference is not of.
	const sheen = await service.fit( { preset: 'draft', brdf: 'charlie' } );
	await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?table=${ sheen }` );
	const refused = await page.locator( '.page-viewer .notice' ).textContent();
	return { off, bright, reference: ours / theirs - 1, kept, refused };

}, [ '--adapter', 'cpu' ] );
