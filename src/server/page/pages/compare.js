// Compares up to three tables: figures with the best value of each row marked, pictures and plots.

import { bar, el, fill } from '../elements/dom.js';
import { bytes, number, percent, whole } from '../elements/format.js';
import { domain, isIsotropic, isLookup, labelOf, nameOf, title } from '../elements/recipe.js';
import { firstTable } from '../report/first.js';
import { call, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

/** Maximum number of tables side by side. */
const MOST = 3;

/** Figures of a table: label, value and format. Smaller is better. */
const FIGURES = [
	[ 'Lobe error, mean', ( { report } ) => report.between.width.mean, percent ],
	[ 'Lobe error, 95th percentile', ( { report } ) => report.between.width.p95, percent ],
	[ 'Lobe error, largest', ( { report } ) => report.between.width.max, percent ],
	[ 'Light error, mean', ( { report } ) => report.between.light.mean, ( part ) => percent( part, 2 ) ],
	[ 'Light error, largest', ( { report } ) => report.between.light.max, ( part ) => percent( part, 2 ) ],
	[ 'Amplitude error, mean', ( { report } ) => report.between.amplitude?.mean, number ],
	[ 'Lobe error at nodes, mean', ( { report } ) => report.nodes.width.mean, percent ],
	[ 'Size', ( table ) => table.bytes, bytes ],
	[ 'Entries', ( table ) => table.entries, whole ],
];

/** Sizes are comparable for all tables. Errors are comparable for one scattering model, one reflectance and one range. */
const SIZES = [ 'Size', 'Entries' ];

/** A row of figures. The best value is marked. */
function figures( name, values, write, isComparable ) {
	const given = values.filter( ( value ) => value !== undefined );
	const best = isComparable && Math.max( ...given ) > Math.min( ...given ) ? Math.min( ...given ) : null;
	return el( 'tr', {}, el( 'th', { scope: 'row' }, name ), values.map( ( value ) => el( 'td', { class: `number${ value === best ? ' best' : '' }` },
		value === best ? el( 'span', { class: 'hidden' }, 'best: ' ) : null, value === undefined ? '–' : write( value ) ) ) );
}

export async function show( root, rest, parameters, signal ) {
	const { items } = await call( '/v1/tables?limit=200', { signal } );
	const known = items.filter( ( { recipe } ) => recipe && ! isLookup( recipe ) ).map( ( { digest } ) => digest );
	const asked = ( parameters.get( 'tables' ) || '' ).split( ',' ).filter( Boolean ).slice( 0, MOST );
	const digests = asked.length ? asked : known.slice( 0, 2 );
	const tables = await Promise.all( digests.map( manifest ) );
	if ( tables.some( ( { recipe } ) => isLookup( recipe ) ) ) throw new Error( 'this page compares tables that light surfaces; open the page of a lookup table to see its errors' );
	const recipes = new Map( [ ...items.map( ( { digest, recipe } ) => [ digest, recipe ] ), ...tables.map( ( { table, recipe } ) => [ table, recipe ] ) ] );
	const options = [ ...new Set( [ ...digests, ...known ] ) ];
	const choices = Array.from( { length: Math.min( MOST, digests.length + 1 ) }, ( _, i ) => el( 'select', { 'aria-label': `Table ${ i + 1 }`, onchange: choose },
		el( 'option', { value: '' }, i < digests.length ? 'remove' : 'add a table…' ),
		options.map( ( digest ) => el( 'option', { value: digest, selected: digest === digests[ i ] }, nameOf( { digest, recipe: recipes.get( digest ) } ) ) ) ) );

	function choose() {
		const chosen = [ ...new Set( choices.map( ( { value } ) => value ).filter( Boolean ) ) ];
		location.hash = chosen.length ? `#/compare?tables=${ chosen.join( ',' ) }` : '#/compare';
	}
	const isOneDomain = new Set( tables.map( ( { recipe } ) => domain( recipe ) ) ).size < 2;
	const added = known.length > digests.length ? choices.slice( digests.length ) : null;
	fill( root, bar( 'Compare', el( 'span', { class: 'muted' }, tables.length < 2 ? 'choose two or three tables' : isOneDomain ? 'the best value of each row is marked' : 'errors are not comparable: the tables are for different scattering models, reflectances or ranges' ), added ) );
	if ( ! known.length ) {
		root.append( firstTable( signal ) );
		return null;
	}
	// All pictures show one surface, which every table covers.
	const isRound = tables.some( ( { recipe } ) => isIsotropic( recipe ) );
	const loads = [];
	const pictures = ( name, caption, width, path ) => el( 'tr', {}, el( 'th', { scope: 'row' }, name ), tables.map( ( table, i ) => {
		const image = el( 'img', { alt: `${ caption } table ${ i + 1 }`, width } );
		loads.push( [ image, path( table ) ] );
		return el( 'td', {}, image );
	} ) );
	const plot = ( { table }, file ) => `/v1/tables/${ table }/plots/${ file }`;
	root.append( el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Comparison' }, el( 'table', { class: 'compare' },
		el( 'thead', {},
			el( 'tr', {}, el( 'th', { scope: 'col' }, 'Table' ), digests.map( ( _, i ) => el( 'th', { scope: 'col' }, choices[ i ] ) ) ),
			el( 'tr', {}, el( 'td' ), tables.map( ( { table, recipe } ) => el( 'td', {}, el( 'a', { href: `#/tables/${ table }` }, labelOf( table ) || title( recipe ) ) ) ) ) ),
		el( 'tbody', {}, FIGURES.map( ( [ name, pick, write ] ) => figures( name, tables.map( pick ), ( value ) => write( value ), isOneDomain || SIZES.includes( name ) ) ),
			pictures( isRound ? 'Sphere, alpha 0.2' : 'Sphere, alpha 0.5, 0.1', 'A sphere lit by', 256, ( { recipe, table } ) => previewOf( isRound ? { ...recipe, range: { ratio: [ 1 ] } } : recipe, table, 512 ) ),
			pictures( 'Errors', 'Errors of', 320, ( table ) => plot( table, `error.png${ isIsotropic( table.recipe ) ? '' : '?ratio=0.25&phi=0.7' }` ) ),
			pictures( 'Numbers', 'Stored numbers of', 320, ( table ) => plot( table, 'matrix.png' ) ) ) ) ) );
	loads.forEach( ( [ image, from ] ) => load( image, from, signal ) );
	return () => {};
}
