// The inputs of the form. Each reads and shows one field of a recipe.

import { el } from '../elements/dom.js';
import { number } from '../elements/format.js';

/** Number of steps of a slider. The last position is exactly the maximum. */
const STEPS = 200;

/** Parses a number. JSON writes NaN as null, which the service rejects. */
const numberOf = ( text ) => text.trim() === '' ? NaN : Number( text );

/** Whether the user is editing an input. The page must not change its text then. */
const isEdited = ( input ) => document.activeElement === input;

function choice( { schema: { enum: options } }, id, changed ) {
	const main = el( 'select', { id, onchange: () => changed( options[ main.selectedIndex ] ) }, options.map( ( option ) => el( 'option', {}, String( option ) ) ) );
	return { parts: [ main ], main, show: ( value ) => main.selectedIndex = options.indexOf( value ?? options[ 0 ] ) };
}

function whole( { schema: { minimum: min, maximum: max } }, id, changed ) {
	// An empty input means the preset's value.
	const main = el( 'input', { type: 'number', id, min, max, step: 1, inputmode: 'numeric', oninput: () => changed( main.value === '' ? undefined : Number( main.value ) ) } );
	const show = ( value ) => {
		if ( ! isEdited( main ) && value !== undefined ) main.value = value;
	};
	return { parts: [ main ], main, show };
}

function interval( { label, schema: { items: { maximum } } }, id, changed ) {
	const output = el( 'output', { class: 'number' } );
	const showText = ( values ) => output.textContent = values.map( number ).join( ' – ' );
	const read = () => {
		const values = ends.map( ( { value } ) => Number( value ) === STEPS ? maximum : Number( value ) / STEPS * maximum );
		showText( values );
		changed( values );
	};
	const ends = [ 'from', 'to' ].map( ( name, i ) => el( 'input', { type: 'range', id: i ? `${ id }-to` : id, 'aria-label': `${ label }, ${ name }`, min: 0, max: STEPS, step: 1, oninput: read } ) );
	const show = ( values ) => {
		if ( ! Array.isArray( values ) || values.length !== 2 || ! values.every( Number.isFinite ) ) return;
		showText( values );
		// The slider shows the nearest position. The recipe keeps its value until the user moves the slider.
		ends.forEach( ( end, i ) => isEdited( end ) || ( end.value = Math.round( values[ i ] / maximum * STEPS ) ) );
	};
	return { parts: [ el( 'span', { class: 'interval' }, ends ), output ], main: ends[ 0 ], show };
}

/** A text input for a comma-separated list. `parse` parses an item, and `write` formats an item. */
function list( attributes, parse, write, changed ) {
	const input = el( 'input', { type: 'text', ...attributes, oninput: () => changed() } );
	const read = () => input.value.split( ',' ).map( parse );
	const show = ( value ) => {
		if ( ! isEdited( input ) ) input.value = Array.isArray( value ) ? value.map( ( item ) => write( Object( item ) ) ).join( ', ' ) : '';
	};
	return { input, read, show };
}

/** The input for materials: a name, or a list of F0 with weights other than 1, such as `1, 0.04 × 4`. */
function materials( { schema: { anyOf: [ { enum: names } ] } }, id, changed ) {
	const parse = ( text ) => {
		const [ f0, weight ] = text.split( /[×x*]/ ).map( numberOf );
		return weight === undefined ? { f0 } : { f0, weight };
	};
	const pass = () => changed( input.hidden ? names[ main.selectedIndex ] : read() );
	const { input, read, show: showList } = list( { hidden: true, 'aria-label': 'F0 of the materials, separated by commas; add × and a weight if needed', placeholder: '1, 0.04 × 4' }, parse, ( { f0, weight = 1 } ) => weight === 1 ? f0 : `${ f0 } × ${ weight }`, pass );
	const main = el( 'select', { id, onchange: () => {
		input.hidden = main.selectedIndex < names.length;
		input.value ||= '0.04';
		pass();
	} }, [ ...names, 'list of F0' ].map( ( option ) => el( 'option', {}, option ) ) );
	const show = ( value = names[ 0 ] ) => {
		if ( isEdited( input ) ) return;
		input.hidden = ! Array.isArray( value );
		main.selectedIndex = input.hidden ? names.indexOf( value ) : names.length;
		if ( ! input.hidden ) showList( value );
	};
	return { parts: [ main, input ], main, show };
}

/** The input for roughnesses: alpha `0.3`, alpha and ratio `0.3 × 0.5`, or alpha along and across `0.4 / 0.1`. */
function roughnesses( field, id, changed ) {
	const parse = ( text ) => {
		const [ , first, sign, second ] = /^([^×x*/]*)([×x*/]?)(.*)$/s.exec( text );
		if ( sign === '/' ) return { alpha_x: numberOf( first ), alpha_y: numberOf( second ) };
		return sign ? { alpha: numberOf( first ), ratio: numberOf( second ) } : { alpha: numberOf( first ) };
	};
	const write = ( { alpha, ratio = 1, alpha_x, alpha_y } ) => alpha_x !== undefined ? `${ alpha_x } / ${ alpha_y }` : ratio === 1 ? alpha : `${ alpha } × ${ ratio }`;
	// An empty text removes the list, because only one layout allows a list.
	const { input, read, show } = list( { id, placeholder: '0.4 / 0.1, 0.3 × 0.5, 0.09', title: 'A comma-separated list. Each item is alpha, alpha × ratio, or alpha along / alpha across' }, parse, write, () => changed( input.value.trim() === '' ? undefined : read() ) );
	return { parts: [ input ], main: input, show };
}

const KINDS = { choice, whole, interval, materials, roughnesses };

/**
 * A field with its label and its errors. `changed` is called with each value that the user enters. `show` sets the value, and
 * `showFaults` sets the errors.
 */
export function input( field, changed ) {
	const id = `field${ field.pointer.replaceAll( '/', '-' ) }`;
	const { parts, main, show } = KINDS[ field.kind ]( field, id, changed );
	const fault = el( 'p', { class: 'fault', id: `${ id }-fault` } );
	main.setAttribute( 'aria-describedby', fault.id );
	const row = el( 'div', { class: `field ${ field.kind }` }, el( 'label', { for: id }, field.label ), el( 'div', { class: 'inputs' }, parts ), fault );
	const showFaults = ( details ) => {
		fault.textContent = details.join( '; ' );
		main.setAttribute( 'aria-invalid', details.length > 0 );
		row.classList.toggle( 'bad', details.length > 0 );
	};
	return { field, row, show, showFaults };
}
