// Shows the page that the part of the address behind `#` names, and whether the service answers.

import { el, fill, notice } from './elements/dom.js';
import { call, watchService } from './service/api.js';

/** Modules of the pages, by what follows their name. Each exports `show( main, rest, parameters, signal )`, and may return a function that asks again. */
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

/** A part of an address; as it is where it is malformed. */
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

		if ( ! Object.hasOwn( PAGES, name ) ) throw new Error( `there is no page «${ name }»` );
		const page = await PAGES[ name ]( rest );
		if ( signal.aborted ) return;
		const again = await page.show( root, rest, new URLSearchParams( query ), signal );
		if ( ! signal.aborted ) refresh = again;

	} catch ( error ) {

		if ( signal.aborted ) return;
		// Once the service is back, the page is shown again.
		fill( root, el( 'h1', {}, 'Not shown' ), notice( error.message ) );

	}

	const heading = root.querySelector( 'h1' );
	document.title = heading ? `${ heading.textContent } – ltcforge` : 'ltcforge';

}

async function tellVersion() {

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

	fill( service, 'The service does not answer; asking again.' );
	service.className = 'down';

} );
window.addEventListener( 'serviceback', () => {

	tellVersion();
	( refresh || show )();

} );

document.querySelector( '.skip' ).addEventListener( 'click', ( event ) => {

	// The part behind `#` names the page.
	event.preventDefault();
	main.focus();

} );

tellVersion();
show();
watchService();
