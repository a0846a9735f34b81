// The list of tables: search, sort, and select tables to compare.

import { bar, button, el, fill, muted } from '../elements/dom.js';
import { age, bytes, percent, short } from '../elements/format.js';
import { domain, isLookup, labelOf, wholeTitle } from '../elements/recipe.js';
import { call } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';
import { firstTable } from '../report/first.js';

/** Number of tables per page of the list. */
const PAGE = 200;

/** Milliseconds between two requests for the list. */
const AGAIN = 5000;

/** Pixels per side of a picture, enough for screens with double pixel density. */
const PICTURE = 96;

/** The columns: name, value to sort by, and tooltip. */
const COLUMNS = [
	[ 'Table', ( row ) => row.title ],
	[ 'Lobe error', ( row ) => row.error, 'Mean error of a lobe between nodes, relative to the width of the lobe' ],
	[ 'Light error', ( row ) => row.light, 'Mean error of the reflected light of square lights, relative to the energy of the lobe' ],
	[ 'Size', ( row ) => row.bytes ],
	[ 'Age', ( row ) => - Date.parse( row.created_at ) ],
];

/** Columns with errors, which are comparable only for the same surfaces. */
const ERRORS = [ 1, 2 ];

const hidden = ( text, tag = 'span' ) => el( tag, { class: 'hidden' }, text );

export async function show( root, rest, parameters, signal ) {
	const rows = new Map();
	const chosen = new Set();
	let order = { column: 4, sign: 1 };
	let next = null;
	const search = el( 'input', { type: 'search', id: 'search', placeholder: 'ggx, ltc2017, f16, 1f0c…', oninput: draw } );
	const count = el( 'span', { class: 'muted', role: 'status' } );
	const compare = button( '#/compare', 'Compare' );
	compare.hidden = true;
	const body = el( 'tbody' );
	const more = el( 'button', { type: 'button', hidden: true, onclick: older }, 'Older tables' );
	const headings = COLUMNS.map( ( [ name, , title ], column ) => el( 'th', { scope: 'col', class: column ? 'number' : null }, el( 'button', { type: 'button', class: 'sort', title, onclick: () => sort( column ) }, name ) ) );
	const outer = [ [ 'picture', 'Picture' ], [ 'choose', 'Compare' ] ].map( ( [ name, text ] ) => el( 'th', { scope: 'col', class: name }, hidden( text ) ) );
	const list = el( 'table', { class: 'list' }, hidden( 'Tables', 'caption' ), el( 'thead', {}, el( 'tr', {}, outer[ 0 ], headings, outer[ 1 ] ) ), body );
	const pictures = muted( 'Pictures: a silver sphere under a rectangle, with alpha 0.5 and 0.1, or 0.2 for isotropic tables.' );
	fill( root, bar( 'Tables', count, el( 'label', { for: 'search', class: 'hidden' }, 'Search' ), search, compare ), list, pictures, more );
	let empty = null;

	function sort( column ) {
		order = { column, sign: order.column === column ? - order.sign : 1 };
		draw();
	}

	function add( item ) {
		if ( rows.has( item.digest ) ) return;
		const [ digits, label, title ] = [ short( item.digest ), labelOf( item.digest ), item.recipe ? wholeTitle( item.recipe ) : 'table' ];
		const isLit = item.recipe && ! isLookup( item.recipe );
		const name = label || title;
		const link = el( 'a', { href: `#/tables/${ item.digest }` }, name );
		const picture = isLit && el( 'img', { alt: '', width: 48, height: 48 } );
		const cell = ( column, ...content ) => el( 'td', { class: 'number', 'data-name': column }, content );
		const choose = isLit && el( 'input', { type: 'checkbox', 'aria-label': `Compare ${ digits }: ${ name }`, onchange: () => pick( item.digest, choose.checked ) } );
		const row = el( 'tr', {}, el( 'td', { class: 'picture' }, picture ), el( 'th', { scope: 'row' }, link, el( 'span', { class: 'muted' }, label && `${ title } · `, el( 'code', {}, digits ) ) ),
			cell( 'Lobe error', item.errors ? percent( item.errors.width ) : '–' ), cell( 'Light error', item.errors ? percent( item.errors.light, 2 ) : '–' ),
			cell( 'Size', bytes( item.bytes ) ),
			cell( 'Age', el( 'time', { datetime: item.created_at, title: new Date( item.created_at ).toLocaleString() }, age( item.created_at ) ) ),
			el( 'td', { class: 'choose' }, choose ) );
		// Tables without errors are sorted after all others.
		rows.set( item.digest, { ...item, row, title: `${ label } ${ title }`.trim(), domain: item.errors && domain( item.recipe ), error: item.errors?.width ?? Infinity, light: item.errors?.light ?? Infinity } );
		if ( isLit ) load( picture, previewOf( item.recipe, item.digest, PICTURE ), signal );
	}

	function pick( digest, isChosen ) {
		if ( isChosen ) chosen.add( digest );
		else chosen.delete( digest );
		compare.hidden = chosen.size < 2;
		compare.href = `#/compare?tables=${ [ ...chosen ].slice( 0, 3 ).join( ',' ) }`;
		compare.textContent = chosen.size > 3 ? 'Compare the first three' : `Compare ${ chosen.size }`;
	}

	function draw() {
		const words = search.value.toLowerCase().split( /\s+/ ).filter( Boolean );
		const [ , key ] = COLUMNS[ order.column ];
		const found = [ ...rows.values() ].filter( ( { title, digest, recipe_digest } ) => words.every( ( word ) => `${ title } ${ digest } ${ recipe_digest }`.toLowerCase().includes( word ) ) );
		for ( const { row, created_at: created } of found ) row.querySelector( 'time' ).textContent = age( created );
		found.sort( ( a, b ) => order.sign * ( ( key( a ) > key( b ) ) - ( key( a ) < key( b ) ) ) );
		headings.forEach( ( heading, column ) => {
			heading.removeAttribute( 'aria-sort' );
			if ( column === order.column ) heading.setAttribute( 'aria-sort', order.sign > 0 ? 'ascending' : 'descending' );
		} );
		// Unchanged rows keep the focus.
		if ( body.children.length !== found.length || found.some( ( { row }, i ) => body.children[ i ] !== row ) ) fill( body, found.map( ( { row } ) => row ) );
		const isMixed = ERRORS.includes( order.column ) && new Set( found.map( ( row ) => row.domain ).filter( Boolean ) ).size > 1;
		fill( count, found.length === rows.size ? `${ rows.size }${ next ? ' and more' : '' }` : `${ found.length } of ${ rows.size }`, isMixed && '; errors of different surfaces or ranges are not comparable' );
		if ( rows.size === 0 && ! empty ) root.append( empty = firstTable( signal ) );
		if ( empty ) empty.hidden = rows.size > 0;
		list.hidden = pictures.hidden = rows.size === 0;
		more.hidden = ! next;
	}

	async function read( cursor ) {
		const page = await call( `/v1/tables?limit=${ PAGE }${ cursor ? `&cursor=${ cursor }` : '' }`, { signal } );
		page.items.forEach( add );
		if ( ! cursor && ! page.next ) for ( const digest of rows.keys() ) if ( page.items.every( ( item ) => item.digest !== digest ) ) rows.delete( digest );
		// A refresh requests only the first page, so its `next` must not replace the cursor after the oldest table in the list.
		if ( cursor || next === null ) next = page.next;
		draw();
	}

	function older() {
		more.disabled = true;
		read( next ).finally( () => more.disabled = false );
	}

	const refresh = () => read().catch( () => {} );
	await read();
	const timer = setInterval( () => document.hidden || refresh(), AGAIN );
	signal.addEventListener( 'abort', () => clearInterval( timer ) );
	return refresh;
}
