// The form for the lights. Users select, add and remove lights, and change the shape and the numbers of the selected light.

import { el, fill } from '../elements/dom.js';
import { choice, slider } from './controls.js';
import { addedLight, isFlat, LIGHT_SHAPES, LIT_SIDES, MOST_LIGHTS, OF_LIGHT } from './scene.js';
import { screens } from './screens.js';

/** The fields of a scene's lights. `changed` is called after each change, and `again` when the user starts or pauses a video. */
export function lightsPanel( scene, changed, again ) {
	let chosen = 0;
	const shapes = Object.keys( LIGHT_SHAPES );
	const change = ( name, value ) => {
		scene.lights[ chosen ][ name ] = value;
		changed();
	};
	const shape = choice( 'view-light_shape', 'Shape', shapes, scene.lights[ 0 ].shape, ( value ) => change( 'shape', value ) );
	const sides = choice( 'view-light_sides', 'Emits from', Object.entries( LIT_SIDES ), '', ( value ) => change( 'sides', value ) );
	const tint = el( 'input', { type: 'color', id: 'view-light_colour', oninput: () => change( 'colour', tint.value ) } );
	const colour = el( 'div', { class: 'field' }, el( 'label', { for: tint.id }, 'Colour' ), tint );
	const shown = screens( ( value ) => change( 'picture', value ), again );
	const sliders = OF_LIGHT.map( ( field ) => slider( field, 'light_', change ) );
	const button = ( text, onclick ) => el( 'button', { type: 'button', class: 'quiet', onclick }, text );
	const add = button( 'Add', () => {
		chosen = scene.lights.length;
		scene.lights.push( addedLight( chosen ) );
		changed();
	} );
	const remove = button( 'Remove', () => {
		scene.lights.splice( chosen, 1 );
		chosen = Math.min( chosen, scene.lights.length - 1 );
		changed();
	} );
	const numbers = el( 'span', { class: 'chosen', role: 'group', 'aria-label': 'Light to change' } );

	function show() {
		const light = scene.lights[ chosen ];
		const [ width, height ] = LIGHT_SHAPES[ light.shape ].sizes;
		fill( numbers, scene.lights.map( ( _, i ) => el( 'button', { type: 'button', class: 'quiet', 'aria-pressed': String( i === chosen ), 'aria-label': `Light ${ i + 1 }`, onclick: () => choose( i ) }, String( i + 1 ) ) ) );
		add.disabled = scene.lights.length === MOST_LIGHTS;
		remove.disabled = scene.lights.length === 1;
		shape.offer( shapes.filter( ( name ) => name !== 'polygon' || light.outline ), light.shape );
		sides.offer( Object.entries( LIT_SIDES ), light.sides );
		sides.row.hidden = ! isFlat( light );
		tint.value = light.colour;
		shown.show( light );
		for ( const control of sliders ) control.show( light, { width, height }[ control.name ] );
		for ( const { name, row } of sliders ) if ( [ 'yaw', 'pitch', 'roll' ].includes( name ) ) row.hidden = light.shape === 'sphere';
	}

	function choose( i ) {
		chosen = i;
		changed();
		// `changed` has replaced the buttons, so the new button needs the focus.
		numbers.children[ i ].focus();
	}
	return {
		row: [ el( 'div', { class: 'bar' }, numbers, el( 'span', { class: 'grow' } ), add, remove ), shape.row, colour, sides.row, shown.row, sliders.map( ( { row } ) => row ) ],
		show,
		take: ( i ) => chosen = i,
		chosen: () => chosen,
		layers: () => shown.layers( scene.lights ),
		release: shown.release,
	};
}
