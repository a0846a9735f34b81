// A table's report in words, and its plots.

import { el, facts } from '../elements/dom.js';
import { isIsotropic, number, percent } from '../elements/format.js';
import { load } from '../service/pictures.js';
import { errorMaps } from './errors.js';

const degrees = ( radians ) => `${ ( radians * 180 / Math.PI ).toFixed( 0 ) }°`;
const alphas = ( { alpha_x, alpha_y } ) => alpha_x === alpha_y ? `alpha ${ number( alpha_x ) }` : `alpha ${ number( alpha_x ) }, ${ number( alpha_y ) }`;

/** The report in sentences and a table of numbers. */
export function inWords( { nodes, between, poor, matrices } ) {

	const [ worst ] = between.worst;
	const sentences = [
		`Between its nodes a lobe is off by ${ percent( between.width.mean ) } of its width on average; one in twenty by more than ${ percent( between.width.p95 ) }.`,
		`Light of square lights is off by ${ percent( between.light.mean, 2 ) } of the lobe’s energy on average, ${ percent( between.light.max ) } at worst.`,
		`The worst lobe is at ${ alphas( worst ) }, seen at ${ degrees( worst.theta ) }: ${ percent( worst.width, 0 ) } of its width.`,
		poor.nodes ? `At ${ poor.nodes } of the ${ nodes.points } measured nodes the model itself is off by more than ${ percent( poor.limit, 0 ) }: alpha ${ poor.alpha.map( number ).join( ' to ' ) }, views ${ poor.theta.map( degrees ).join( ' to ' ) }.` : '',
		matrices.singular ? `${ matrices.singular } matrices have no inverse.` : '',
	];
	const spread = ( name, pick ) => el( 'tr', {}, el( 'th', { scope: 'row' }, name ), [ nodes, between ].map( ( where ) => {

		const { mean, p95, max } = pick( where ) || {};
		return [ mean, p95, max ].map( ( value ) => el( 'td', { class: 'number' }, number( value ) ) );

	} ) );
	const figures = el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Figures' }, el( 'table', { class: 'figures' },
		el( 'thead', {},
			el( 'tr', {}, el( 'td' ), el( 'th', { colspan: 3, scope: 'colgroup' }, 'At nodes' ), el( 'th', { colspan: 3, scope: 'colgroup' }, 'Between nodes' ) ),
			el( 'tr', {}, el( 'th', { scope: 'col' }, 'Error of' ), [ 0, 1 ].map( () => [ 'mean', '95 %', 'max' ].map( ( name ) => el( 'th', { scope: 'col', class: 'number' }, name ) ) ) ) ),
		el( 'tbody', {},
			spread( 'lobe, in widths', ( { width } ) => width ), spread( 'lobe, SW1', ( { sw1 } ) => sw1 ), spread( 'light', ( { light } ) => light ),
			spread( 'amplitude', ( { amplitude } ) => amplitude ), spread( 'Fresnel term', ( { fresnel } ) => fresnel ) ) ) );
	return el( 'div', { class: 'halves' },
		el( 'div', {}, sentences.filter( Boolean ).map( ( sentence ) => el( 'p', {}, sentence ) ),
			facts( [ [ 'Condition of matrices', `${ number( matrices.condition.min ) } to ${ number( matrices.condition.max ) }` ], [ 'Turned over', matrices.negative_determinants ] ] ) ),
		figures );

}

/** From the first node of an axis to the last. */
function extent( { range, nodes }, axis ) {

	return range?.[ axis ] ?? [ nodes[ axis ][ 0 ], nodes[ axis ].at( - 1 ) ];

}

/** A slider of a plot. */
function slider( id, label, [ min, max ], usual, oninput ) {

	const value = Math.min( max, Math.max( min, usual ) );

	const output = el( 'output', { for: id }, number( value ) );
	const input = el( 'input', { type: 'range', id, min, max, step: 0.01, value, oninput: () => output.textContent = input.value, onchange: oninput } );
	return { input, row: el( 'div', { class: 'slider' }, el( 'label', { for: id }, label ), input, output ) };

}

/** The plots of errors and of the stored numbers, at a ratio and an azimuth where the table has several; asked for after `before`. */
export function plots( digest, recipe, before, signal ) {

	const errors = errorMaps( digest, signal );
	const numbers = el( 'img', { alt: 'Every stored number of the table, a tile for each ratio and azimuth' } );
	const ratio = slider( 'plot-ratio', 'Ratio of roughnesses', extent( recipe, 'ratio' ), 0.25, draw );
	const phi = slider( 'plot-phi', 'Azimuth', extent( recipe, 'phi' ), 0.7, draw );
	function draw() {

		errors.show( isIsotropic( recipe ) ? '' : `?ratio=${ ratio.input.value }&phi=${ phi.input.value }` );

	}

	before.then( () => {

		if ( signal.aborted ) return;
		draw();
		load( numbers, `/v1/tables/${ digest }/plots/matrix.png`, signal );

	} );
	return el( 'section', { 'aria-labelledby': 'plots' }, el( 'h2', { id: 'plots' }, 'Errors and numbers' ),
		isIsotropic( recipe ) ? null : el( 'div', { class: 'sliders' }, ratio.row, phi.row ),
		el( 'div', { class: 'plots' }, errors.root, numbers ) );

}
