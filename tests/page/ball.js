// Tests the shader ball of the viewer: its triangles, its light compared with the reference, and its link.

import { withWorld } from './world.js';

await withWorld( async ( { open } ) => {

	const page = await open( 'viewer?size=512&glow=off' );
	const geometry = await page.evaluate( async () => {

		const { shaderBall } = await import( './page/viewer/shader_ball.js' );
		const numbers = shaderBall();
		const three = ( at ) => [ ...numbers.subarray( at, at + 3 ) ];
		const dot = ( a, b ) => a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];
		const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];
		const found = { radius: 0, cosine: 1, skew: 0, length: 0 };
		for ( let i = 0; i < numbers.length; i += 30 ) {

			const [ a, b, c ] = [ i, i + 10, i + 20 ].map( three );
			const flat = cross( b.map( ( x, axis ) => x - a[ axis ] ), c.map( ( x, axis ) => x - a[ axis ] ) );
			for ( const corner of [ i, i + 10, i + 20 ] ) {

				const [ place, normal, tangent ] = [ corner, corner + 3, corner + 6 ].map( three );
				found.radius = Math.max( found.radius, Math.hypot( ...place ) );
				// Triangles at a pole are degenerate.
				if ( Math.hypot( ...flat ) > 1e-9 ) found.cosine = Math.min( found.cosine, dot( flat, normal ) / Math.hypot( ...flat ) );
				found.skew = Math.max( found.skew, Math.abs( dot( normal, tangent ) ) );
				found.length = Math.max( found.length, Math.abs( Math.hypot( ...normal ) - 1 ), Math.abs( Math.hypot( ...tangent ) - 1 ) );

			}

		}

		return found;

	} );

	/** The red bytes of the image. */
	const bytes = () => page.evaluate( () => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		return [ ...context.getImageData( 0, 0, canvas.width, canvas.height ).data ].filter( ( _, i ) => i % 4 === 0 );

	} );
	/** The sum of all bytes that differ from the background. */
	const lit = ( bytes ) => bytes.reduce( ( sum, byte ) => sum + ( byte === bytes[ 0 ] ? 0 : byte ), 0 );
	await page.locator( '#view-surface' ).selectOption( 'shader_ball' );
	await page.locator( '#view-show' ).selectOption( 'model' );
	const linked = await page.evaluate( () => location.hash.includes( 'surface=shader_ball' ) );
	await page.reload();
	await page.locator( '.page-viewer .facts' ).waitFor();
	const kept = await page.locator( '#view-surface' ).inputValue();
	const sampled = () => page.waitForFunction( () => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= 512 );
	await sampled();
	const ours = await bytes();
	await page.locator( '#view-show' ).selectOption( 'reference' );
	await sampled();
	const reference = await bytes();
	// The ball, the foot, the background next to the neck, and a corner of the image.
	const places = [ [ 215, 190 ], [ 256, 345 ], [ 316, 310 ], [ 500, 500 ] ].map( ( [ x, y ] ) => ours[ 512 * y + x ] );
	return { ...geometry, linked, kept, places, ratio: lit( ours ) / lit( reference ) };

} );
