// Inputs of the form: each reads and shows one member of a recipe.

import { el } from '../elements/dom.js';
import { number } from '../elements/format.js';

/** Positions of a slider: the top of a range is reached to the last digit. */
const STEPS = 200;

function choice( field, id, changed ) {

	const select = el( 'select', { id, onchange: () => changed( field.options[ select.selectedIndex ] ) }, field.options.map( ( option ) => el( 'option', {}, String( option ) ) ) );
	return { parts: [ select ], main: select, show: ( value ) => select.selectedIndex = field.options.indexOf( value ) };

}

function whole( field, id, changed ) {

	const input = el( 'input', { type: 'number', id, min: field.min, max: field.max, step: 1, inputmode: 'numeric', oninput: () => changed( read() ) } );
	// An empty field is that of the preset.
	const read = () => input.value === '' ? undefined : Number( input.value );
	const show = ( value ) => {

		if ( document.activeElement !== input && value !== undefined ) input.value = value;

	};

	return { parts: [ input ], main: input, show };

}

function interval( field, id, changed ) {

	const names = [ 'from', 'to' ];
	const output = el( 'output', { class: 'number' } );
	const ends = names.map( ( name, i ) => el( 'input', { type: 'range', id: i ? `${ id }-to` : id, 'aria-label': `${ field.label }, ${ name }`, min: 0, max: STEPS, step: 1, oninput: () => changed( read() ) } ) );
	const read = () => {

		const values = ends.map( ( { value } ) => Number( value ) === STEPS ? field.max : Number( value ) / STEPS * field.max );
		tell( values );
		return values;

	};

	const tell = ( values ) => output.textContent = values.map( number ).join( ' – ' );
	const show = ( values ) => {

		if ( ! Array.isArray( values ) || values.length !== 2 || ! values.every( Number.isFinite ) ) return;
		tell( values );
		values.forEach( ( value, i ) => {

			// A value between two positions stays what it is until the slider is moved.
			if ( document.activeElement !== ends[ i ] ) ends[ i ].value = Math.round( value / field.max * STEPS );

		} );

	};

	return { parts: [ el( 'span', { class: 'interval' }, ends ), output ], main: ends[ 0 ], show };

}

/** A material from its text: an F0, or an F0 and its weight, `0.04 × 4`. */
function material( text ) {

	const [ f0, weight ] = text.split( /[×x*]/ ).map( ( part ) => part.trim() === '' ? null : Number( part ) );
	return weight === undefined ? { f0 } : { f0, weight };

}

function materials( field, id, changed ) {

	const named = [ 'one', 'two_lobes', 'blended_lobes' ];
	const select = el( 'select', { id, onchange: () => changed( read() ) }, [ ...named, 'by F0' ].map( ( option ) => el( 'option', {}, option ) ) );
	const list = el( 'input', { type: 'text', 'aria-label': 'F0 of the materials, each with its weight where it is not 1, with commas between', placeholder: '1, 0.04 × 4', value: '0.04', hidden: true, oninput: () => changed( read() ) } );
	const read = () => {

		const isList = select.selectedIndex === named.length;
		list.hidden = ! isList;
		return isList ? list.value.split( ',' ).map( material ) : named[ select.selectedIndex ];

	};

	const show = ( value ) => {

		if ( list === document.activeElement ) return;
		const isList = Array.isArray( value );
		select.selectedIndex = isList ? named.length : named.indexOf( value );
		list.hidden = ! isList;
		if ( isList ) list.value = value.map( Object ).map( ( { f0, weight = 1 } ) => weight === 1 ? f0 : `${ f0 } × ${ weight }` ).join( ', ' );

	};

	return { parts: [ select, list ], main: select, show };

}

/** A surface from its text: alpha, `0.3`; alpha and ratio, `0.3 × 0.5`; or the roughness along and across, `0.4 / 0.1`. */
function roughness( text ) {

	const [ , first, sign, second ] = /^([^×x*/]*)([×x*/]?)(.*)$/s.exec( text );
	const number = ( part ) => part.trim() === '' ? null : Number( part );
	if ( sign === '/' ) return { alpha_x: number( first ), alpha_y: number( second ) };
	return sign ? { alpha: number( first ), ratio: number( second ) } : { alpha: number( first ) };

}

function roughnesses( field, id, changed ) {

	// No text is no list, which other layouts need.
	const read = () => input.value.trim() === '' ? undefined : input.value.split( ',' ).map( roughness );
	const input = el( 'input', { type: 'text', id, placeholder: '0.4 / 0.1, 0.3 × 0.5, 0.09', title: 'Each alpha, alpha × ratio, or alpha along / across, with commas between', oninput: () => changed( read() ) } );
	const text = ( { alpha, ratio = 1, alpha_x: along, alpha_y: across } ) => along !== undefined ? `${ along } / ${ across }` : ratio === 1 ? alpha : `${ alpha } × ${ ratio }`;
	const show = ( value ) => {

		if ( document.activeElement !== input ) input.value = Array.isArray( value ) ? value.map( ( item ) => text( Object( item ) ) ).join( ', ' ) : '';

	};

	return { parts: [ input ], main: input, show };

}

const KINDS = { choice, whole, interval, materials, roughnesses };

/**
 * A field with its label and the place of its faults. `changed` gets the value that was entered; `show` takes the one that is
 * in force, `blame` its faults.
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
