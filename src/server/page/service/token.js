// The user's token, if the service needs a token. The page keeps it only in memory, until the page is reloaded.

import { el, fill, notice } from '../elements/dom.js';

let token = '';
let asking = null;
let isDeclined = false;

/** Whether the user has entered a token. Links and pictures then need `reach`. */
export const hasToken = () => token !== '';

/** The `authorization` header, or no header if there is no token. */
export function authorization() {
	return token ? { authorization: `Bearer ${ token }` } : {};
}

/**
 * Whether there is another token to try after `refused`. If necessary, asks the user for a token, once for all waiting calls. A
 * user who declines is asked again on the next page.
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
		const dialog = el( 'dialog', { 'aria-labelledby': 'token-title', onclose: () => end( false ) }, form );
		fill( form, el( 'h2', { id: 'token-title' }, 'This service needs a token' ),
			isRefused ? notice( 'The service rejected this token.' ) : null,
			el( 'p', {}, 'The page keeps the token in memory until you reload it.' ),
			el( 'div', { class: 'field' }, el( 'label', { for: 'token' }, 'Token' ), field ),
			el( 'p', { class: 'actions' }, el( 'button', { type: 'submit', class: 'primary' }, 'Continue' ), el( 'button', { type: 'button', onclick: () => end( false ) }, 'Not now' ) ) );
		document.body.append( dialog );
		dialog.showModal();
	} );
}
