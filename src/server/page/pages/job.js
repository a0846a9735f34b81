// One job: progress, result and recipe.

import { button, el, facts, fill, notice } from '../elements/dom.js';
import { percent, span, whole } from '../elements/format.js';
import { expectedError, recipeSection, title, variation } from '../elements/recipe.js';
import { call } from '../service/api.js';
import { follow, isActive } from '../service/jobs.js';

const MARKS = { queued: '○', running: '◐', done: '●', failed: '✕', cancelled: '–' };

/** The state of a job as a symbol and a word, so that it can be read without colours. */
export function badge( state ) {
	return el( 'span', { class: `state ${ state }` }, el( 'span', { 'aria-hidden': 'true' }, MARKS[ state ] ), ` ${ state }` );
}

/** The progress of a job. */
export function bar( { progress: { entries_done, entries_total, seconds_left }, state } ) {
	const left = state === 'running' && seconds_left !== null ? `${ span( seconds_left ) } left` : '';
	return el( 'span', { class: 'progress' },
		el( 'progress', { max: entries_total, value: entries_done, 'aria-label': 'Entries fitted' } ),
		el( 'span', { class: 'number' }, percent( entries_done / entries_total, 0 ) ), el( 'span', { class: 'muted' }, left ) );
}

/** A button that cancels a job. `onJob` gets the cancelled job. */
export function cancelButton( id, onJob, onError ) {
	const pressed = el( 'button', { type: 'button', class: 'quiet', onclick: () => {
		pressed.disabled = true;
		call( `/v1/jobs/${ id }`, { method: 'DELETE' } ).then( onJob, onError ).finally( () => pressed.disabled = false );
	} }, 'Cancel' );
	return pressed;
}

export async function show( root, id, parameters, signal ) {
	const fault = el( 'div' );
	const state = el( 'div', { 'aria-live': 'polite' } );
	const figures = el( 'div' );
	const actions = el( 'p', { class: 'actions' } );
	const failed = ( error ) => signal.aborted || fill( fault, notice( error.message ) );
	const ask = () => call( `/v1/jobs/${ id }`, { signal } );
	let shown = null;

	function update( job ) {
		if ( signal.aborted ) return;
		const { progress, expected } = job;
		fill( fault );
		fill( figures, isActive( job ) ? bar( job ) : null, facts( [
			[ 'Entries', `${ whole( progress.entries_done ) } of ${ whole( progress.entries_total ) }` ],
			expected && [ 'Shards', whole( expected.shards ) ],
			expected && [ 'Expected time', span( expected.seconds ) ],
			expected && expectedError( job.recipe, expected.error ),
			job.started_at && job.finished_at && [ 'Duration', span( ( Date.parse( job.finished_at ) - Date.parse( job.started_at ) ) / 1000 ) ],
			[ 'Attempts', job.attempts ],
			[ 'Submitted', new Date( job.created_at ).toLocaleString() ],
		] ) );
		// If the state has not changed, the buttons are not replaced, so that they keep the focus.
		if ( job.state === shown ) return;
		shown = job.state;
		fill( state, badge( shown ), job.error ? el( 'p', { class: 'notice' }, job.error.title, ': ', job.error.detail ) : null );
		fill( actions,
			isActive( job ) ? cancelButton( id, update, failed ) : null,
			job.table ? button( `#/tables/${ job.table }`, 'Open the table', 'button primary' ) : null,
			shown === 'failed' || shown === 'cancelled' ? el( 'button', { type: 'button', class: 'primary', onclick: () => again( job ).catch( failed ) }, 'Submit again' ) : null,
			variation( job.recipe ) );
	}

	async function again( { recipe } ) {
		await call( '/v1/jobs', { method: 'POST', body: recipe } );
		watch( await ask() );
	}

	function watch( job ) {
		update( job );
		if ( isActive( job ) ) follow( id, signal, update );
	}
	const job = await ask();
	fill( root, el( 'h1', {}, title( job.recipe ) ), fault, state, figures, actions, recipeSection( job.recipe ) );
	watch( job );
	// `follow` opens the stream again. This call shows the changes since the stream was lost.
	return () => ask().then( update, failed );
}
