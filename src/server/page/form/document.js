// The recipe as JSON, which users can copy, edit or replace. It can contain fields that the form does not have.

import { el } from '../elements/dom.js';
import { json } from '../elements/recipe.js';

/** Maximum number of visible lines. A longer text scrolls. */
const MOST_LINES = 24;

/** Parses a text as a JSON object. */
export function parsed( text ) {
	const value = JSON.parse( text );
	if ( Object.prototype.toString.call( value ) !== '[object Object]' ) throw new Error( 'A recipe must be a JSON object: { … }' );
	return value;
}

/** A text field for the recipe. `take` gets an edited recipe. `refuse` is called if the text is not a JSON object. */
export function documentField( take, refuse ) {
	const fault = el( 'p', { class: 'fault', id: 'document-fault' } );
	const field = el( 'textarea', { id: 'document', 'aria-label': 'Recipe as JSON', 'aria-describedby': fault.id, spellcheck: 'false', autocomplete: 'off', oninput: () => {
		try {
			const entered = parsed( field.value );
			showFault( '' );
			take( entered );
		} catch ( { name, message } ) {
			showFault( name === 'SyntaxError' ? `This is not JSON: ${ message }` : message );
			refuse();
		}
	} } );

	function showFault( text ) {
		fault.textContent = text;
		field.setAttribute( 'aria-invalid', text !== '' );
		field.rows = Math.min( field.value.split( '\n' ).length, MOST_LINES );
	}

	/** Shows a recipe, unless the user is editing the text. */
	function show( recipe ) {
		if ( document.activeElement === field ) return;
		field.value = json( recipe );
		showFault( '' );
	}
	return { root: el( 'div', {}, field, fault ), text: () => field.value, isRefused: () => fault.textContent !== '', show };
}
