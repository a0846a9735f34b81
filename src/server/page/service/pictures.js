// Loads pictures that the service renders. Two pictures are requested at a time, because a browser opens only six connections to a service.

import { isIsotropic } from '../elements/recipe.js';
import { reach } from './api.js';

/** The promise for the last picture in each queue. */
const queues = [ Promise.resolve(), Promise.resolve() ];
let asked = 0;

/** The address of a preview: a sphere under a rectangular light, with a surface that suits the table. */
export function previewOf( recipe, table, size, mode = 'ltc' ) {
	const roughness = isIsotropic( recipe ) ? { alpha_x: 0.2, alpha_y: 0.2 } : { alpha_x: 0.5, alpha_y: 0.1, rotation: 0.6 };
	const colour = recipe.brdf === 'ggx' || recipe.brdf === 'beckmann' ? {} : { f0: '1,1,1' };
	return `/v1/preview?${ new URLSearchParams( { table, mode, size, ...roughness, ...colour } ) }`;
}

/** Queues a picture for an image element. Resolves when the picture is shown, or when `signal` has aborted. */
export function load( image, from, signal ) {
	const queue = asked ++ % queues.length;
	return queues[ queue ] = queues[ queue ].then( () => signal.aborted || shown( image, from, signal ) );
}

async function shown( image, from, signal ) {
	try {
		const response = await reach( from, { signal } );
		if ( response.status === 429 || response.status === 503 ) {
			// The service is busy. Until the picture comes, the page shows a placeholder.
			const seconds = Number( response.headers.get( 'retry-after' ) ) || 2;
			setTimeout( () => signal.aborted || load( image, from, signal ), 1000 * seconds );
			return;
		}
		if ( ! response.ok ) throw new Error( `status ${ response.status }` );
		image.src = URL.createObjectURL( await response.blob() );
		await image.decode();
	} catch {
		// The page shows the alternative text. If the service was lost, the picture is loaded again when it is back.
		window.addEventListener( 'serviceback', () => load( image, from, signal ), { once: true, signal } );
	}
	if ( image.src.startsWith( 'blob:' ) ) URL.revokeObjectURL( image.src );
}
