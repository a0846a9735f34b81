// Tables in the convention of 2017: 64 x 64 texels of four numbers, with roughness along rows and sqrt(1 - cos theta)
// along columns. The first texture has (Minv00, Minv20, Minv02, Minv22) divided by Minv11. The second has amplitude,
// Fresnel, 0, and the form factor of a clipped sphere.

import { readFile } from 'node:fs/promises';

import { DataUtils } from 'three';
import { RectAreaLightTexturesLib } from 'three/addons/lights/RectAreaLightTexturesLib.js';

const SIDE = 64;
const NUMBERS = SIDE * SIDE * 4;

/** Tables in the form of the harness: `ltc_1` and `ltc_2`, each with 16384 numbers. */
function tables( ltc_1, ltc_2, from ) {

	for ( const [ name, numbers ] of Object.entries( { ltc_1, ltc_2 } ) ) {

		const isFull = numbers?.length === NUMBERS && Array.from( numbers ).every( Number.isFinite );
		if ( ! isFull ) throw new Error( `${ from }: ${ name } must have ${ NUMBERS } finite numbers` );

	}

	return { ltc_1: Array.from( ltc_1 ), ltc_2: Array.from( ltc_2 ) };

}

/** The tables that three.js ships. Babylon and PlayCanvas have the same tables, but not in their packages. */
export function stock() {

	const { LTC_FLOAT_1, LTC_FLOAT_2 } = RectAreaLightTexturesLib.init();
	return tables( LTC_FLOAT_1.image.data, LTC_FLOAT_2.image.data, 'three.js' );

}

/** Tables of lobes that are rougher than they should be by 8 nodes of 63. */
export function wrong( { ltc_1, ltc_2 } ) {

	const shifted = ( numbers ) => numbers.map( ( _, i ) => {

		const texel = Math.floor( i / 4 );
		const column = Math.min( texel % SIDE + 8, SIDE - 1 );
		return numbers[ 4 * ( Math.floor( texel / SIDE ) * SIDE + column ) + i % 4 ];

	} );
	return tables( shifted( ltc_1 ), shifted( ltc_2 ), 'wrong tables' );

}

/** Tables of a file: JSON with `ltc_1` and `ltc_2`, or a module that exports LTC_1 and LTC_2. */
export async function fromFile( path ) {

	if ( path.endsWith( '.json' ) ) {

		const { ltc_1, ltc_2 } = JSON.parse( await readFile( path, 'utf8' ) );
		return tables( ltc_1, ltc_2, path );

	}

	const { LTC_1, LTC_2 } = await import( new URL( path, `file://${ process.cwd() }/` ) );
	return tables( LTC_1, LTC_2, path );

}

/** Files of tables that `ltcforge export --for` did not write, by its paths below a folder for each engine. */
export const repacked = {
	'three/ltc.js': forThree,
	'babylon/areaLights/areaLightsLTC.bin': forBabylon,
	'playcanvas/area-light-luts.json': forPlayCanvas,
};

/** A module with createLTC, whose textures have 32 bits. */
function forThree( { ltc_1, ltc_2 } ) {

	return `
		const texture = ( THREE, numbers ) => {
			const made = new THREE.DataTexture( new Float32Array( numbers ), ${ SIDE }, ${ SIDE }, THREE.RGBAFormat, THREE.FloatType );
			made.magFilter = THREE.LinearFilter;
			made.needsUpdate = true;
			return made;
		};
		export const createLTC = ( THREE ) => ( {
			LTC_FLOAT_1: texture( THREE, ${ JSON.stringify( ltc_1 ) } ), LTC_FLOAT_2: texture( THREE, ${ JSON.stringify( ltc_2 ) } ),
		} );`;

}

/** Two arrays, which PlayCanvas rounds itself. */
function forPlayCanvas( { ltc_1, ltc_2 } ) {

	return JSON.stringify( { LTC_MAT_1: ltc_1, LTC_MAT_2: ltc_2 } );

}

/** Eight half floats per texel, the first table before the second. */
function forBabylon( { ltc_1, ltc_2 } ) {

	const halves = new Uint16Array( 2 * NUMBERS );
	for ( let i = 0; i < NUMBERS; i ++ ) {

		const texel = 8 * Math.floor( i / 4 ) + i % 4;
		halves[ texel ] = DataUtils.toHalfFloat( ltc_1[ i ] );
		halves[ texel + 4 ] = DataUtils.toHalfFloat( ltc_2[ i ] );

	}

	return new Uint8Array( halves.buffer );

}
