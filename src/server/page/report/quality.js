// The report of a table in words, and its plots.

import { el, facts, section } from '../elements/dom.js';
import { degrees, number, percent } from '../elements/format.js';
import { isIsotropic } from '../elements/recipe.js';
import { load } from '../service/pictures.js';
import { errorMaps } from './errors.js';

/** The roughness of a surface: one alpha, or two if they differ. */
export const roughness = ( x, y ) => x === y ? `alpha ${ number( x ) }` : `alpha ${ number( x ) }, ${ number( y ) }`;

/** The rows of the table of figures: name in the report, label, and format. */
const ROWS = [
	[ 'width', 'lobe, of its width', percent ],
	[ 'light', 'light, of the lobe’s energy', ( part ) => percent( part, 2 ) ],
	[ 'sw1', 'lobe, sliced Wasserstein', number ],
	[ 'amplitude', 'amplitude', number ],
	[ 'fresnel', 'Fresnel term', number ],
];

/** The report as sentences and a table of figures. */
export function inWords( { nodes, between, poor, matrices } ) {
	const [ worst ] = between.worst;
	const sentences = [
		`Between nodes, the mean lobe error is ${ percent( between.width.mean ) } of the lobe’s width. One lobe in twenty has an error above ${ percent( between.width.p95 ) }.`,
		`For square lights, the mean light error is ${ percent( between.light.mean, 2 ) } of the lobe’s energy. The largest light error is ${ percent( between.light.max ) }.`,
		`The worst lobe (${ roughness( worst.alpha_x, worst.alpha_y ) }, view angle ${ degrees( worst.theta ) }) has an error of ${ percent( worst.width, 0 ) } of its width.`,
		poor.nodes && `At ${ poor.nodes } of ${ nodes.points } measured nodes, even the best lobe has an error above ${ percent( poor.limit, 0 ) }: alpha ${ poor.alpha.map( number ).join( ' to ' ) }, view angle ${ poor.theta.map( degrees ).join( ' to ' ) }. More nodes do not help there.`,
		matrices.singular && `${ matrices.singular } matrices have no inverse.`,
	];
	const both = [ nodes, between ];
	const cells = ( figures, write ) => [ 'mean', 'p95', 'max' ].map( ( of ) => el( 'td', { class: 'number' }, figures ? write( figures[ of ] ) : '–' ) );
	const figures = el( 'table', { class: 'figures' },
		el( 'thead', {},
			el( 'tr', {}, el( 'td' ), [ 'At nodes', 'Between nodes' ].map( ( name ) => el( 'th', { colspan: 3, scope: 'colgroup' }, name ) ) ),
			el( 'tr', {}, el( 'th', { scope: 'col' }, 'Error of' ), both.map( () => [ 'mean', '95 %', 'max' ].map( ( name ) => el( 'th', { scope: 'col', class: 'number' }, name ) ) ) ) ),
		el( 'tbody', {}, ROWS.map( ( [ of, name, write ] ) => el( 'tr', {}, el( 'th', { scope: 'row' }, name ), both.map( ( where ) => cells( where[ of ], write ) ) ) ) ) );
	return el( 'div', { class: 'halves' },
		el( 'div', {}, sentences.filter( Boolean ).map( ( sentence ) => el( 'p', {}, sentence ) ),
			facts( [ [ 'Condition number of matrices', `${ number( matrices.condition.min ) } to ${ number( matrices.condition.max ) }` ], [ 'Negative determinants', matrices.negative_determinants ] ] ) ),
		el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Figures' }, figures ) );
}

/** The report of a lookup table: errors of its values after linear filtering, by number format. */
export function lookupInWords( { stored, sampled, formats } ) {
	const row = ( name, errors ) => el( 'tr', {}, el( 'th', { scope: 'row' }, name ), [ errors.mean, errors.p95, errors.max ].map( ( error ) => el( 'td', { class: 'number' }, number( error ) ) ) );
	return el( 'div', { class: 'halves' },
		el( 'div', {}, el( 'p', {}, `After linear filtering, the mean error of a value is ${ number( stored.mean ) }. One value in twenty has an error above ${ number( stored.p95 ) }. The largest error is ${ number( stored.max ) }.` ),
			el( 'p', {}, `A table of exact values at the centres of the texels has a mean error of ${ number( sampled.mean ) } and a largest error of ${ number( sampled.max ) }.` ) ),
		el( 'table', { class: 'figures' },
			el( 'thead', {}, el( 'tr', {}, el( 'th', { scope: 'col' }, 'Error of a value in' ), [ 'mean', '95 %', 'max' ].map( ( name ) => el( 'th', { scope: 'col', class: 'number' }, name ) ) ) ),
			el( 'tbody', {}, formats.map( ( [ name, errors ] ) => row( name, errors ) ) ) ) );
}

/** A slider over an axis of the recipe. */
function slider( axis, label, { range, nodes }, usual, onchange ) {
	const [ min, max ] = range?.[ axis ] ?? [ nodes[ axis ][ 0 ], nodes[ axis ].at( - 1 ) ];
	const [ id, value ] = [ `plot-${ axis }`, Math.min( max, Math.max( min, usual ) ) ];
	const output = el( 'output', { for: id }, number( value ) );
	const input = el( 'input', { type: 'range', id, min, max, step: 0.01, value, oninput: () => output.textContent = input.value, onchange } );
	return { input, row: el( 'div', { class: 'slider' }, el( 'label', { for: id }, label ), input, output ) };
}

/** The section with the error maps and the stored numbers. Tables of anisotropic surfaces have sliders for ratio and azimuth. Requests start after the promise `before`. */
export function plots( digest, recipe, before, signal ) {
	const errors = errorMaps( digest, signal );
	const numbers = el( 'img', { alt: 'All stored numbers of the table. There is a tile for each ratio and azimuth.' } );
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
