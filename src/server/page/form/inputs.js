// Inputs of the form: each reads and shows one member of a recipe.

import { el } from '../elements/dom.js';
import { number } from '../elements/format.js';

/** Positions of a slider: the top of a range is reached to the last digit. */
const STEPS = 200;

/** A number from its text; the service refuses the others, which JSON has as null. */
const numberOf = ( text ) => text.trim() === '' ? NaN : Number( text );
/** Whether a member is being edited, so that it stays as it is written. */
const isHeld = ( input ) => document.activeElement === input;

function choice( { schema: { enum: options } }, id, changed ) {

	const main = el( 'select', { id, onchange: () => changed( options[ main.selectedIndex ] ) }, options.map( ( option ) => el( 'option', {}, String( option ) ) ) );
	return { parts: [ main ], main, show: ( value ) => main.selectedIndex = options.indexOf( value ?? options[ 0 ] ) };

}

function whole( { schema: { minimum: min, maximum: max } }, id, changed ) {

	// An empty field is that of the preset.
	const main = el( 'input', { type: 'number', id, min, max, step: 1, inputmode: 'numeric', oninput: () => changed( main.value === '' ? undefined : Number( main.value ) ) } );
	const show = ( value ) => {

		if ( ! isHeld( main ) && value !== undefined ) main.value = value;

	};

	return { parts: [ main ], main, show };

}

function interval( { label, schema: { items: { maximum } } }, id, changed ) {

	const output = el( 'output', { class: 'number' } );
	const tell = ( values ) => output.textContent = values.map( number ).join( ' – ' );
	const read = () => {

		const values = ends.map( ( { value } ) => Number( value ) === STEPS ? maximum : Number( value ) / STEPS * maximum );
		tell( values );
		changed( values );

	};

	const ends = [ 'from', 'to' ].map( ( name, i ) => el( 'input', { type: 'range', id: i ? `${ id }-to` : id, 'aria-label': `${ label }, ${ name }`, min: 0, max: STEPS, step: 1, oninput: read } ) );
	const show = ( values ) => {

		if ( ! Array.isArray( values ) || values.length !== 2 || ! values.every( Number.isFinite ) ) return;
		tell( values );
		// A value between two positions stays what it is until the slider is moved.
		ends.forEach( ( end, i ) => isHeld( end ) || ( end.value = Math.round( values[ i ] / maximum * STEPS ) ) );

	};

	return { parts: [ el( 'span', { class: 'interval' }, ends ), output ], main: ends[ 0 ], show };

}

/** An input of a list in text: items with commas between, which `parse` reads and `write` writes. */
function list( attributes, parse, write, changed ) {

	const input = el( 'input', { type: 'text', ...attributes, oninput: () => changed() } );
	const read = () => input.value.split( ',' ).map( parse );
	const show = ( value ) => {

		if ( ! isHeld( input ) ) input.value = Array.isArray( value ) ? value.map( ( item ) => write( Object( item ) ) ).join( ', ' ) : '';

	};

	return { input, read, show };

}

/** Materials by name, or by a list of F0, each with its weight where it is not 1: `1, 0.04 × 4`. */
function materials( { schema: { anyOf: [ { enum: names } ] } }, id, changed ) {

	const parse = ( text ) => {

		const [ f0, weight ] = text.split( /[×x*]/ ).map( numberOf );
		return weight === undefined ? { f0 } : { f0, weight };

	};

	const tell = () => changed( input.hidden ? names[ main.selectedIndex ] : read() );
	const { input, read, show: showList } = list( { hidden: true, 'aria-label': 'F0 of the materials, each with its weight where it is not 1, with commas between', placeholder: '1, 0.04 × 4' }, parse, ( { f0, weight = 1 } ) => weight === 1 ? f0 : `${ f0 } × ${ weight }`, tell );
	const main = el( 'select', { id, onchange: () => {

		input.hidden = main.selectedIndex < names.length;
		input.value ||= '0.04';
		tell();

	} }, [ ...names, 'by F0' ].map( ( option ) => el( 'option', {}, option ) ) );
	const show = ( value = names[ 0 ] ) => {

		if ( isHeld( input ) ) return;
		input.hidden = ! Array.isArray( value );
		main.selectedIndex = input.hidden ? names.indexOf( value ) : names.length;
		if ( ! input.hidden ) showList( value );

	};

	return { parts: [ main, input ], main, show };

}

/** Surfaces in a list: alpha, `0.3`; alpha and ratio, `0.3 × 0.5`; or the roughness along and across, `0.4 / 0.1`. */
function roughnesses( field, id, changed ) {

	const parse = ( text ) => {

		const [ , first, sign, second ] = /^([^×x*/]*)([×x*/]?)(.*)$/s.exec( text );
		if ( sign === '/' ) return { alpha_x: numberOf( first ), alpha_y: numberOf( second ) };
		return sign ? { alpha: numberOf( first ), ratio: numberOf( second ) } : { alpha: numberOf( first ) };

	};

	const write = ( { alpha, ratio = 1, alpha_x, alpha_y } ) => alpha_x !== undefined ? `${ alpha_x } / ${ alpha_y }` : ratio === 1 ? alpha : `${ alpha } × ${ ratio }`;
	// No text is no list, which other layouts need.
	const { input, read, show } = list( { id, placeholder: '0.4 / 0.1, 0.3 × 0.5, 0.09', title: 'Each alpha, alpha × ratio, or alpha along / across, with commas between' }, parse, write, () => changed( input.value.trim() === '' ? undefined : read() ) );
	return { parts: [ input ], main: input, show };

}

const KINDS = { choice, whole, interval, materials, roughnesses };

/**
 * A field with its label and the place of its errors. `changed` gets the value that was entered; `show` takes the one that is
 * in force, `blame` its errors.
 */
export function input( field, changed ) {

	const id = `field${ field.pointer.replaceAll( '/', '-' ) }`;
	const { parts, main, show } = KINDS[ field.kind ]( field, id, changed );
	const fault = el( 'p', { class: 'fault', id: `${ id }-fault` } );
	main.setAttribute( 'aria-describedby', fault.id );
	const row = el( 'div', { class: `field ${ field.kind }` }, el( 'label', { for: id }, field.label ), el( 'div', { class: 'inputs' }, parts ), fault );
	const blame = ( details ) => {

		fault.textContent = details.join( '; ' );
		main.setAttribute( 'aria-invalid', details.length > 0 );
		row.classList.toggle( 'bad', details.length > 0 );

	};

	return { field, row, show, blame };

}
