// The files of a table for each engine, and where they go.

import { el, fill, notice } from '../elements/dom.js';
import { bytes, short } from '../elements/format.js';
import { address, call, reach } from '../service/api.js';
import { hasToken } from '../service/token.js';

/** Exports whose files are of an engine, by the names that their makers write. */
const ENGINES = { three: 'three.js', babylon: 'Babylon.js', playcanvas: 'PlayCanvas', bevy: 'Bevy', godot: 'Godot', o3de: 'O3DE', hdrp: 'Unity HDRP', wgpu: 'wgpu, your own renderer' };

/** The name of an export as people read it. */
function named( name ) {

	if ( ENGINES[ name ] ) return ENGINES[ name ];
	const [ layout, format, numbers ] = name.split( '.' );
	return format ? `${ layout }, ${ format }, ${ numbers === 'f16' ? '16' : '32' } bits` : layout.replace( 'compact-', 'compact, with decoder in ' );

}

/** Saves what a link leads to, at its click: with a token, which a browser does not send for links, by the page itself. */
export async function save( event ) {

	if ( ! hasToken() ) return;
	event.preventDefault();
	const link = event.currentTarget;
	const response = await reach( link.href );
	if ( ! response.ok ) return link.after( notice( `the answer was ${ response.status }` ) );
	const [ , given ] = /filename="([^"]+)"/.exec( response.headers.get( 'content-disposition' ) || '' ) || [];
	const saved = el( 'a', { href: URL.createObjectURL( await response.blob() ), download: given || link.pathname.split( '/' ).pop() } );
	saved.click();
	// The browser has read it by then.
	setTimeout( () => URL.revokeObjectURL( saved.href ), 60_000 );

}

/** The files of an export, which the service makes when they are asked for. */
function files( digest, name, signal ) {

	const inside = el( 'div', {}, el( 'p', { class: 'muted' }, 'Making the files…' ) );
	const details = el( 'details', { ontoggle: open }, el( 'summary', {}, named( name ) ), inside );
	let isAsked = false;
	async function open() {

		if ( isAsked || ! details.open ) return;
		isAsked = true;
		try {

			const made = await call( `/v1/tables/${ digest }/exports/${ name }`, { signal } );
			fill( inside,
				el( 'table', { class: 'files' }, el( 'tbody', {}, made.files.map( ( file ) => el( 'tr', {},
					el( 'th', { scope: 'row' }, el( 'a', { href: address( file.url ), download: true, onclick: save }, file.path ) ),
					el( 'td', { class: 'number' }, bytes( file.bytes ) ),
					el( 'td', {}, el( 'code', { class: 'muted', title: file.digest }, short( file.digest ) ) ) ) ) ) ),
				made.steps.length ? el( 'ol', { class: 'steps' }, made.steps.map( ( step ) => el( 'li', {}, step ) ) ) : null );

		} catch ( error ) {

			if ( signal.aborted ) return;
			isAsked = false;
			fill( inside, notice( error.message ) );

		}

	}

	return details;

}

/** The section of a table's files; the exports that there are may be told later. */
export function downloads( digest, signal ) {

	const list = el( 'div' );
	const tell = ( { items } ) => {

		const names = items.map( ( { name } ) => name );
		const [ engines, others ] = [ names.filter( ( name ) => ENGINES[ name ] ), names.filter( ( name ) => ! ENGINES[ name ] ) ];
		fill( list, engines.map( ( name ) => files( digest, name, signal ) ),
			el( 'details', { class: 'group' }, el( 'summary', {}, `Other formats (${ others.length })` ), el( 'div', { class: 'inner' }, others.map( ( name ) => files( digest, name, signal ) ) ) ) );

	};

	call( `/v1/tables/${ digest }/exports`, { signal } ).then( tell, ( error ) => signal.aborted || fill( list, notice( error.message ) ) );
	return el( 'section', { 'aria-labelledby': 'downloads' }, el( 'h2', { id: 'downloads' }, 'Files for engines' ), list );

}
