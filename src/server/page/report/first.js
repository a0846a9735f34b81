// What a list of tables shows while the service has none: a sphere by the closed form, and a button that fits the first table.

import { el, fill, muted, notice } from '../elements/dom.js';
import { percent } from '../elements/format.js';
import { fitted } from '../service/jobs.js';
import { load } from '../service/pictures.js';

/** The element for a page without tables. */
export function firstTable( signal ) {
	const status = el( 'div', { role: 'status' } );
	const picture = el( 'img', { alt: 'A sphere under a rectangular light, lit by the closed form', width: 192, height: 192 } );
	const fit = el( 'button', { type: 'button', class: 'primary', onclick: async () => {
		fit.disabled = true;
		fill( status, muted( 'Fitting…' ) );
		try {
			const table = await fitted( { preset: 'standard' }, signal, ( { progress: { entries_done: done, entries_total: all } } ) => fill( status, muted( `Fitting… ${ percent( done / all, 0 ) }` ) ) );
			if ( ! signal.aborted ) location.hash = `#/tables/${ table }`;
		} catch ( error ) {
			fit.disabled = false;
			fill( status, notice( error.message ) );
		}
	} }, 'Fit the standard table (1 s)' );
	const root = el( 'div', { class: 'empty' }, picture, el( 'div', {},
		el( 'p', {}, 'This service has no tables yet. A table stores how a range of materials reflects area lights. The sphere is lit by a closed form, which needs no table.' ),
		el( 'p', { class: 'actions' }, fit, el( 'a', { class: 'button', href: '#/new' }, 'Write a recipe' ), el( 'a', { class: 'button', href: '#/viewer' }, 'Open the viewer' ) ), status ) );
	load( picture, `/v1/preview?${ new URLSearchParams( { model: 'normals', size: 384, alpha_x: 0.3, alpha_y: 0.1 } ) }`, signal );
	return root;
}
