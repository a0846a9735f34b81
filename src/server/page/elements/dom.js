// Creates elements. No markup is parsed from strings.

const SVG = 'http://www.w3.org/2000/svg';

/**
 * Creates an element. Attributes that begin with `on` are listeners. Attributes and children that are `null`, `undefined` or `false` are skipped.
 *
 * @param {string} tag
 * @param {Object<string, *>} attributes
 * @param {...(Node|string|number|null|false|Array)} children
 * @returns {HTMLElement}
 */
export function el( tag, attributes = {}, ...children ) {
	return filled( document.createElement( tag ), attributes, children );
}

/** Creates an SVG element. The arguments are the same as for `el`. */
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

/** A button that copies the text that `read` returns. Its label then confirms the copy. */
export function copyButton( label, read ) {
	const button = el( 'button', { type: 'button', class: 'quiet', onclick: async () => {
		// Without https, browsers offer no clipboard, and users must copy the text themselves.
		const isCopied = await navigator.clipboard?.writeText( read() ).then( () => true, () => false );
		button.textContent = isCopied ? 'Copied' : 'Select the text and press Ctrl+C';
		setTimeout( () => button.textContent = label, 1500 );
	} }, label );
	return button;
}

/** A text with a title, and a button that copies the text. `label` is for screen readers. */
export function copyLine( title, label, text ) {
	const code = el( 'code', { tabindex: 0, role: 'textbox', 'aria-readonly': 'true', 'aria-label': label }, text );
	return [ el( 'div', { class: 'label' }, title ), el( 'div', { class: 'copy' }, code, copyButton( 'Copy', () => text ) ) ];
}

/** A list of names and values. */
export function facts( pairs ) {
	return el( 'dl', { class: 'facts' }, pairs.filter( Boolean ).map( ( [ name, ...value ] ) => el( 'div', {}, el( 'dt', {}, name ), el( 'dd', {}, value ) ) ) );
}

/** An error message. */
export const notice = ( text ) => el( 'p', { class: 'notice', role: 'alert' }, text );

/** A paragraph of secondary text. */
export const muted = ( ...children ) => el( 'p', { class: 'muted' }, children );

/** A link that looks like a button. */
export const button = ( href, text, kind = 'button' ) => el( 'a', { class: kind, href }, text );

/** A section of a page with its heading. */
export const section = ( id, heading, ...children ) => el( 'section', { 'aria-labelledby': id }, el( 'h2', { id }, heading ), children );

/** The heading of a page. `start` follows it on the same line, and `end` is at the right end of the line. */
export const bar = ( heading, start, ...end ) => el( 'div', { class: 'bar' }, el( 'h1', {}, heading ), start, el( 'span', { class: 'grow' } ), end );

/** The header row of a table. */
export const headings = ( ...names ) => el( 'tr', {}, names.map( ( name ) => el( 'th', { scope: 'col' }, name ) ) );

/** A file input that looks like a button. `take` gets the file. */
export function fileField( id, accept, label, take, kind = 'button quiet' ) {
	const input = el( 'input', { type: 'file', id, accept, class: 'hidden', onchange: () => input.files[ 0 ] && take( input.files[ 0 ] ) } );
	return [ input, el( 'label', { for: id, class: kind }, label ) ];
}

/** Calls `take` with the file that a user drops on an element, unless an element inside has taken it. */
export function takeDrops( element, take ) {
	element.addEventListener( 'dragover', ( event ) => event.preventDefault() );
	element.addEventListener( 'drop', ( event ) => {
		if ( event.defaultPrevented ) return;
		event.preventDefault();
		const [ file ] = event.dataTransfer.files;
		if ( file ) take( file );
	} );
}
