// A table's report in words, and its plots.

import { el, facts, section } from '../elements/dom.js';
import { degrees, number, percent } from '../elements/format.js';
import { isIsotropic } from '../elements/recipe.js';
import { load } from '../service/pictures.js';
import { errorMaps } from './errors.js';

/** The roughness of a surface, or both where they differ. */
export const roughness = ( x, y ) => x === y ? `alpha ${ number( x ) }` : `alpha ${ number( x ) }, ${ number( y ) }`;

/** The rows of the table of numbers: name, and the figure's name in a report. */
const ROWS = { 'lobe, in widths': 'width', 'lobe, SW1': 'sw1', light: 'light', amplitude: 'amplitude', 'Fresnel term': 'fresnel' };

/** The report in sentences and a table of numbers. */
export function inWords( { nodes, between, poor, matrices } ) {

	const [ worst ] = between.worst;
	const sentences = [
		`Between its nodes a lobe is off by ${ percent( between.width.mean ) } of its width on average; one in twenty by more than ${ percent( between.width.p95 ) }.`,
		`Light of square lights is off by ${ percent( between.light.mean, 2 ) } of the lobe’s energy on average, ${ percent( between.light.max ) } at worst.`,
		`The worst lobe is at ${ roughness( worst.alpha_x, worst.alpha_y ) }, seen at ${ degrees( worst.theta ) }: ${ percent( worst.width, 0 ) } of its width.`,
		poor.nodes && `At ${ poor.nodes } of the ${ nodes.points } measured nodes the model itself is off by more than ${ percent( poor.limit, 0 ) }: alpha ${ poor.alpha.map( number ).join( ' to ' ) }, views ${ poor.theta.map( degrees ).join( ' to ' ) }.`,
		matrices.singular && `${ matrices.singular } matrices have no inverse.`,
	];
	const both = [ nodes, between ];
	const cells = ( figures ) => [ 'mean', 'p95', 'max' ].map( ( of ) => el( 'td', { class: 'number' }, number( figures?.[ of ] ) ) );
	const figures = el( 'table', { class: 'figures' },
		el( 'thead', {},
			el( 'tr', {}, el( 'td' ), [ 'At nodes', 'Between nodes' ].map( ( name ) => el( 'th', { colspan: 3, scope: 'colgroup' }, name ) ) ),
			el( 'tr', {}, el( 'th', { scope: 'col' }, 'Error of' ), both.map( () => [ 'mean', '95 %', 'max' ].map( ( name ) => el( 'th', { scope: 'col', class: 'number' }, name ) ) ) ) ),
		el( 'tbody', {}, Object.entries( ROWS ).map( ( [ name, of ] ) => el( 'tr', {}, el( 'th', { scope: 'row' }, name ), both.map( ( where ) => cells( where[ of ] ) ) ) ) ) );
	return el( 'div', { class: 'halves' },
		el( 'div', {}, sentences.filter( Boolean ).map( ( sentence ) => el( 'p', {}, sentence ) ),
			facts( [ [ 'Condition of matrices', `${ number( matrices.condition.min ) } to ${ number( matrices.condition.max ) }` ], [ 'Turned over', matrices.negative_determinants ] ] ) ),
		el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Figures' }, figures ) );

}

/** A slider of a plot, over an axis of the recipe. */
function slider( axis, label, { range, nodes }, usual, onchange ) {

	const [ min, max ] = range?.[ axis ] ?? [ nodes[ axis ][ 0 ], nodes[ axis ].at( - 1 ) ];
	const [ id, value ] = [ `plot-${ axis }`, Math.min( max, Math.max( min, usual ) ) ];
	const output = el( 'output', { for: id }, number( value ) );
	const input = el( 'input', { type: 'range', id, min, max, step: 0.01, value, oninput: () => output.textContent = input.value, onchange } );
	return { input, row: el( 'div', { class: 'slider' }, el( 'label', { for: id }, label ), input, output ) };

}

/** The plots of errors and of the stored numbers, at a ratio and an azimuth where the table has several; asked for after `before`. */
export function plots( digest, recipe, before, signal ) {

	const errors = errorMaps( digest, signal );
	const numbers = el( 'img', { alt: 'Every stored number of the table, a tile for each ratio and azimuth' } );
	const isRound = isIsotropic( recipe );
	const ratio = slider( 'ratio', 'Ratio of roughnesses', recipe, 0.25, draw );
	const phi = slider( 'phi', 'Azimuth', recipe, 0.7, draw );
	function draw() {

		errors.show( isRound ? '' : `?ratio=${ ratio.input.value }&phi=${ phi.input.value }` );

	}

	before.then( () => {

		if ( signal.aborted ) return;
		draw();
		load( numbers, `/v1/tables/${ digest }/plots/matrix.png`, signal );

	} );
	return section( 'plots', 'Errors and numbers', isRound ? null : el( 'div', { class: 'sliders' }, ratio.row, phi.row ), el( 'div', { class: 'plots' }, errors.root, numbers ) );

}
