// The errors of a table over angle and roughness, by pointer and by keys.

import { withWorld } from './world.js';

await withWorld( async ( { service, open } ) => {

	const digest = await service.fit( { preset: 'draft' } );
	const errors = await service.call( `/v1/tables/${ digest }/plots/error.json?ratio=0.25&phi=0.7` );
	const page = await open( `tables/${ digest }` );
	const map = page.locator( '.map' ).first();
	const told = page.locator( '.told' );
	await told.filter( { hasText: 'lobe off by' } ).waitFor();
	/** What is to be told of a cell, in the same words. */
	const wanted = ( column, row ) => `seen at ${ Math.round( errors.theta[ column ] * 180 / Math.PI ) }°, azimuth 40°: lobe off by ${ ( 100 * errors.width[ row ][ column ] ).toFixed( 1 ) } % of its width, light by ${ ( 100 * errors.light[ row ][ column ] ).toFixed( 2 ) } %`;
	await map.scrollIntoViewIfNeeded();
	const { x, y, width, height } = await map.boundingBox();
	// The cell of column 30 and, from below, row 5.
	await page.mouse.move( x + width * 30.5 / 40, y + height * ( 1 - 5.5 / 40 ) );
	const hovered = [ await told.textContent(), wanted( 30, 5 ) ];
	await map.focus();
	await page.keyboard.press( 'ArrowUp' );
	await page.keyboard.press( 'ArrowLeft' );
	const keyed = [ await told.textContent(), wanted( 29, 6 ) ];
	// The brightest cell of the picture is that of the greatest error, the darkest that of the least.
	const bytes = await page.locator( '.map canvas' ).first().evaluate( ( canvas ) => [ ...canvas.getContext( '2d' ).getImageData( 0, 0, 40, 40 ).data ] );
	const flat = errors.width.flat();
	const shade = ( cell ) => bytes.slice( 4 * cell, 4 * cell + 3 ).reduce( ( a, b ) => a + b, 0 );
	const shades = Array.from( { length: 1600 }, ( _, cell ) => shade( cell ) );
	// Rows of a picture go down, those of the errors up.
	const at = ( error ) => ( 39 - Math.floor( flat.indexOf( error ) / 40 ) ) * 40 + flat.indexOf( error ) % 40;
	const isBrightest = shades[ at( Math.max( ...flat ) ) ] === Math.max( ...shades );
	const isDarkest = shades[ at( Math.min( ...flat ) ) ] === Math.min( ...shades );
	await page.locator( '#plot-ratio' ).fill( '1' );
	await told.filter( { hasText: /^alpha [0-9.]+, seen/ } ).waitFor();
	return { hovered, keyed, isBrightest, isDarkest, spread: Math.max( ...shades ) - Math.min( ...shades ) };

} );
