// Calls of the service, by addresses relative to the page's own.

import { anotherThan, authorization, hasToken } from './token.js';

const BASE = new URL( '.', document.baseURI );

/** How often a service that does not answer is asked again, and one that does while somebody sees the page, in milliseconds. */
const [ RETRY, WATCH ] = [ 1500, 5000 ];

/** The absolute address of a path of the service, such as `/v1/jobs`: below the path at which the page is. */
export const address = ( path ) => new URL( path.replace( /^\//, '' ), BASE ).href;

/** An answer of the service that is a problem document [RFC 9457]. */
export class Problem extends Error {

	constructor( document ) {

		super( document.detail || document.title );
		this.document = document;

	}

}

/** The answer to a request; where the service wants a token, the visitor is asked for one until it is the right one. */
export async function reach( path, { headers = {}, ...init } = {} ) {

	for ( ;; ) {

		const token = authorization();
		const response = await fetch( address( path ), { ...init, headers: { ...headers, ...token } } );
		if ( response.status !== 401 || ! await anotherThan( token ) ) return response;
		init.signal?.throwIfAborted();

	}

}

/** The address of a picture; with a token it is fetched first, since a browser sends none for pictures. */
export async function pictureFrom( path ) {

	if ( ! hasToken() ) return address( path );
	const response = await reach( path );
	return response.ok ? URL.createObjectURL( await response.blob() ) : address( path );

}

/**
 * The JSON answer to a call. `body` is sent as JSON, `raw` as it is under its media type. A GET is asked again once a service
 * that went is back.
 */
export async function call( path, { method = 'GET', body, raw, type = 'application/json', signal } = {} ) {

	const sent = raw ?? ( body && JSON.stringify( body ) );
	let response;
	try {

		response = await reach( path, { method, headers: sent ? { 'content-type': type } : {}, signal, body: sent } );

	} catch ( error ) {

		if ( error.name === 'AbortError' ) throw error;
		const isBack = awaitService();
		if ( method !== 'GET' ) throw new Error( 'the service does not answer' );
		await isBack;
		signal?.throwIfAborted();
		return call( path, { signal } );

	}

	const answer = /json/.test( response.headers.get( 'content-type' ) ) ? await response.json() : null;
	if ( response.ok ) return answer;
	throw new Problem( answer || { title: `the answer was ${ response.status }` } );

}

const answers = new Map();

/** The answer at a path where it never changes. */
export function constant( path ) {

	if ( ! answers.has( path ) ) {

		const pending = call( path );
		answers.set( path, pending );
		pending.catch( () => answers.delete( path ) );

	}

	return answers.get( path );

}

/** The manifest of a table. */
export const manifest = ( digest ) => constant( `/v1/tables/${ digest }/manifest` );

/** Runs `work` on items, a few at a time, until `signal` ends it. */
export async function each( items, atOnce, signal, work ) {

	const left = [ ...items ];
	const worker = async () => {

		while ( left.length && ! signal.aborted ) await work( left.shift() );

	};

	await Promise.all( Array.from( { length: atOnce }, worker ) );

}

let awaited = null;
const isThere = () => fetch( address( '/healthz' ) ).then( ( { ok } ) => ok, () => false );

/** Asks until the service answers again. The window gets the events `servicelost` and `serviceback`. */
export function awaitService() {

	awaited ??= untilItAnswers().finally( () => awaited = null );
	return awaited;

}

async function untilItAnswers() {

	window.dispatchEvent( new Event( 'servicelost' ) );
	do await new Promise( ( done ) => setTimeout( done, RETRY ) );
	while ( ! await isThere() );
	window.dispatchEvent( new Event( 'serviceback' ) );

}

/** Notices a service that stops while a page has nothing to ask. */
export function watchService() {

	const ask = async () => {

		if ( ! document.hidden && ! awaited && ! await isThere() ) awaitService();

	};

	setInterval( ask, WATCH );
	document.addEventListener( 'visibilitychange', ask );

}
