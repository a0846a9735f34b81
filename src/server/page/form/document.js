// The recipe as JSON, to be copied, edited, or replaced by another that is pasted: it says what the form has no field for.

import { el } from '../elements/dom.js';
import { json } from '../elements/format.js';

/** Lines that are shown at most without scrolling. */
const MOST_LINES = 24;

/** Whether a value may be a recipe. */
export function isDocument( value ) {

	return typeof value === 'object' && value !== null && ! Array.isArray( value );

}

/** A field for the document; `take` gets what was entered, `refuse` is called where that is no document. */
export function documentField( take, refuse ) {

	const fault = el( 'p', { class: 'fault', id: 'document-fault' } );
	const field = el( 'textarea', { id: 'document', 'aria-label': 'Recipe as JSON', 'aria-describedby': fault.id, spellcheck: 'false', autocomplete: 'off', oninput: read } );

	function read() {

		let entered;
		try {

			entered = JSON.parse( field.value );

		} catch ( error ) {

			return blame( `This is not JSON: ${ error.message }` );

		}

		if ( ! isDocument( entered ) ) return blame( 'A recipe is an object: { … }' );
		blame( '' );
		take( entered );

	}

	function blame( text ) {

		fault.textContent = text;
		field.setAttribute( 'aria-invalid', text !== '' );
		field.rows = Math.min( field.value.split( '\n' ).length, MOST_LINES );
		if ( text ) refuse();

	}

	/** Shows a recipe; one that is just being edited stays as it was written. */
	function show( recipe ) {

		if ( document.activeElement === field ) return;
		field.value = json( recipe );
		blame( '' );

	}

	return { root: el( 'div', {}, field, fault ), text: () => field.value, isRefused: () => fault.textContent !== '', show };

}
