// A job as it changes, by Server-Sent Events.

import { address, awaitService } from './api.js';

/** Whether a job may still change. */
export function isActive( { state } ) {

	return state === 'queued' || state === 'running';

}

/**
 * Calls `onJob` with each change of a job until its end or that of `signal`. While nobody sees the page no stream is open: a
 * browser has six connections to a service for all its tabs.
 */
export function follow( id, signal, onJob ) {

	let source = null;
	const close = () => {

		if ( source ) source.close();
		source = null;

	};

	const receive = ( { data } ) => {

		const job = JSON.parse( data );
		if ( ! isActive( job ) ) end();
		onJob( job );

	};

	const open = () => {

		if ( source || document.hidden ) return;
		source = new EventSource( address( `/v1/jobs/${ id }/events` ) );
		source.addEventListener( 'state', receive );
		source.addEventListener( 'progress', receive );
		source.addEventListener( 'error', () => {

			// The service stopped, or a proxy did: the window is told once it answers.
			close();
			awaitService();

		} );

	};

	const seen = () => document.hidden ? close() : open();
	function end() {

		close();
		document.removeEventListener( 'visibilitychange', seen );
		window.removeEventListener( 'serviceback', open );

	}

	document.addEventListener( 'visibilitychange', seen );
	window.addEventListener( 'serviceback', open );
	signal.addEventListener( 'abort', end );
	open();

}
