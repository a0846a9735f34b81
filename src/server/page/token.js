// The visitor's token, where the service wants one. It is kept in memory alone and gone with the page.

import { el, fill, notice } from './dom.js';

let token = '';
let asking = null;

/** Whether there is a token, without which links and pictures are asked for as they are. */
export const hasToken = () => token !== '';

/** The header by which a request is allowed; none without a token. */
export function authorization() {

	return token ? { authorization: `Bearer ${ token }` } : {};

}

/** Waits until there is another token than the one that was refused. All calls that wait are answered by one question. */
export function anotherThan( { authorization: refused = '' } ) {

	if ( authorization().authorization !== refused && token ) return Promise.resolve();
	asking ??= asked( refused !== '' ).finally( () => asking = null );
	return asking;

}

function asked( isRefused ) {

	return new Promise( ( answered ) => {

		const field = el( 'input', { type: 'password', id: 'token', autocomplete: 'off', required: true, spellcheck: 'false' } );
		const form = el( 'form', { method: 'dialog', onsubmit: ( event ) => {

			event.preventDefault();
			token = field.value.trim();
			dialog.close();
			dialog.remove();
			answered();

		} } );
		const dialog = el( 'dialog', { 'aria-labelledby': 'token-title', oncancel: ( event ) => event.preventDefault() }, form );
		fill( form, el( 'h2', { id: 'token-title' }, 'This service wants a token' ),
			isRefused ? notice( 'The service refused this token.' ) : null,
			el( 'p', {}, 'It stays in the memory of this page and is gone when the page is loaded again.' ),
			el( 'div', { class: 'field' }, el( 'label', { for: 'token' }, 'Token' ), field ),
			el( 'p', { class: 'actions' }, el( 'button', { type: 'submit', class: 'primary' }, 'Go on' ) ) );
		document.body.append( dialog );
		dialog.showModal();

	} );

}
