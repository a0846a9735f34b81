// Inputs of the viewer. Each shows one member of an object and reports changes.

import { el, fill } from '../elements/dom.js';
import { number } from '../elements/format.js';

/** A slider. `show` displays the slider's member of `values`. It can also change the label. A null label hides the slider. */
export function slider( { name, label, min, max, step }, prefix, change ) {
	const id = `view-${ prefix }${ name }`;
	const caption = el( 'label', { for: id }, label );
	const output = el( 'output', { for: id } );
	const input = el( 'input', { type: 'range', id, min, max, step, oninput: () => change( name, Number( input.value ) ) } );
	const row = el( 'div', { class: 'slider' }, caption, input, output );
	const show = ( values, text = label ) => {
		row.hidden = text === null;
		caption.textContent = text;
		input.value = values[ name ];
		output.textContent = number( values[ name ] );
	};
	return { name, row, show };
}

/** A select element. Options are values, or pairs of a value and a label. */
export function choice( id, label, options, value, change ) {
	const select = el( 'select', { id, onchange: () => change( select.value ) } );
	const offer = ( options, value ) => {
		fill( select, options.map( ( option ) => [ option ].flat() ).map( ( [ option, text = option ] ) => el( 'option', { value: option }, text ) ) );
		select.value = value;
	};
	offer( options, value );
	return { row: el( 'div', { class: 'field' }, el( 'label', { for: id }, label ), select ), offer };
}
