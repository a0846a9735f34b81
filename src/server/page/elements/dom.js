// Elements, made without markup in strings.

/**
 * An element. Attributes that begin with `on` are listeners; `null`, `undefined` and `false` leave an attribute or child out.
 *
 * @param {string} tag
 * @param {Object<string, *>} attributes
 * @param {...(Node|string|number|null|false|Array)} children
 * @returns {HTMLElement}
 */
export function el( tag, attributes = {}, ...children ) {

	const element = document.createElement( tag );
	for ( const [ name, value ] of Object.entries( attributes ) ) {

		if ( value === null || value === undefined || value === false ) continue;
		if ( name.startsWith( 'on' ) ) element.addEventListener( name.slice( 2 ), value );
		else element.setAttribute( name, value === true ? '' : value );

	}

	fill( element, ...children );
	return element;

}

/** Replaces the children of an element. */
export function fill( element, ...children ) {

	element.replaceChildren( ...children.flat( Infinity ).filter( ( child ) => child !== null && child !== undefined && child !== false ) );
	return element;

}

/** A button that copies a text, and says that it did. */
export function copyButton( label, text ) {

	const button = el( 'button', { type: 'button', class: 'quiet', onclick: copy }, label );
	async function copy() {

		try {

			await navigator.clipboard.writeText( typeof text === 'function' ? text() : text );
			button.textContent = 'Copied';

		} catch {

			// Without https a browser has no clipboard; the text is there to be selected.
			button.textContent = 'Select it and press Ctrl C';

		}

		setTimeout( () => button.textContent = label, 1500 );

	}

	return button;

}

/** A text to copy, with its button. */
export function copyLine( label, text ) {

	return el( 'div', { class: 'copy' }, el( 'code', { tabindex: 0, role: 'textbox', 'aria-readonly': 'true', 'aria-label': label }, text ), copyButton( 'Copy', text ) );

}

/** Pairs of a name and a value, in rows. */
export function facts( pairs ) {

	return el( 'dl', { class: 'facts' }, pairs.filter( Boolean ).map( ( [ name, ...value ] ) => el( 'div', {}, el( 'dt', {}, name ), el( 'dd', {}, ...value ) ) ) );

}

/** A message about something that went wrong. */
export function notice( text ) {

	return el( 'p', { class: 'notice', role: 'alert' }, text );

}
