// Calls of the service, by addresses relative to the page's own.

import { anotherThan, authorization, hasToken } from './token.js';

const BASE = new URL( '.', document.baseURI );

/** How often a service that does not answer is asked again, in milliseconds. */
const RETRY = 1500;

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

/** The service did not answer. */
export class Unreachable extends Error {}

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

/** The JSON that a call answers with. `body` is sent as JSON, `raw` as it is under its media type. */
export async function call( path, { method = 'GET', body, raw, type = 'application/json', signal } = {} ) {

	const sent = raw ?? ( body === undefined ? undefined : JSON.stringify( body ) );
	let response;
	try {

		response = await reach( path, { method, headers: sent === undefined ? {} : { 'content-type': type }, signal, body: sent } );

	} catch ( error ) {

		if ( error.name === 'AbortError' ) throw error;
		awaitService();
		throw new Unreachable( 'the service does not answer' );

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

let isAwaited = false;

/** Asks until the service answers again, then tells the window by an event `serviceback`. */
export async function awaitService() {

	if ( isAwaited ) return;
	isAwaited = true;
	window.dispatchEvent( new Event( 'servicelost' ) );
	for ( let answers = false; ! answers; ) {

		await new Promise( ( done ) => setTimeout( done, RETRY ) );
		answers = await fetch( address( '/healthz' ) ).then( ( response ) => response.ok, () => false );

	}

	isAwaited = false;
	window.dispatchEvent( new Event( 'serviceback' ) );

}
