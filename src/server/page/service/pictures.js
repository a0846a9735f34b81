// Pictures that the service renders, asked for two at a time: a browser has six connections to a service.

import { isIsotropic } from '../elements/recipe.js';
import { pictureFrom } from './api.js';

/** The last picture of each queue. */
const queues = [ Promise.resolve(), Promise.resolve() ];
let asked = 0;

/** The address of a table's picture in a mode: its own kind of surface on a sphere under a rectangle. */
export function previewOf( recipe, table, size, mode = 'ltc' ) {

	const roughness = isIsotropic( recipe ) ? { alpha_x: 0.2, alpha_y: 0.2 } : { alpha_x: 0.5, alpha_y: 0.1, rotation: 0.6 };
	const colour = recipe.brdf === 'ggx' || recipe.brdf === 'beckmann' ? {} : { f0: '1,1,1' };
	return `/v1/preview?${ new URLSearchParams( { table, mode, size, ...roughness, ...colour } ) }`;

}

/** Shows the picture at an address in an image element once its turn comes, unless the page was left by then; done when it is shown. */
export function load( image, from, signal ) {

	const queue = asked ++ % queues.length;
	return queues[ queue ] = queues[ queue ].then( () => signal.aborted || shown( image, from, signal ) );

}

async function shown( image, from, signal ) {

	try {

		image.src = await pictureFrom( from );
		await image.decode();

	} catch {

		// A picture that fails leaves its text in its place, and may only lack the service.
		window.addEventListener( 'serviceback', () => load( image, from, signal ), { once: true, signal } );

	}

	if ( image.src.startsWith( 'blob:' ) ) URL.revokeObjectURL( image.src );

}
