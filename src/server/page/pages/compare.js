// Two or three tables side by side: figures, with the best of each row, pictures and plots.

import { el, fill } from '../elements/dom.js';
import { bytes, isIsotropic, number, percent, short, title } from '../elements/format.js';
import { call, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

/** Most tables beside each other. */
const MOST = 3;

/** Figures of a table, of which less is better; the last part of each says how it is written. */
const FIGURES = [
	[ 'Error between nodes', ( { report } ) => report.between.width.mean, percent ],
	[ 'One lobe in twenty exceeds', ( { report } ) => report.between.width.p95, percent ],
	[ 'Largest error between nodes', ( { report } ) => report.between.width.max, percent ],
	[ 'Error of light, mean', ( { report } ) => report.between.light.mean, ( part ) => percent( part, 2 ) ],
	[ 'Error of light, largest', ( { report } ) => report.between.light.max, ( part ) => percent( part, 2 ) ],
	[ 'Error of amplitude, mean', ( { report } ) => report.between.amplitude?.mean, number ],
	[ 'Error at nodes', ( { report } ) => report.nodes.width.mean, percent ],
	[ 'Size', ( table ) => table.bytes, bytes ],
	[ 'Entries', ( table ) => table.entries, ( count ) => count.toLocaleString( 'en' ) ],
];

export async function show( root, rest, parameters, signal ) {

	const { items } = await call( '/v1/tables?limit=200', { signal } );
	const known = items.map( ( { digest } ) => digest );
	const asked = ( parameters.get( 'tables' ) || '' ).split( ',' ).filter( Boolean ).slice( 0, MOST );
	const digests = asked.length ? asked : known.slice( 0, 2 );
	const tables = await Promise.all( digests.map( manifest ) );
	const choices = Array.from( { length: Math.min( MOST, digests.length + 1 ) }, ( _, i ) => picker( i ) );
	const [ shown, added ] = [ choices.slice( 0, digests.length ), choices.slice( digests.length ) ];

	function picker( i ) {

		const options = [ ...new Set( [ ...digests, ...known ] ) ];
		const select = el( 'select', { 'aria-label': `Table ${ i + 1 }`, onchange: choose }, el( 'option', { value: '' }, i < digests.length ? 'remove' : 'add a table…' ),
			options.map( ( digest ) => el( 'option', { value: digest, selected: digest === digests[ i ] }, short( digest ) ) ) );
		return select;

	}

	function choose() {

		const chosen = [ ...new Set( choices.map( ( { value } ) => value ).filter( Boolean ) ) ];
		location.hash = chosen.length ? `#/compare?tables=${ chosen.join( ',' ) }` : '#/compare';

	}

	fill( root, el( 'div', { class: 'bar' }, el( 'h1', {}, 'Compare' ), el( 'span', { class: 'muted' }, 'the best of each row is marked' ), el( 'span', { class: 'grow' } ), known.length > digests.length ? added : null ) );
	if ( ! known.length ) {

		root.append( el( 'p', { class: 'empty' }, 'No table is stored yet. ', el( 'a', { href: '#/new' }, 'Submit a recipe' ), ' to make one.' ) );
		return null;

	}

	const later = [];
	const picture = ( from, alt, size ) => {

		const image = el( 'img', { alt, width: size } );
		later.push( [ image, from ] );
		return image;

	};

	const cells = ( tag, make ) => tables.map( ( table, i ) => el( tag, {}, make( table, i ) ) );
	const body = FIGURES.map( ( [ name, pick, write ] ) => {

		const values = tables.map( pick );
		const given = values.filter( ( value ) => value !== undefined );
		const best = given.length > 1 && Math.max( ...given ) > Math.min( ...given ) ? Math.min( ...given ) : null;
		return el( 'tr', {}, el( 'th', { scope: 'row' }, name ), values.map( ( value ) => el( 'td', { class: `number${ value === best ? ' best' : '' }` },
			value === best ? el( 'span', { class: 'hidden' }, 'best: ' ) : null, value === undefined ? '–' : write( value ) ) ) );

	} );
	const at = ( { recipe } ) => isIsotropic( recipe ) ? '' : '?ratio=0.25&phi=0.7';
	root.append( el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Comparison' }, el( 'table', { class: 'compare' },
		el( 'thead', {},
			el( 'tr', {}, el( 'th', { scope: 'col' }, 'Table' ), shown.map( ( select ) => el( 'th', { scope: 'col' }, select ) ) ),
			el( 'tr', {}, el( 'td' ), cells( 'td', ( table ) => el( 'a', { href: `#/tables/${ table.table }` }, title( table.recipe ) ) ) ) ),
		el( 'tbody', {}, body,
			el( 'tr', {}, el( 'th', { scope: 'row' }, 'Picture' ), cells( 'td', ( table, i ) => picture( previewOf( table.recipe, table.table, 512 ), `A sphere lit by table ${ i + 1 }`, 256 ) ) ),
			el( 'tr', {}, el( 'th', { scope: 'row' }, 'Errors' ), cells( 'td', ( table, i ) => picture( `/v1/tables/${ table.table }/plots/error.png${ at( table ) }`, `Errors of table ${ i + 1 }`, 320 ) ) ),
			el( 'tr', {}, el( 'th', { scope: 'row' }, 'Numbers' ), cells( 'td', ( table, i ) => picture( `/v1/tables/${ table.table }/plots/matrix.png`, `Stored numbers of table ${ i + 1 }`, 320 ) ) ) ) ) ) );
	later.forEach( ( [ image, from ] ) => load( image, from, signal ) );
	return () => {};

}
