// The visitor's token, where the service wants one. It is kept in memory alone and gone with the page.

import { el, fill, notice } from '../elements/dom.js';

let token = '';
let asking = null;
let isDeclined = false;

/** Whether there is a token, without which links and pictures are asked for as they are. */
export const hasToken = () => token !== '';

/** The header by which a request is allowed; none without a token. */
export function authorization() {

	return token ? { authorization: `Bearer ${ token }` } : {};

}

/**
 * Whether there is another token than the one that was refused, after the visitor was asked for one. All calls that wait are
 * answered by one question, and who does not answer it is asked again on the next page.
 */
export async function anotherThan( { authorization: refused } ) {

	if ( token && authorization().authorization !== refused ) return true;
	if ( isDeclined ) return false;
	asking ??= asked( refused !== undefined ).finally( () => asking = null );
	return asking;

}

window.addEventListener( 'hashchange', () => isDeclined = false );

function asked( isRefused ) {

	return new Promise( ( answered ) => {

		const field = el( 'input', { type: 'password', id: 'token', autocomplete: 'off', required: true, spellcheck: 'false' } );
		const end = ( isGiven ) => {

			if ( isGiven ) token = field.value.trim();
			isDeclined = ! isGiven;
			dialog.remove();
			answered( isGiven );

		};

		const form = el( 'form', { onsubmit: ( event ) => {

			event.preventDefault();
			end( true );

		} } );
		const dialog = el( 'dialog', { 'aria-labelledby': 'token-title', oncancel: () => end( false ) }, form );
		fill( form, el( 'h2', { id: 'token-title' }, 'This service wants a token' ),
			isRefused ? notice( 'The service refused this token.' ) : null,
			el( 'p', {}, 'It stays in the memory of this page and is gone when the page is loaded again.' ),
			el( 'div', { class: 'field' }, el( 'label', { for: 'token' }, 'Token' ), field ),
			el( 'p', { class: 'actions' }, el( 'button', { type: 'submit', class: 'primary' }, 'Go on' ), el( 'button', { type: 'button', onclick: () => end( false ) }, 'Not now' ) ) );
		document.body.append( dialog );
		dialog.showModal();

	} );

}
