// Errors of both sides against the truth, from sums over square tiles of pixels.
//
// The truth has two independent halves. The sign of a tile's error comes from one half and its amount from the other half, so
// the noise of the truth does not add to the mean error. It reduces the mean error where it hides the sign. Larger tiles have
// less noise, but errors of both signs cancel in them. So the mean error of any tiles is too small, and the largest is best.

/** Sizes of tiles to compare: each is twice as wide as the one before. */
const SIZES = 5;
/** Numbers of a tile: pixels, light of the left and of the right side, squared noise, and light of the truth by each half. */
const [ PIXELS, LEFT, NOISE, EVEN, ODD ] = [ 0, 1, 3, 4, 5 ];
const NUMBERS = 6;

/** The tiles of an image with `width` tiles per side, each with `NUMBERS` numbers. */
const tilesOf = ( width ) => ( { width, numbers: new Float64Array( NUMBERS * width * width ) } );

/** The sum of each square of 2 x 2 tiles. */
function merged( { width, numbers } ) {
	const wide = tilesOf( Math.ceil( width / 2 ) );
	for ( let y = 0; y < width; y ++ ) for ( let x = 0; x < width; x ++ ) {
		const [ from, to ] = [ NUMBERS * ( y * width + x ), NUMBERS * ( ( y >> 1 ) * wide.width + ( x >> 1 ) ) ];
		for ( let i = 0; i < NUMBERS; i ++ ) wide.numbers[ to + i ] += numbers[ from + i ];
	}
	return wide;
}

/** The sum of a number over all tiles. */
function total( { numbers }, which ) {
	let sum = 0;
	for ( let at = which; at < numbers.length; at += NUMBERS ) sum += numbers[ at ];
	return sum;
}

/** The sum of the errors of a side, and the largest error per pixel that both halves of the truth confirm. */
function compared( { numbers }, side ) {
	let [ sum, worst ] = [ 0, 0 ];
	for ( let at = 0; at < numbers.length; at += NUMBERS ) {
		const light = numbers[ at + LEFT + side ];
		const [ a, b ] = [ light - numbers[ at + EVEN ], light - numbers[ at + ODD ] ];
		const isSure = a * b > 0;
		sum += ( isSure ? 0.5 : - 0.5 ) * ( Math.abs( a ) + Math.abs( b ) );
		if ( isSure ) worst = Math.max( worst, Math.min( Math.abs( a ), Math.abs( b ) ) / numbers[ at + PIXELS ] );
	}
	return { sum, worst };
}

/**
 * The errors of both sides: mean and largest, the noise of the truth (root of the mean square), and the difference of both
 * sides that 95 % of the picture do not exceed. All but the difference are relative to the mean light, or to `light` if it is
 * given. `sums` and `truths` have four numbers per tile. Returns null without light.
 */
export function errorsOf( { width, sums, truths }, hasRight, light ) {
	const tiles = tilesOf( width );
	for ( let i = 0; i < width * width; i ++ ) for ( let k = 0; k < NUMBERS; k ++ ) tiles.numbers[ NUMBERS * i + k ] = k < EVEN ? sums[ 4 * i + k ] : truths[ 4 * i + k - EVEN ];
	const pixels = total( tiles, PIXELS );
	light ??= ( total( tiles, EVEN ) + total( tiles, ODD ) ) / 2 / pixels;
	if ( ! ( light > 0 && pixels > 0 ) ) return null;
	const ofSizes = [ tiles ];
	while ( ofSizes.length < SIZES ) ofSizes.push( merged( ofSizes.at( - 1 ) ) );
	const sides = [ 0, 1 ].slice( 0, 1 + hasRight ).map( ( side ) => {
		const all = ofSizes.map( ( of ) => compared( of, side ) );
		return { mean: Math.max( 0, ...all.map( ( { sum } ) => sum ) ) / pixels / light, worst: all[ 0 ].worst / light };
	} );
	const [ , { numbers } ] = ofSizes;
	const apart = ( at ) => Math.abs( numbers[ at + LEFT ] - ( hasRight ? numbers[ at + LEFT + 1 ] : 0.5 * ( numbers[ at + EVEN ] + numbers[ at + ODD ] ) ) ) / numbers[ at + PIXELS ];
	const differences = Float64Array.from( { length: numbers.length / NUMBERS }, ( _, i ) => apart( NUMBERS * i ) ).filter( ( difference ) => difference >= 0 ).sort();
	return { sides, noise: Math.sqrt( total( tiles, NOISE ) / pixels ) / light, light, difference: differences[ Math.floor( 0.95 * ( differences.length - 1 ) ) ] };
}
