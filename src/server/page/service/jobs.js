// Follows the changes of a job with Server-Sent Events.

import { awaitService, call, reach } from './api.js';

/** Whether a job can still change. */
export const isActive = ( { state } ) => state === 'queued' || state === 'running';

/** Calls `onEvent` with the type and the data of each event in a stream. `EventSource` cannot be used, because it cannot send a token. */
async function events( body, onEvent ) {
	const reader = body.pipeThrough( new TextDecoderStream() ).getReader();
	for ( let [ text, chunk ] = [ '', await reader.read() ]; ! chunk.done; chunk = await reader.read() ) {
		const blocks = ( text + chunk.value ).split( '\n\n' );
		text = blocks.pop();
		for ( const block of blocks ) {
			const field = ( name ) => new RegExp( `^${ name }: ?(.*)$`, 'm' ).exec( block )?.[ 1 ];
			if ( field( 'data' ) ) onEvent( field( 'event' ), field( 'data' ) );
		}
	}
}

/**
 * Calls `onJob` with each change of a job until the job ends or `signal` aborts. The stream is closed while the page is hidden,
 * because a browser opens only six connections to a service for all its tabs.
 */
export function follow( id, signal, onJob ) {
	let stream = null;
	const close = () => {
		stream?.abort();
		stream = null;
	};
	const receive = ( type, data ) => {
		if ( type !== 'state' && type !== 'progress' ) return;
		const job = JSON.parse( data );
		if ( ! isActive( job ) ) end();
		// An error in `onJob` must not end the stream.
		queueMicrotask( () => onJob( job ) );
	};

	async function open() {
		if ( stream || document.hidden ) return;
		const own = stream = new AbortController();
		try {
			const { body, ok } = await reach( `/v1/jobs/${ id }/events`, { signal: own.signal } );
			if ( ok ) await events( body, ( ...event ) => own === stream && receive( ...event ) );
		} catch {
			// The connection broke, or `close` was called.
		}
		if ( own !== stream ) return;
		// The service or a proxy closed the connection.
		close();
		awaitService();
	}
	const onVisibility = () => document.hidden ? close() : open();
	const ended = new AbortController();

	function end() {
		close();
		ended.abort();
	}
	document.addEventListener( 'visibilitychange', onVisibility, { signal: ended.signal } );
	window.addEventListener( 'serviceback', open, { signal: ended.signal } );
	signal.addEventListener( 'abort', end );
	open();
}

/** The table of a recipe. Submits a job and waits for it; `onJob` gets its changes. */
export async function fitted( recipe, signal, onJob ) {
	const job = await call( '/v1/jobs', { method: 'POST', body: recipe, signal } );
	if ( job.table ) return job.table;
	return new Promise( ( done, failed ) => follow( job.id, signal, ( changed ) => {
		if ( changed.table ) done( changed.table );
		else if ( isActive( changed ) ) onJob( changed );
		else failed( new Error( changed.error?.detail ?? `the job is ${ changed.state }` ) );
	} ) );
}
