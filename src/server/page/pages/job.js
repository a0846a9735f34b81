// One job: its progress, its end, and its recipe.

import { el, facts, fill, notice } from '../elements/dom.js';
import { json, percent, span, title } from '../elements/format.js';
import { follow, isActive } from '../jobs/follow.js';
import { badge, bar, cancelButton } from '../jobs/progress.js';
import { call } from '../service/api.js';

export async function show( root, id, parameters, signal ) {

	const fault = el( 'div' );
	const state = el( 'div', { 'aria-live': 'polite' } );
	const figures = el( 'div' );
	const actions = el( 'p', { class: 'actions' } );

	function failed( error ) {

		if ( ! signal.aborted ) fill( fault, notice( error.message ) );

	}

	let shown = null;
	function update( job ) {

		if ( signal.aborted ) return;
		fill( fault );
		if ( job.state !== shown ) {

			shown = job.state;
			fill( state, badge( job.state ), job.error ? el( 'p', { class: 'notice' }, job.error.title, ': ', job.error.detail ) : null );
			fill( actions,
				isActive( job ) ? cancelButton( id, update, failed ) : null,
				job.table ? el( 'a', { class: 'button primary', href: `#/tables/${ job.table }` }, 'Open the table' ) : null,
				job.state === 'failed' || job.state === 'cancelled' ? el( 'button', { type: 'button', class: 'primary', onclick: again }, 'Submit again' ) : null,
				el( 'a', { class: 'button', href: variation( job ) }, 'Fit a variation' ) );

		}

		const { progress, expected } = job;
		fill( figures, isActive( job ) ? bar( job ) : null, facts( [
			[ 'Entries', `${ progress.entries_done.toLocaleString( 'en' ) } of ${ progress.entries_total.toLocaleString( 'en' ) }` ],
			expected && [ 'Shards', expected.shards.toLocaleString( 'en' ) ],
			expected && [ 'Expected time', span( expected.seconds ) ],
			expected && [ 'Expected error', percent( expected.error ) ],
			job.started_at && job.finished_at && [ 'Took', span( ( Date.parse( job.finished_at ) - Date.parse( job.started_at ) ) / 1000 ) ],
			[ 'Attempts', job.attempts ],
			[ 'Submitted', new Date( job.created_at ).toLocaleString() ],
		] ) );

		async function again() {

			try {

				await call( '/v1/jobs', { method: 'POST', body: job.recipe } );
				watch( await call( `/v1/jobs/${ id }`, { signal } ) );

			} catch ( error ) {

				failed( error );

			}

		}

	}

	function watch( job ) {

		update( job );
		if ( isActive( job ) ) follow( id, signal, update );

	}

	const job = await call( `/v1/jobs/${ id }`, { signal } );
	fill( root, el( 'h1', {}, title( job.recipe ) ), fault, state, figures, actions,
		el( 'section', { 'aria-labelledby': 'recipe' }, el( 'h2', { id: 'recipe' }, 'Recipe' ), el( 'pre', { tabindex: 0, role: 'region', 'aria-label': 'Recipe as JSON' }, json( job.recipe ) ) ) );
	watch( job );
	// The stream is opened anew by itself; this asks for what has happened meanwhile.
	return () => call( `/v1/jobs/${ id }`, { signal } ).then( update, failed );

}

/** The form with a job's recipe in it. */
function variation( { recipe } ) {

	const document = { ...recipe };
	delete document.fitter;
	return `#/new?${ new URLSearchParams( { recipe: JSON.stringify( document ) } ) }`;

}
