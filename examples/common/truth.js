// The truth for every pixel of the scene, from adaptive quadrature in double precision by `ltcforge light --truth`. It shares
// no code with the shaders. Surfaces reflect light once. Nothing casts a shadow.

import { spawn } from 'node:child_process';
import { availableParallelism } from 'node:os';

import { lightsOf, seenBy, surfaces } from './scene.js';

/**
 * @param {string} ltcforge - The program.
 * @returns {Promise<Float32Array>} Red, green and blue radiance and the surface's number for each pixel, from the top left.
 * The number is -1 for a light, and -2 for the background.
 */
export async function truth( ltcforge, width, height, count = 1 ) {

	const lights = lightsOf( count );
	const pixels = new Float32Array( width * height * 4 );
	const asked = [];
	const rows = [];
	for ( let i = 0; i < width * height; i ++ ) {

		const seen = seenBy( i % width, Math.floor( i / width ), width, height, lights );
		pixels.set( seen && seen.surface === - 1 ? lights[ seen.light ].radiance : [ 0, 0, 0 ], 4 * i );
		pixels[ 4 * i + 3 ] = seen ? seen.surface : - 2;
		if ( ! seen || seen.surface < 0 ) continue;

		const [ x, y, z ] = seen.view;
		seen.corners.forEach( ( corners, light ) => {

			asked.push( [ i, lights[ light ] ] );
			rows.push( [ ...surfaces[ seen.surface ].alpha, Math.acos( z ), Math.atan2( y, x ), 1, ...corners.flat() ].join( ',' ) );

		} );

	}

	// Each process uses one core.
	const share = Math.ceil( rows.length / availableParallelism() );
	const shares = [];
	for ( let start = 0; start < rows.length; start += share ) shares.push( reflected( ltcforge, rows.slice( start, start + share ) ) );
	const answers = ( await Promise.all( shares ) ).flat();
	asked.forEach( ( [ i, light ], n ) => {

		const { energy, fresnel } = answers[ n ];
		surfaces[ pixels[ 4 * i + 3 ] ].f0.forEach( ( f0, channel ) => {

			pixels[ 4 * i + channel ] += light.radiance[ channel ] * ( f0 * ( energy - fresnel ) + fresnel );

		} );

	} );
	return pixels;

}

/**
 * The reflected light of surfaces for a light of radiance one.
 *
 * @param {string} ltcforge - The program.
 * @param {string[]} rows - For each surface: alpha_x, alpha_y, theta, phi, sides, x0, y0, z0 ...
 * @returns {Promise<{ energy: number, fresnel: number }[]>} Light for a Fresnel factor of one, and weighed by Schlick's.
 */
export function reflected( ltcforge, rows ) {

	return new Promise( ( resolve, reject ) => {

		const child = spawn( ltcforge, [ 'light', '-', '--truth' ], { stdio: [ 'pipe', 'pipe', 'inherit' ] } );
		let text = '';
		child.stdout.setEncoding( 'utf8' ).on( 'data', ( part ) => text += part );
		child.on( 'error', reject );
		// If the program ends early, its exit code shows the reason.
		child.stdin.on( 'error', () => {} ).end( rows.join( '\n' ) + '\n' );
		child.on( 'close', ( code ) => {

			const [ names, ...lines ] = text.trimEnd().split( '\n' );
			if ( code !== 0 ) return reject( new Error( `${ ltcforge } light ended with exit code ${ code }` ) );
			if ( lines.length !== rows.length ) return reject( new Error( `${ lines.length } answers to ${ rows.length } questions` ) );
			const columns = names.split( ',' );
			const at = [ 'true_energy', 'true_fresnel' ].map( ( name ) => columns.indexOf( name ) );
			resolve( lines.map( ( line ) => {

				const numbers = line.split( ',' );
				return { energy: Number( numbers[ at[ 0 ] ] ), fresnel: Number( numbers[ at[ 1 ] ] ) };

			} ) );

		} );

	} );

}
