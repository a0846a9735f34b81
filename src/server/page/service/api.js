// Calls of the service, by addresses relative to the page's own.

import { anotherThan, authorization, hasToken } from './token.js';

const BASE = new URL( '.', document.baseURI );

/** How often a service that does not answer is asked again, in milliseconds. */
const RETRY = 1500;

/** How often it is asked while it answers and somebody sees the page. */
const WATCH = 5000;

/** The absolute address of a path of the service, such as `/v1/jobs`: below the path at which the page is. */
export function address( path ) {

	return new URL( path.replace( /^\//, '' ), BASE ).href;

}

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
		if ( response.status !== 401 ) return response;
		if ( ! await anotherThan( token ) ) return response;
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
 * The JSON that a call answers with. `body` is sent as JSON, `raw` as it is under its media type. What only asks is asked again
 * once a service that went is back.
 */
export async function call( path, { method = 'GET', body, raw, type = 'application/json', signal } = {} ) {

	const sent = raw ?? ( body === undefined ? undefined : JSON.stringify( body ) );
	let response;
	try {

		response = await reach( path, { method, headers: sent === undefined ? {} : { 'content-type': type }, signal, body: sent } );

	} catch ( error ) {

		if ( error.name === 'AbortError' ) throw error;
		const isBack = awaitService();
		if ( method !== 'GET' ) throw new Error( 'the service does not answer' );
		await isBack;
		signal?.throwIfAborted();
		return call( path, { signal } );

	}

	const isJson = /json/.test( response.headers.get( 'content-type' ) || '' );
	const answer = isJson ? await response.json() : null;
	if ( response.ok ) return answer;
	throw new Problem( answer || { title: `the answer was ${ response.status }` } );

}

const manifests = new Map();

/** The manifest of a table, which never changes. */
export function manifest( digest ) {

	if ( ! manifests.has( digest ) ) {

		const pending = call( `/v1/tables/${ digest }/manifest` );
		manifests.set( digest, pending );
		pending.catch( () => manifests.delete( digest ) );

	}

	return manifests.get( digest );

}

/** Runs `work` on items, a few at a time, until `signal` ends it. */
export async function each( items, atOnce, signal, work ) {

	const left = [ ...items ];
	const worker = async () => {

		while ( left.length && ! signal.aborted ) await work( left.shift() );

	};

	await Promise.all( Array.from( { length: atOnce }, worker ) );

}

let awaited = null;

/** Asks until the service answers again, which the window is told by an event `serviceback`. */
export function awaitService() {

	awaited ??= untilItAnswers().finally( () => awaited = null );
	return awaited;

}

async function untilItAnswers() {

	window.dispatchEvent( new Event( 'servicelost' ) );
	do await new Promise( ( done ) => setTimeout( done, RETRY ) );
	while ( ! await answers() );
	window.dispatchEvent( new Event( 'serviceback' ) );

}

function answers() {

	return fetch( address( '/healthz' ) ).then( ( { ok } ) => ok, () => false );

}

/** Notices a service that goes while a page has nothing to ask. */
export function watchService() {

	const ask = async () => {

		if ( ! document.hidden && ! awaited && ! await answers() ) awaitService();

	};

	setInterval( ask, WATCH );
	document.addEventListener( 'visibilitychange', ask );

}
