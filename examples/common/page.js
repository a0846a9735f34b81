// The page of an example: an engine's pictures next to the truth, each with its mean error. Parameters:
// ?width=96&height=64 sets the size of each picture in pixels, ?scale=2 the size of a shown pixel, ?lights=4 the number of
// lights.

import { meanError } from './pixels.js';
import { lightsOf } from './scene.js';

const query = new URLSearchParams( location.search );
export const width = Number( query.get( 'width' ) || 288 );
export const height = Number( query.get( 'height' ) || 216 );
const scale = Number( query.get( 'scale' ) || 1 );
export const lamps = lightsOf( Number( query.get( 'lights' ) || 1 ) );

const CAPTIONS = {
	table: 'a table of layout <code>reflected</code>',
	formula: 'LTC by a formula, without a table',
	fast: 'closed form, rule <code>fast</code>',
	balanced: 'closed form, rule <code>balanced</code>',
	fine: 'closed form, rule <code>fine</code>',
	truth: 'truth',
};

/** The factor that makes errors of linear radiance visible. */
const ERROR_SCALE = 10;

/** A canvas in sRGB from radiance, four numbers a pixel, from the top left. White is 1. */
function canvasOf( pixels ) {

	const canvas = Object.assign( document.createElement( 'canvas' ), { width, height } );
	Object.assign( canvas.style, { width: `${ width * scale }px`, height: `${ height * scale }px` } );
	const shown = new Uint8ClampedArray( pixels.length ).fill( 255 );
	for ( let i = 0; i < pixels.length; i ++ ) {

		if ( i % 4 === 3 ) continue;
		const x = Math.min( Math.max( pixels[ i ], 0 ), 1 );
		shown[ i ] = 255 * ( x <= 0.0031308 ? 12.92 * x : 1.055 * x ** ( 1 / 2.4 ) - 0.055 ) + 0.5;

	}

	canvas.getContext( '2d' ).putImageData( new ImageData( shown, width, height ), 0, 0 );
	return canvas;

}

/** Shows a picture with its caption below, and returns the caption. */
function show( caption, pixels ) {

	const figure = document.createElement( 'figure' );
	const figcaption = Object.assign( document.createElement( 'figcaption' ), { innerHTML: caption } );
	figure.append( canvasOf( pixels ), figcaption );
	document.querySelector( 'main' ).append( figure );
	return figcaption;

}

/**
 * Shows pictures, the truth, and each picture's error below it. A test reads the errors in `window.errors`.
 *
 * @param {string} engine - The name of the engine.
 * @param {Object<string, Float32Array>} pictures - Linear radiance, four numbers a pixel, from the top left, for `stock` and
 * the names in `CAPTIONS`.
 */
export async function compare( engine, pictures ) {

	const captions = { stock: `${ engine } unchanged: isotropic lobes`, ...CAPTIONS };
	const figcaptions = Object.fromEntries( Object.entries( pictures ).map( ( [ name, pixels ] ) => [ name, show( captions[ name ], pixels ) ] ) );
	const waiting = document.querySelector( 'main' ).appendChild( document.createElement( 'p' ) );
	waiting.textContent = 'The truth is being computed.';
	try {

		const response = await fetch( `/truth?width=${ width }&height=${ height }&lights=${ lamps.length }` );
		if ( ! response.ok ) throw new Error( await response.text() );
		const truth = new Float32Array( await response.arrayBuffer() );
		waiting.remove();
		show( captions.truth, truth );
		const errors = {};
		for ( const [ name, pixels ] of Object.entries( pictures ) ) {

			errors[ name ] = meanError( pixels, truth, width, height );
			const isLamp = ( i ) => truth[ 4 * Math.floor( i / 4 ) + 3 ] < 0;
			figcaptions[ name ].after( canvasOf( pixels.map( ( value, i ) => isLamp( i ) ? 0 : ERROR_SCALE * Math.abs( value - truth[ i ] ) ) ) );
			figcaptions[ name ].append( `; ${ ERROR_SCALE } x error; mean error ${ errors[ name ].toPrecision( 2 ) }` );

		}

		window.errors = errors;

	} catch ( error ) {

		waiting.textContent = `The truth is missing: ${ error.message }`;
		window.errors = { failed: error.message };

	}

}
