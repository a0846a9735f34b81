// Elements, made without markup in strings.

const SVG = 'http://www.w3.org/2000/svg';

/**
 * An element. Attributes that begin with `on` are listeners; `null`, `undefined` and `false` leave an attribute or child out.
 *
 * @param {string} tag
 * @param {Object<string, *>} attributes
 * @param {...(Node|string|number|null|false|Array)} children
 * @returns {HTMLElement}
 */
export function el( tag, attributes = {}, ...children ) {

	return filled( document.createElement( tag ), attributes, children );

}

/** As `el`, an element of SVG. */
export function svg( tag, attributes = {}, ...children ) {

	return filled( document.createElementNS( SVG, tag ), attributes, children );

}

function filled( element, attributes, children ) {

	for ( const [ name, value ] of Object.entries( attributes ) ) {

		if ( value === null || value === undefined || value === false ) continue;
		if ( name.startsWith( 'on' ) ) element.addEventListener( name.slice( 2 ), value );
		else element.setAttribute( name, value === true ? '' : value );

	}

	return fill( element, ...children );

}

/** Replaces the children of an element. */
export function fill( element, ...children ) {

	element.replaceChildren( ...children.flat( Infinity ).filter( ( child ) => child !== null && child !== undefined && child !== false ) );
	return element;

}

/** A button that copies the text that `read` returns, and says that it did. */
export function copyButton( label, read ) {

	const button = el( 'button', { type: 'button', class: 'quiet', onclick: async () => {

		// Without https a browser has no clipboard; the text is there to be selected.
		const isCopied = await navigator.clipboard?.writeText( read() ).then( () => true, () => false );
		button.textContent = isCopied ? 'Copied' : 'Select it and press Ctrl C';
		setTimeout( () => button.textContent = label, 1500 );

	} }, label );
	return button;

}

/** A text to copy, with its label and button. */
export function copyLine( title, label, text ) {

	const code = el( 'code', { tabindex: 0, role: 'textbox', 'aria-readonly': 'true', 'aria-label': label }, text );
	return [ el( 'div', { class: 'label' }, title ), el( 'div', { class: 'copy' }, code, copyButton( 'Copy', () => text ) ) ];

}

/** Pairs of a name and a value, in rows. */
export function facts( pairs ) {

	return el( 'dl', { class: 'facts' }, pairs.filter( Boolean ).map( ( [ name, ...value ] ) => el( 'div', {}, el( 'dt', {}, name ), el( 'dd', {}, value ) ) ) );

}

/** A message about something that went wrong. */
export const notice = ( text ) => el( 'p', { class: 'notice', role: 'alert' }, text );

/** A line in the background. */
export const muted = ( ...children ) => el( 'p', { class: 'muted' }, children );

/** A link that looks like a button. */
export const button = ( href, text, kind = 'button' ) => el( 'a', { class: kind, href }, text );

/** A part of a page under a heading. */
export const section = ( id, heading, ...children ) => el( 'section', { 'aria-labelledby': id }, el( 'h2', { id }, heading ), children );

/** A heading of a page with what stands on its line, the last parts at its end. */
export const bar = ( heading, start, ...end ) => el( 'div', { class: 'bar' }, el( 'h1', {}, heading ), start, el( 'span', { class: 'grow' } ), end );

/** A row of a table's head. */
export const headings = ( ...names ) => el( 'tr', {}, names.map( ( name ) => el( 'th', { scope: 'col' }, name ) ) );

/** A field to open a file with, which looks like a button. */
export function fileField( id, accept, label, take, kind = 'button quiet' ) {

	const input = el( 'input', { type: 'file', id, accept, class: 'hidden', onchange: () => input.files[ 0 ] && take( input.files[ 0 ] ) } );
	return [ input, el( 'label', { for: id, class: kind }, label ) ];

}

/** Calls `take` with a file that is dropped on an element. */
export function takeDrops( element, take ) {

	element.addEventListener( 'dragover', ( event ) => event.preventDefault() );
	element.addEventListener( 'drop', ( event ) => {

		event.preventDefault();
		const [ file ] = event.dataTransfer.files;
		if ( file ) take( file );

	} );

}
