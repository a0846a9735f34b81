// The errors of a table over view angle and roughness: two maps, of which the cell under the pointer or the keys is told.

import { el, fill, notice } from '../elements/dom.js';
import { number, percent } from '../elements/format.js';
import { call } from '../service/api.js';

/** Errors at the ends of the colours, which are even in the logarithm. */
const ENDS = [ 1e-3, 1 ];
const MAPS = { width: 'Lobe, % of its width', light: 'Light, % of the lobe' };
/** Cells that an arrow key goes by, in columns and rows; rows go up with alpha. */
const KEYS = { ArrowLeft: [ - 1, 0 ], ArrowRight: [ 1, 0 ], ArrowUp: [ 0, 1 ], ArrowDown: [ 0, - 1 ] };

const degrees = ( theta ) => Math.round( theta * 180 / Math.PI );
const clamped = ( x ) => Math.min( 1, Math.max( 0, x ) );

/** Black, purple, orange, pale yellow: linear colours at even steps, those of `view::picture`. */
const STOPS = [ [ 0, 0, 0.004 ], [ 0.1, 0.004, 0.2 ], [ 0.5, 0.038, 0.12 ], [ 0.95, 0.26, 0.012 ], [ 0.98, 0.97, 0.45 ] ];

/** The colour of an error in bytes of sRGB. */
function colour( error ) {

	const place = 4 * clamped( Math.log( Math.max( error, ENDS[ 0 ] ) / ENDS[ 0 ] ) / Math.log( ENDS[ 1 ] / ENDS[ 0 ] ) );
	const lower = Math.min( Math.floor( place ), 3 );
	return STOPS[ lower ].map( ( c, i ) => {

		const linear = c + ( STOPS[ lower + 1 ][ i ] - c ) * ( place - lower );
		return Math.round( 255 * ( linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** ( 1 / 2.4 ) - 0.055 ) );

	} );

}

/** The maps of a table; `show` measures them anew at a ratio and an azimuth. */
export function errorMaps( digest, signal ) {

	const output = el( 'output', { class: 'told', 'aria-live': 'polite' } );
	const figures = el( 'div', { class: 'maps' } );
	const root = el( 'div', {}, figures, output );
	let at = null;
	let asked = 0;

	async function show( query ) {

		const turn = ++ asked;
		fill( output, 'Measuring…' );
		try {

			const errors = await call( `/v1/tables/${ digest }/plots/error.json${ query }`, { signal } );
			if ( turn === asked ) draw( errors );

		} catch ( error ) {

			if ( ! signal.aborted && turn === asked ) fill( output, notice( error.message ) );

		}

	}

	function draw( errors ) {

		const { alpha, theta, ratio, phi } = errors;
		const count = alpha.length;
		at ??= [ Math.floor( count / 2 ), Math.floor( count / 2 ) ];
		const marks = [];

		function tell( [ column, row ] ) {

			at = [ column, row ].map( ( x ) => Math.min( count - 1, Math.max( 0, x ) ) );
			const [ c, r ] = at;
			for ( const mark of marks ) {

				mark.setAttribute( 'x', c );
				mark.setAttribute( 'y', count - 1 - r );

			}

			const roughness = ratio === 1 ? `alpha ${ number( alpha[ r ] ) }` : `alpha ${ number( alpha[ r ] ) }, ${ number( ratio * alpha[ r ] ) }`;
			output.textContent = `${ roughness }, seen at ${ degrees( theta[ c ] ) }°${ ratio === 1 ? '' : `, azimuth ${ degrees( phi ) }°` }: lobe off by ${ percent( errors.width[ r ][ c ] ) } of its width, light by ${ percent( errors.light[ r ][ c ], 2 ) }`;

		}

		fill( figures, Object.entries( MAPS ).map( ( [ of, title ] ) => {

			const canvas = el( 'canvas', { width: count, height: count } );
			const context = canvas.getContext( '2d' );
			const image = context.createImageData( count, count );
			errors[ of ].forEach( ( row, r ) => row.forEach( ( error, c ) => image.data.set( [ ...colour( error ), 255 ], 4 * ( ( count - 1 - r ) * count + c ) ) ) );
			context.putImageData( image, 0, 0 );
			const over = document.createElementNS( 'http://www.w3.org/2000/svg', 'svg' );
			over.setAttribute( 'viewBox', `0 0 ${ count } ${ count }` );
			over.setAttribute( 'aria-hidden', 'true' );
			const mark = over.appendChild( document.createElementNS( over.namespaceURI, 'rect' ) );
			mark.setAttribute( 'width', 1 );
			mark.setAttribute( 'height', 1 );
			marks.push( mark );
			const map = el( 'div', {
				class: 'map', tabindex: 0, role: 'application', 'aria-roledescription': 'map', 'aria-label': `${ title }, over view angle and roughness; arrow keys choose a cell`,
				onpointermove: ( event ) => {

					const { left, top, width, height } = map.getBoundingClientRect();
					tell( [ Math.floor( ( event.clientX - left ) / width * count ), count - 1 - Math.floor( ( event.clientY - top ) / height * count ) ] );

				},
				onkeydown: ( event ) => {

					const way = KEYS[ event.key ];
					if ( ! way ) return;
					event.preventDefault();
					tell( [ at[ 0 ] + way[ 0 ], at[ 1 ] + way[ 1 ] ] );

				},
			}, canvas, over );
			const ends = ( ...texts ) => el( 'div', { class: 'ends muted' }, texts.map( ( text ) => el( 'span', {}, text ) ) );
			return el( 'figure', {}, el( 'figcaption', {}, title ), ends( `alpha ${ number( alpha[ count - 1 ] ) }` ), map,
				ends( `alpha ${ number( alpha[ 0 ] ) }, ${ degrees( theta[ 0 ] ) }°`, `${ degrees( theta[ count - 1 ] ) }°` ) );

		} ), el( 'div', { class: 'scale muted' }, el( 'span', {}, '0.1 %' ), el( 'span', { class: 'ramp' } ), el( 'span', {}, '100 %' ) ) );
		tell( at );

	}

	return { root, show };

}
