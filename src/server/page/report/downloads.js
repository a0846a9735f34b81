// The files of a table for each engine, and the steps to use them.

import { el, fill, muted, notice, section } from '../elements/dom.js';
import { bytes, short } from '../elements/format.js';
import { ENGINES, formOf, isLookup } from '../elements/recipe.js';
import { address, call, reach } from '../service/api.js';
import { hasToken } from '../service/token.js';
import { saveAs } from '../service/zip.js';

/** Handles a click on a download link. Browsers send no token with links, so if there is a token, the page downloads the file itself. */
export async function save( event ) {
	if ( ! hasToken() ) return;
	event.preventDefault();
	const link = event.currentTarget;
	const response = await reach( link.href );
	if ( ! response.ok ) return link.after( notice( `the download failed: the service returned status ${ response.status }` ) );
	const [ , given ] = /filename="([^"]+)"/.exec( response.headers.get( 'content-disposition' ) ) || [];
	saveAs( await response.blob(), given || link.pathname.split( '/' ).pop() );
}

/** The files of one export. When the element is opened, the page requests the files, and the service makes them. */
function files( digest, name, signal ) {
	const inside = el( 'div', {}, muted( 'Making the files…' ) );
	const details = el( 'details', { ontoggle: open }, el( 'summary', {}, name ), inside );
	let request = null;

	function open() {
		if ( ! details.open ) return;
		request ??= call( `/v1/tables/${ digest }/exports/${ name }`, { signal } ).then( showFiles, ( error ) => {
			request = null;
			if ( ! signal.aborted ) fill( inside, notice( error.message ) );
		} );
	}

	function showFiles( { files, steps } ) {
		fill( inside,
			el( 'table', { class: 'files' }, el( 'tbody', {}, files.map( ( file ) => el( 'tr', {},
				el( 'th', { scope: 'row' }, el( 'a', { href: address( file.url ), download: true, onclick: save }, file.path ) ),
				el( 'td', { class: 'number' }, bytes( file.bytes ) ),
				el( 'td', {}, el( 'code', { class: 'muted', title: file.digest }, short( file.digest ) ) ) ) ) ) ),
			steps.length ? el( 'ol', { class: 'steps' }, steps.map( ( step ) => el( 'li', {}, step ) ) ) : null );
	}
	return details;
}

/** Exports that are for no engine. */
const FORMATS = /\.|^png$|^compact|-half$/;

/** The section with all exports of a table. */
export function downloads( digest, recipe, signal ) {
	const list = el( 'div' );
	const showExports = ( { items } ) => {
		const [ engines, others ] = [ false, true ].map( ( isFormat ) => items.filter( ( { name } ) => FORMATS.test( name ) === isFormat ).map( ( { name } ) => files( digest, name, signal ) ) );
		// An engine that reads another layout needs another table. Its recipe is the standard table in this layout.
		const missing = isLookup( recipe ) ? [] : ENGINES.filter( ( [ known ] ) => items.every( ( { name } ) => name !== known ) );
		fill( list, engines, missing.length > 0 && muted( 'Other engines need another layout. Fit a table for ', missing.map( ( [ , label, layout ], i ) => [ i ? ', ' : '', el( 'a', { href: formOf( { preset: 'standard', layout } ) }, label ) ] ), '.' ), el( 'details', { class: 'group' }, el( 'summary', {}, `Other formats (${ others.length })` ), el( 'div', { class: 'inner' }, others ) ) );
	};
	call( `/v1/tables/${ digest }/exports`, { signal } ).then( showExports, ( error ) => signal.aborted || fill( list, notice( error.message ) ) );
	return section( 'downloads', 'Files for engines', list );
}
