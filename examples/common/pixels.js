// Pictures of the scene as numbers: the order of their rows, and their error.

/**
 * The mean absolute error of linear radiance over the surfaces. Pixels at edges are left out, because rasterizers may assign
 * them to different surfaces.
 *
 * @param {ArrayLike<number>} pixels - Four numbers a pixel, from the top left.
 * @param {ArrayLike<number>} truth - The result of `truth.js`. The fourth number is the surface; it is negative elsewhere.
 */
export function meanError( pixels, truth, width, height ) {

	const surfaceAt = ( column, row ) => truth[ 4 * ( row * width + column ) + 3 ];
	let total = 0;
	let count = 0;
	for ( let row = 1; row < height - 1; row ++ ) {

		for ( let column = 1; column < width - 1; column ++ ) {

			const surface = surfaceAt( column, row );
			const around = [ [ 1, 0 ], [ - 1, 0 ], [ 0, 1 ], [ 0, - 1 ] ].map( ( [ x, y ] ) => surfaceAt( column + x, row + y ) );
			if ( surface < 0 || around.some( ( other ) => other !== surface ) ) continue;
			for ( let i = 4 * ( row * width + column ), end = i + 3; i < end; i ++ ) {

				total += Math.abs( pixels[ i ] - truth[ i ] );
				count ++;

			}

		}

	}

	return total / count;

}

/** Pixels of four numbers, reordered from bottom-left to top-left origin. */
export function fromTop( pixels, width, height ) {

	const turned = new Float32Array( pixels.length );
	for ( let row = 0; row < height; row ++ ) {

		turned.set( pixels.subarray( 4 * width * row, 4 * width * ( row + 1 ) ), 4 * width * ( height - 1 - row ) );

	}

	return turned;

}
