// Two error maps of a table over view angle and roughness. The page shows the errors of the selected cell as text.

import { el, fill, notice, svg } from '../elements/dom.js';
import { degrees, number, percent } from '../elements/format.js';
import { call } from '../service/api.js';

/** Errors at both ends of the logarithmic colour scale. */
const ENDS = [ 1e-3, 1 ];
const MAPS = { width: 'Lobe error, % of the lobe’s width', light: 'Light error, % of the lobe’s energy' };

/** Columns and rows by which an arrow key moves the selection. Alpha increases upwards. */
const KEYS = { ArrowLeft: [ - 1, 0 ], ArrowRight: [ 1, 0 ], ArrowUp: [ 0, 1 ], ArrowDown: [ 0, - 1 ] };
const clamped = ( x, most = 1 ) => Math.min( most, Math.max( 0, x ) );

/** A row of texts. An empty text becomes the colour ramp. */
const row = ( kind, ...parts ) => el( 'div', { class: `${ kind } muted` }, parts.map( ( part ) => el( 'span', part === '' ? { class: 'ramp' } : {}, part ) ) );

/** Linear colours of the scale at equal steps, from black to pale yellow. They are the same as in `view::picture`. */
const STOPS = [ [ 0, 0, 0.004 ], [ 0.1, 0.004, 0.2 ], [ 0.5, 0.038, 0.12 ], [ 0.95, 0.26, 0.012 ], [ 0.98, 0.97, 0.45 ] ];

/** The sRGB bytes of an error's colour. */
function colour( error ) {
	const place = 4 * clamped( Math.log( Math.max( error, ENDS[ 0 ] ) / ENDS[ 0 ] ) / Math.log( ENDS[ 1 ] / ENDS[ 0 ] ) );
	const lower = Math.min( Math.floor( place ), 3 );
	return STOPS[ lower ].map( ( c, i ) => {
		const linear = c + ( STOPS[ lower + 1 ][ i ] - c ) * ( place - lower );
		return Math.round( 255 * ( linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** ( 1 / 2.4 ) - 0.055 ) );
	} );
}

/** A canvas with a pixel per cell. The first row is at the bottom. */
function heatMap( errors, count ) {
	const canvas = el( 'canvas', { width: count, height: count } );
	const image = new ImageData( count, count );
	errors.forEach( ( row, r ) => row.forEach( ( error, c ) => image.data.set( [ ...colour( error ), 255 ], 4 * ( ( count - 1 - r ) * count + c ) ) ) );
	canvas.getContext( '2d' ).putImageData( image, 0, 0 );
	return canvas;
}

/** The error maps of a table. `show` requests them for a ratio and an azimuth. */
export function errorMaps( digest, signal ) {
	const output = el( 'output', { class: 'cell-errors', 'aria-live': 'polite' } );
	const figures = el( 'div', { class: 'maps' } );
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

	function draw( { alpha, theta, ratio, phi, ...errors } ) {
		const count = alpha.length;
		const last = count - 1;
		const marks = Object.keys( MAPS ).map( () => svg( 'rect', { width: 1, height: 1 } ) );

		function select( cell ) {
			at = cell.map( ( x ) => clamped( x, last ) );
			const [ c, r ] = at;
			for ( const mark of marks ) {
				mark.setAttribute( 'x', c );
				mark.setAttribute( 'y', last - r );
			}
			const roughness = [ alpha[ r ], ...( ratio === 1 ? [] : [ ratio * alpha[ r ] ] ) ].map( number ).join( ', ' );
			const view = `view angle ${ degrees( theta[ c ] ) }${ ratio === 1 ? '' : `, azimuth ${ degrees( phi ) }` }`;
			output.textContent = `alpha ${ roughness }, ${ view }: lobe error ${ percent( errors.width[ r ][ c ] ) } of the lobe’s width, light error ${ percent( errors.light[ r ][ c ], 2 ) } of the lobe’s energy`;
		}

		function point( { currentTarget, clientX, clientY } ) {
			const { left, bottom, width, height } = currentTarget.getBoundingClientRect();
			select( [ Math.floor( ( clientX - left ) / width * count ), Math.floor( ( bottom - clientY ) / height * count ) ] );
		}

		function step( event ) {
			const way = KEYS[ event.key ];
			if ( ! way ) return;
			event.preventDefault();
			select( [ at[ 0 ] + way[ 0 ], at[ 1 ] + way[ 1 ] ] );
		}
		fill( figures, Object.entries( MAPS ).map( ( [ of, title ], i ) => el( 'figure', {}, el( 'figcaption', {}, title ), row( 'ends', `alpha ${ number( alpha[ last ] ) }` ),
			el( 'div', {
				class: 'map', tabindex: 0, role: 'application', 'aria-roledescription': 'map', onpointermove: point, onkeydown: step,
				'aria-label': `${ title }, over view angle and roughness; arrow keys select a cell`,
			}, heatMap( errors[ of ], count ), svg( 'svg', { viewBox: `0 0 ${ count } ${ count }`, 'aria-hidden': 'true' }, marks[ i ] ) ),
			row( 'ends', `alpha ${ number( alpha[ 0 ] ) }, ${ degrees( theta[ 0 ] ) }`, degrees( theta[ last ] ) ) ) ),
		row( 'scale', '0.1 %', '', '100 %' ) );
		select( at ?? [ Math.floor( count / 2 ), Math.floor( count / 2 ) ] );
	}
	return { root: el( 'div', {}, figures, output ), show };
}
