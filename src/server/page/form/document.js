// The recipe as JSON, to be copied, edited, or replaced by another that is pasted: it says what the form has no field for.

import { el } from '../elements/dom.js';
import { json } from '../elements/recipe.js';

/** Lines that are shown at most without scrolling. */
const MOST_LINES = 24;

/** Reads a document that may be a recipe. */
export function parsed( text ) {

	const value = JSON.parse( text );
	if ( Object.prototype.toString.call( value ) !== '[object Object]' ) throw new Error( 'A recipe is an object: { … }' );
	return value;

}

/** A field for the document; `take` gets the document that was entered, `refuse` is called where it is none. */
export function documentField( take, refuse ) {

	const fault = el( 'p', { class: 'fault', id: 'document-fault' } );
	const field = el( 'textarea', { id: 'document', 'aria-label': 'Recipe as JSON', 'aria-describedby': fault.id, spellcheck: 'false', autocomplete: 'off', oninput: () => {

		try {

			const entered = parsed( field.value );
			blame( '' );
			take( entered );

		} catch ( { name, message } ) {

			blame( name === 'SyntaxError' ? `This is not JSON: ${ message }` : message );
			refuse();

		}

	} } );

	function blame( text ) {

		fault.textContent = text;
		field.setAttribute( 'aria-invalid', text !== '' );
		field.rows = Math.min( field.value.split( '\n' ).length, MOST_LINES );

	}

	/** Shows a recipe; one that is just being edited stays as it was written. */
	function show( recipe ) {

		if ( document.activeElement === field ) return;
		field.value = json( recipe );
		blame( '' );

	}

	return { root: el( 'div', {}, field, fault ), text: () => field.value, isRefused: () => fault.textContent !== '', show };

}
