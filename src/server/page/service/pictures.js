// Pictures that the service renders. It renders one at a time and lets a few wait, so they are asked for in turn.

import { isIsotropic } from '../elements/format.js';
import { pictureFrom } from './api.js';

/** Pictures that are asked for at the same time. */
const AT_ONCE = 2;

const waiting = [];
const failed = [];
let asked = 0;

/** The address of a table's picture in a mode: its own kind of surface on a sphere under a rectangle. */
export function previewOf( recipe, table, size, mode = 'ltc' ) {

	const roughness = isIsotropic( recipe ) ? { alpha_x: 0.2, alpha_y: 0.2 } : { alpha_x: 0.5, alpha_y: 0.1, rotation: 0.6 };
	const colour = recipe.brdf === 'ggx' || recipe.brdf === 'beckmann' ? {} : { f0: '1,1,1' };
	return `/v1/preview?${ new URLSearchParams( { table, mode, size, ...roughness, ...colour } ) }`;

}

/** Shows the picture at an address in an image element once its turn comes, unless the page was left by then; done when it is shown. */
export function load( image, from, signal ) {

	return new Promise( ( shown ) => {

		waiting.push( { image, from, signal, shown } );
		next();

	} );

}

async function next() {

	if ( asked >= AT_ONCE || ! waiting.length ) return;
	const { image, from, signal, shown } = waiting.shift();
	asked ++;
	if ( ! signal.aborted ) {

		try {

			image.src = await pictureFrom( from );
			await image.decode();

		} catch {

			// A picture that fails leaves its text in its place, and may only lack the service.
			failed.push( { image, from, signal, shown } );

		}

		if ( image.src.startsWith( 'blob:' ) ) URL.revokeObjectURL( image.src );

	}

	asked --;
	shown();
	next();

}

window.addEventListener( 'serviceback', () => {

	waiting.push( ...failed.splice( 0 ) );
	next();

} );
