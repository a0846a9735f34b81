// Jobs: those that run, live, and those that ended.

import { el, fill, notice } from '../elements/dom.js';
import { age, title } from '../elements/format.js';
import { follow, isActive } from '../jobs/follow.js';
import { badge, bar, cancelButton } from '../jobs/progress.js';
import { call } from '../service/api.js';

/** Jobs that are followed at the same time. Streams take connections, of which a browser has six; others are asked for. */
const FOLLOWED = 2;
/** How often the list is asked for while jobs run, and while none does, in milliseconds. */
const [ BUSY, IDLE ] = [ 2000, 10_000 ];
/** Jobs of a page of the list. */
const PAGE = 50;

/** How a job ended or what is expected of it, in a few words. */
function outcome( job, onJob, onError ) {

	if ( isActive( job ) ) return [ bar( job ), cancelButton( job.id, onJob, onError ) ];
	if ( job.state === 'done' ) return el( 'a', { href: `#/tables/${ job.table }` }, 'Table' );
	return el( 'span', { class: 'reason' }, job.error ? job.error.detail : '' );

}

export async function show( root, rest, parameters, signal ) {

	if ( rest ) return ( await import( './job.js' ) ).show( root, rest, parameters, signal );
	const rows = new Map();
	const followed = new Set();
	let next = null;
	const body = el( 'tbody' );
	const count = el( 'span', { class: 'muted', role: 'status' } );
	const fault = el( 'div' );
	const more = el( 'button', { type: 'button', hidden: true, onclick: () => read( next ).catch( failed ) }, 'Older jobs' );
	const list = el( 'table', { class: 'list jobs' }, el( 'caption', { class: 'hidden' }, 'Jobs' ),
		el( 'thead', {}, el( 'tr', {}, [ 'State', 'Recipe', 'Progress' ].map( ( name ) => el( 'th', { scope: 'col' }, name ) ), el( 'th', { scope: 'col', class: 'number' }, 'Age' ) ) ), body );
	const empty = el( 'p', { class: 'empty', hidden: true }, 'No job is known. ', el( 'a', { href: '#/new' }, 'Submit a recipe' ), ' to begin one.' );
	fill( root, el( 'div', { class: 'bar' }, el( 'h1', {}, 'Jobs' ), count, el( 'span', { class: 'grow' } ), el( 'a', { class: 'button', href: '#/new' }, 'New' ) ), fault, list, empty, more );

	function failed( error ) {

		if ( ! signal.aborted ) fill( fault, notice( error.message ) );

	}

	function update( job ) {

		if ( signal.aborted ) return;
		const known = rows.get( job.id );
		const row = known ? known.row : el( 'tr' );
		rows.set( job.id, { job, row } );
		// A button that is pressed stays in its place.
		if ( known && known.text === JSON.stringify( job ) ) return;
		rows.get( job.id ).text = JSON.stringify( job );
		const held = row.contains( document.activeElement ) && document.activeElement.tagName;
		fill( row,
			el( 'td', {}, badge( job.state ) ),
			el( 'th', { scope: 'row' }, el( 'a', { href: `#/jobs/${ job.id }` }, title( job.recipe ) ) ),
			el( 'td', {}, outcome( job, update, failed ) ),
			el( 'td', { class: 'number' }, el( 'time', { datetime: job.created_at, title: new Date( job.created_at ).toLocaleString() }, age( job.created_at ) ) ) );
		if ( held ) row.querySelector( held.toLowerCase() )?.focus();
		if ( ! isActive( job ) ) followed.delete( job.id );
		tell();

	}

	function tell() {

		const jobs = [ ...rows.values() ].map( ( { job } ) => job );
		const active = jobs.filter( isActive );
		fill( count, active.length ? `${ active.length } under way` : 'none under way' );
		for ( const { id } of active.filter( ( { state } ) => state === 'running' ) ) {

			if ( followed.size >= FOLLOWED || followed.has( id ) ) continue;
			followed.add( id );
			follow( id, signal, update );

		}

	}

	async function read( cursor ) {

		const page = await call( `/v1/jobs?limit=${ PAGE }${ cursor ? `&cursor=${ cursor }` : '' }`, { signal } );
		page.items.forEach( update );
		if ( cursor || next === null ) next = page.next;
		more.hidden = ! next;
		const ordered = [ ...rows.values() ].sort( ( a, b ) => Date.parse( b.job.created_at ) - Date.parse( a.job.created_at ) ).map( ( { row } ) => row );
		if ( ordered.some( ( row, i ) => body.children[ i ] !== row ) ) fill( body, ordered );
		empty.hidden = rows.size > 0;
		list.hidden = rows.size === 0;
		fill( fault );
		tell();

	}

	async function poll() {

		while ( ! signal.aborted ) {

			const isBusy = [ ...rows.values() ].some( ( { job } ) => isActive( job ) );
			await new Promise( ( done ) => setTimeout( done, isBusy ? BUSY : IDLE ) );
			if ( ! signal.aborted && ! document.hidden ) await read().catch( () => {} );

		}

	}

	await read();
	poll();
	return () => read().catch( () => {} );

}
