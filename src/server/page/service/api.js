// Calls to the service. Addresses are relative to the page.

import { anotherThan, authorization } from './token.js';

const BASE = new URL( '.', document.baseURI );

/** Milliseconds between checks of the service: while it does not respond, and while it responds. Hidden pages check only while it does not respond. */
const [ RETRY, WATCH ] = [ 1500, 5000 ];

/** The absolute address of a path such as `/v1/jobs`. A prefix in the page's own address is kept. */
export const address = ( path ) => new URL( path.replace( /^\//, '' ), BASE ).href;

/** The error for a problem document [RFC 9457] from the service. */
export class Problem extends Error {
	constructor( document ) {
		super( document.detail || document.title );
		this.document = document;
	}
}

/** The response to a request. If the service needs a token, the page asks the user until the token is valid or they decline. */
export async function reach( path, { headers = {}, ...init } = {} ) {
	for ( ;; ) {
		const token = authorization();
		const response = await fetch( address( path ), { ...init, headers: { ...headers, ...token } } );
		if ( response.status !== 401 || ! await anotherThan( token ) ) return response;
		init.signal?.throwIfAborted();
	}
}

/**
 * The JSON response to a call. `body` is sent as JSON, and `raw` is sent unchanged with the media type `type`. If the service does
 * not respond, a GET request waits until the service is back, and is then repeated.
 */
export async function call( path, { method = 'GET', body, raw, type = 'application/json', signal } = {} ) {
	const sent = raw ?? ( body && JSON.stringify( body ) );
	let response;
	try {
		response = await reach( path, { method, headers: sent ? { 'content-type': type } : {}, signal, body: sent } );
	} catch ( error ) {
		if ( error.name === 'AbortError' ) throw error;
		const isBack = awaitService();
		if ( method !== 'GET' ) throw new Error( 'the service does not respond; try again later' );
		await isBack;
		signal?.throwIfAborted();
		return call( path, { signal } );
	}
	const answer = /json/.test( response.headers.get( 'content-type' ) ) ? await response.json() : null;
	if ( response.ok ) return answer;
	throw new Problem( answer || { title: `the service returned status ${ response.status }` } );
}

const responses = new Map();

/** The response for a path whose content never changes. It is requested only once. */
export function constant( path ) {
	if ( ! responses.has( path ) ) {
		const pending = call( path );
		responses.set( path, pending );
		pending.catch( () => responses.delete( path ) );
	}
	return responses.get( path );
}

/** The manifest of a table. */
export const manifest = ( digest ) => constant( `/v1/tables/${ digest }/manifest` );

let awaited = null;

/** Whether the service responds. */
export const isUp = () => fetch( address( '/healthz' ) ).then( ( { ok } ) => ok, () => false );

/** Waits until the service responds again. Dispatches `servicelost` and `serviceback` on the window. */
export function awaitService() {
	awaited ??= untilUp().finally( () => awaited = null );
	return awaited;
}

async function untilUp() {
	window.dispatchEvent( new Event( 'servicelost' ) );
	do await new Promise( ( done ) => setTimeout( done, RETRY ) );
	while ( ! await isUp() );
	window.dispatchEvent( new Event( 'serviceback' ) );
}

/** Checks the service regularly, so that a page that makes no calls also notices when the service stops. */
export function watchService() {
	const ask = async () => {
		if ( ! document.hidden && ! awaited && ! await isUp() ) awaitService();
	};
	setInterval( ask, WATCH );
	document.addEventListener( 'visibilitychange', ask );
}
