// A job's state and progress, and the button that cancels it.

import { el } from '../elements/dom.js';
import { percent, span } from '../elements/format.js';
import { call } from '../service/api.js';

/** The state of a job as a word with a mark, which does not rest on colour. */
export function badge( state ) {

	const marks = { queued: '○', running: '◐', done: '●', failed: '✕', cancelled: '–' };
	return el( 'span', { class: `state ${ state }` }, el( 'span', { 'aria-hidden': 'true' }, marks[ state ] ), ` ${ state }` );

}

/** How far a job is. */
export function bar( { progress: { entries_done, entries_total, seconds_left }, state } ) {

	const left = state === 'running' && seconds_left !== null ? `${ span( seconds_left ) } left` : '';
	return el( 'span', { class: 'progress' },
		el( 'progress', { max: entries_total, value: entries_done, 'aria-label': 'Entries fitted' } ),
		el( 'span', { class: 'number' }, percent( entries_done / entries_total, 0 ) ), el( 'span', { class: 'muted' }, left ) );

}

/** A button that cancels a job, and passes on the job as it is then. */
export function cancelButton( id, onJob, onError ) {

	const button = el( 'button', { type: 'button', class: 'quiet', onclick: cancel }, 'Cancel' );
	async function cancel() {

		button.disabled = true;
		try {

			onJob( await call( `/v1/jobs/${ id }`, { method: 'DELETE' } ) );

		} catch ( error ) {

			button.disabled = false;
			onError( error );

		}

	}

	return button;

}
