// The list of jobs.

import { bar as titled, button, el, fill, headings, notice } from '../elements/dom.js';
import { age } from '../elements/format.js';
import { labelOf, title } from '../elements/recipe.js';
import { call } from '../service/api.js';
import { isActive } from '../service/jobs.js';
import { badge, bar, cancelButton } from './job.js';

/** Milliseconds between two requests for the list: with active jobs, and without. */
const [ BUSY, IDLE ] = [ 1500, 10_000 ];

/** Number of jobs per page of the list, and the maximum number in a refresh. */
const [ PAGE, MOST ] = [ 50, 1000 ];

/** The progress or the result of a job. */
function outcome( job, onJob, onError ) {
	if ( isActive( job ) ) return [ bar( job ), cancelButton( job.id, onJob, onError ) ];
	if ( job.table ) return el( 'a', { href: `#/tables/${ job.table }` }, 'Table' );
	return el( 'span', { class: 'reason' }, job.error?.detail );
}

export async function show( root, rest, parameters, signal ) {
	const rows = new Map();
	let next = null;
	const body = el( 'tbody' );
	const count = el( 'span', { class: 'muted', role: 'status' } );
	const fault = el( 'div' );
	const more = el( 'button', { type: 'button', hidden: true, onclick: () => read( next ).catch( failed ) }, 'Older jobs' );
	const list = el( 'table', { class: 'list jobs' }, el( 'caption', { class: 'hidden' }, 'Jobs' ), el( 'thead', {}, headings( 'State', 'Recipe', 'Progress', 'Age' ) ), body );
	const empty = el( 'p', { class: 'empty', hidden: true }, 'There are no jobs yet. ', el( 'a', { href: '#/new' }, 'Submit a recipe' ), ' to start a job.' );
	fill( root, titled( 'Jobs', count, button( '#/new', 'New' ) ), fault, list, empty, more );
	const failed = ( error ) => signal.aborted || fill( fault, notice( error.message ) );

	function update( job ) {
		const { row = el( 'tr' ), text } = rows.get( job.id ) || {};
		rows.set( job.id, { job, row, text: JSON.stringify( job ) } );
		// An unchanged row is kept, so that a button is not replaced while it is pressed.
		if ( text === JSON.stringify( job ) ) return;
		const focusedTag = row.contains( document.activeElement ) && document.activeElement.tagName;
		fill( row,
			el( 'td', {}, badge( job.state ) ),
			el( 'th', { scope: 'row' }, el( 'a', { href: `#/jobs/${ job.id }` }, labelOf( job.table ) || title( job.recipe ) ) ),
			el( 'td', {}, outcome( job, update, failed ) ),
			el( 'td', { class: 'number' }, el( 'time', { datetime: job.created_at, title: new Date( job.created_at ).toLocaleString() }, age( job.created_at ) ) ) );
		if ( focusedTag ) row.querySelector( focusedTag )?.focus();
	}
	const active = () => [ ...rows.values() ].filter( ( { job } ) => isActive( job ) ).length;

	async function read( cursor ) {
		const page = await call( cursor ? `/v1/jobs?limit=${ PAGE }&cursor=${ cursor }` : `/v1/jobs?limit=${ Math.min( MOST, Math.max( PAGE, rows.size ) ) }`, { signal } );
		page.items.forEach( update );
		if ( cursor || next === null ) next = page.next;
		more.hidden = ! next;
		const ordered = [ ...rows.values() ].sort( ( a, b ) => Date.parse( b.job.created_at ) - Date.parse( a.job.created_at ) ).map( ( { row } ) => row );
		if ( ordered.some( ( row, i ) => body.children[ i ] !== row ) ) fill( body, ordered );
		empty.hidden = rows.size > 0;
		list.hidden = rows.size === 0;
		fill( fault );
		fill( count, active() ? `${ active() } active` : 'none active' );
	}

	async function poll() {
		while ( ! signal.aborted ) {
			await new Promise( ( done ) => setTimeout( done, active() ? BUSY : IDLE ) );
			if ( ! signal.aborted && ! document.hidden ) await read().catch( () => {} );
		}
	}
	await read();
	poll();
	return () => read().catch( () => {} );
}
