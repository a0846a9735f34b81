// Shows the page named in the address after `#`, and whether the service responds.

import { el, fill, notice, takeDrops } from './elements/dom.js';
import { awaitService, call, isUp, watchService } from './service/api.js';
import { hold } from './service/kept.js';

/** Loads the module of a page. `rest` is the part of the address after the page's name. A module exports `show( root, rest, parameters, signal )`, which may return a function that refreshes the page. */
const PAGES = {
	tables: ( rest ) => rest ? import( './pages/table.js' ) : import( './pages/tables.js' ),
	jobs: ( rest ) => rest ? import( './pages/job.js' ) : import( './pages/jobs.js' ),
	new: () => import( './pages/new.js' ),
	compare: () => import( './pages/compare.js' ),
	viewer: () => import( './pages/viewer.js' ),
};

const main = document.getElementById( 'main' );
const service = document.getElementById( 'service' );
let leave = new AbortController();
let refresh = null;

/** Decodes a part of an address. Returns a malformed part unchanged. */
function decoded( text ) {
	try {
		return decodeURIComponent( text );
	} catch {
		return text;
	}
}

async function show() {
	const [ path, query = '' ] = location.hash.replace( /^#\/?/, '' ).split( /\?(.*)/s );
	const [ name = '', ...parts ] = ( path || 'tables' ).split( '/' );
	const rest = decoded( parts.join( '/' ) );
	leave.abort();
	leave = new AbortController();
	const { signal } = leave;
	refresh = null;
	for ( const link of document.querySelectorAll( 'nav a' ) ) {
		link.removeAttribute( 'aria-current' );
		if ( link.hash === `#/${ name }` ) link.setAttribute( 'aria-current', 'page' );
	}
	const root = el( 'div', { class: `page-${ name }` } );
	fill( main, root );
	try {
		if ( ! Object.hasOwn( PAGES, name ) ) throw new Error( `there is no page «${ name }»; choose a page above` );
		const page = await PAGES[ name ]( rest );
		if ( signal.aborted ) return;
		const again = await page.show( root, rest, new URLSearchParams( query ), signal );
		if ( ! signal.aborted ) refresh = again;
	} catch ( error ) {
		if ( signal.aborted ) return;
		// When the service is back, `serviceback` shows the page again.
		// Browsers do not say why a module is missing.
		const isLost = error instanceof TypeError && ! await isUp();
		if ( isLost ) awaitService();
		fill( root, el( 'h1', {}, 'Cannot show this page' ), notice( isLost ? 'The service does not respond. The page appears when it is back.' : error.message ) );
	}
	const heading = root.querySelector( 'h1' );
	document.title = heading ? `${ heading.textContent } – ltcforge` : 'ltcforge';
}

async function showVersion() {
	try {
		const { version, fitter } = await call( '/version' );
		fill( service, `version ${ version }, fitter ${ fitter }` );
		service.className = 'up';
	} catch ( error ) {
		fill( service, error.message );
	}
}

window.addEventListener( 'hashchange', () => {
	show();
	window.scrollTo( 0, 0 );
	main.focus( { preventScroll: true } );
} );
window.addEventListener( 'servicelost', () => {
	fill( service, 'The service does not respond. Trying again…' );
	service.className = 'down';
} );
window.addEventListener( 'serviceback', () => {
	showVersion();
	( refresh || show )();
} );

document.querySelector( '.skip' ).addEventListener( 'click', ( event ) => {
	// Following the link would change the part after `#`, which names the page.
	event.preventDefault();
	main.focus();
} );

// A scene can be dropped on every page. The viewer shows it.
takeDrops( document, ( file ) => {
	hold( file );
	const hash = `#/viewer?${ new URLSearchParams( { dropped: file.name } ) }`;
	if ( location.hash === hash ) show();
	else location.hash = hash;
} );

showVersion();
show();
watchService();
