// Inputs of the viewer: each shows one member of an object and tells when it is changed.

import { el, fill } from '../elements/dom.js';
import { number } from '../elements/format.js';

/** A slider of a number; `tell` shows the value of an object, under the label that is given or its own. */
export function slider( { name, label, min, max, step }, prefix, change ) {

	const id = `view-${ prefix }${ name }`;
	const caption = el( 'label', { for: id }, label );
	const output = el( 'output', { for: id } );
	const input = el( 'input', { type: 'range', id, min, max, step, oninput: () => change( name, Number( input.value ) ) } );
	const row = el( 'div', { class: 'slider' }, caption, input, output );
	const tell = ( values, text = label ) => {

		row.hidden = text === null;
		caption.textContent = text;
		input.value = values[ name ];
		output.textContent = number( values[ name ] );

	};

	return { name, row, tell };

}

/** A choice of one of several; options are values, or pairs of a value and a label. */
export function choice( id, label, options, value, change ) {

	const select = el( 'select', { id, onchange: () => change( select.value ) } );
	const offer = ( options, value ) => {

		fill( select, options.map( ( option ) => [ option ].flat() ).map( ( [ option, text = option ] ) => el( 'option', { value: option }, text ) ) );
		select.value = value;

	};

	offer( options, value );
	return { row: el( 'div', { class: 'field' }, el( 'label', { for: id }, label ), select ), offer };

}

/** Tells how far a pointer is dragged over an element, in halves of the picture, y upwards, and whether Shift is held. */
export function drag( element, onMove ) {

	element.addEventListener( 'pointerdown', ( event ) => {

		event.stopPropagation();
		event.preventDefault();
		element.setPointerCapture( event.pointerId );
		const half = ( element.ownerSVGElement || element ).getBoundingClientRect().width / 2;
		const ended = new AbortController();
		let [ x, y ] = [ event.clientX, event.clientY ];
		const move = ( to ) => {

			onMove( ( to.clientX - x ) / half, ( y - to.clientY ) / half, to.shiftKey );
			[ x, y ] = [ to.clientX, to.clientY ];

		};

		element.addEventListener( 'pointermove', move, { signal: ended.signal } );
		element.addEventListener( 'lostpointercapture', () => ended.abort(), { once: true } );

	} );

}
