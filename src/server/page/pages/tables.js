// The list of tables: search, sort, and what to compare.

import { el, fill } from '../elements/dom.js';
import { age, bytes, percent, short, title } from '../elements/format.js';
import { call, each, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

/** Tables of a page of the list. */
const PAGE = 200;
/** Manifests that are asked for at the same time: the service hashes a table for each. */
const AT_ONCE = 4;
/** Pixels of a picture, for screens of twice the density. */
const PICTURE = 96;

/** The columns that sort: their names, what they sort by, and whether the first click asks for the least. */
const COLUMNS = [
	[ 'Table', ( row ) => row.title || '', true ],
	[ 'Error', ( row ) => row.error ?? Infinity, true ],
	[ 'Light', ( row ) => row.light ?? Infinity, true ],
	[ 'Size', ( row ) => row.bytes, true ],
	[ 'Age', ( row ) => - Date.parse( row.created_at ), true ],
];

export async function show( root, rest, parameters, signal ) {

	const rows = new Map();
	const chosen = new Set();
	let order = { column: 4, rising: true };
	let next = null;

	const search = el( 'input', { type: 'search', id: 'search', placeholder: 'ggx, ltc2017, f16, 1f0c…', oninput: draw } );
	const count = el( 'span', { class: 'muted', role: 'status' } );
	const compare = el( 'a', { class: 'button', href: '#/compare', hidden: true }, 'Compare' );
	const body = el( 'tbody' );
	const more = el( 'button', { type: 'button', hidden: true, onclick: older }, 'Older tables' );
	const headings = COLUMNS.map( ( [ name ], column ) => el( 'th', { scope: 'col', class: column ? 'number' : null }, el( 'button', { type: 'button', class: 'sort', onclick: () => sort( column ) }, name ) ) );
	headings[ 1 ].firstChild.title = 'Mean error between nodes, as a part of the lobe’s width';
	headings[ 2 ].firstChild.title = 'Mean error of the light of square lights, as a part of the lobe’s energy';
	const list = el( 'table', { class: 'list' }, el( 'caption', { class: 'hidden' }, 'Tables' ),
		el( 'thead', {}, el( 'tr', {}, el( 'th', { scope: 'col', class: 'picture' }, el( 'span', { class: 'hidden' }, 'Picture' ) ), headings, el( 'th', { scope: 'col', class: 'choose' }, el( 'span', { class: 'hidden' }, 'Compare' ) ) ) ), body );
	const empty = el( 'p', { class: 'empty', hidden: true }, 'No table is stored yet. ', el( 'a', { href: '#/new' }, 'Submit a recipe' ), ' to make one.' );
	fill( root, el( 'div', { class: 'bar' }, el( 'h1', {}, 'Tables' ), count, el( 'span', { class: 'grow' } ), el( 'label', { for: 'search', class: 'hidden' }, 'Search' ), search, compare ), list, empty, more );

	function sort( column ) {

		order = { column, rising: order.column === column ? ! order.rising : COLUMNS[ column ][ 2 ] };
		draw();

	}

	function add( item ) {

		if ( rows.has( item.digest ) ) return;
		const name = el( 'a', { href: `#/tables/${ item.digest }` }, short( item.digest ) );
		const picture = el( 'img', { alt: '', width: 48, height: 48 } );
		const [ error, light ] = [ el( 'td', { class: 'number', 'data-name': 'Error' }, '…' ), el( 'td', { class: 'number', 'data-name': 'Light' }, '…' ) ];
		const choose = el( 'input', { type: 'checkbox', 'aria-label': `Compare ${ short( item.digest ) }`, onchange: () => pick( item.digest, choose.checked ) } );
		const row = el( 'tr', {}, el( 'td', { class: 'picture' }, picture ),
			el( 'th', { scope: 'row' }, name, el( 'code', { class: 'muted' }, short( item.digest ) ) ), error, light,
			el( 'td', { class: 'number', 'data-name': 'Size' }, bytes( item.bytes ) ),
			el( 'td', { class: 'number', 'data-name': 'Age' }, el( 'time', { datetime: item.created_at, title: new Date( item.created_at ).toLocaleString() }, age( item.created_at ) ) ),
			el( 'td', { class: 'choose' }, choose ) );
		rows.set( item.digest, { ...item, row, name, picture, error: null, light: null, cells: [ error, light ] } );

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
		const found = [ ...rows.values() ].filter( ( row ) => words.every( ( word ) => `${ row.title } ${ row.digest } ${ row.recipe_digest }`.toLowerCase().includes( word ) ) );
		found.sort( ( a, b ) => {

			const [ one, other ] = [ key( a ), key( b ) ];
			return ( one < other ? - 1 : one > other ? 1 : 0 ) * ( order.rising ? 1 : - 1 );

		} );
		headings.forEach( ( heading, column ) => {

			if ( column === order.column ) heading.setAttribute( 'aria-sort', order.rising ? 'ascending' : 'descending' );
			else heading.removeAttribute( 'aria-sort' );

		} );
		fill( body, found.map( ( { row } ) => row ) );
		fill( count, found.length === rows.size ? `${ rows.size }${ next ? ' and more' : '' }` : `${ found.length } of ${ rows.size }` );
		empty.hidden = rows.size > 0;
		list.hidden = rows.size === 0;
		more.hidden = ! next;

	}

	async function detail( row ) {

		try {

			const { recipe, report } = await manifest( row.digest );
			if ( signal.aborted ) return;
			Object.assign( row, { title: title( recipe ), error: report.between.width.mean, light: report.between.light.mean } );
			fill( row.name, row.title );
			fill( row.cells[ 0 ], percent( row.error ) );
			fill( row.cells[ 1 ], percent( row.light, 2 ) );
			load( row.picture, previewOf( recipe, row.digest, PICTURE ), signal );

		} catch ( error ) {

			row.cells.forEach( ( cell ) => fill( cell, '–' ) );
			row.row.title = error.message;

		}

	}

	async function read( cursor ) {

		const page = await call( `/v1/tables?limit=${ PAGE }${ cursor ? `&cursor=${ cursor }` : '' }`, { signal } );
		const fresh = page.items.filter( ( { digest } ) => ! rows.has( digest ) );
		page.items.forEach( add );
		// The first page, asked for again, does not say where the oldest known table is followed by others.
		if ( cursor !== undefined || next === null ) next = page.next;
		draw();
		each( fresh.map( ( { digest } ) => rows.get( digest ) ), AT_ONCE, signal, detail ).then( () => signal.aborted || draw() );

	}

	async function older() {

		more.disabled = true;
		await read( next ).finally( () => more.disabled = false );

	}

	await read();
	return () => read().catch( () => {} );

}
