// Formats recipes for people, and makes links to the form.

import { button, el, section } from './dom.js';
import { number, short } from './format.js';

/** Indented JSON. A list of numbers or strings is on one line. */
export function json( value ) {
	return JSON.stringify( value, null, 2 ).replace( /\[[^[\]{}]*\]/g, ( list ) => list.replace( /\s+/g, ' ' ) );
}

/** A short title of a recipe. */
export function title( { brdf, layout, resolution, precision, lobe, fresnel } ) {
	const nodes = [ 'alpha', 'ratio', 'theta', 'phi' ].map( ( axis ) => resolution[ axis ] ).filter( ( count ) => count > 1 );
	const materials = Array.isArray( fresnel ) ? `F0 ${ fresnel.map( ( { f0 } ) => f0 ).join( ', ' ) }` : fresnel?.replaceAll( '_', ' ' );
	return [ brdf, layout, nodes.join( ' × ' ) || '1', precision, lobe, materials ].filter( Boolean ).join( ' · ' );
}

/** The name of a table in a list of the service: its title, its range if it is a part, and the first digits of its digest. */
export function nameOf( { digest, recipe } ) {
	const { alpha, ratio } = recipe?.range ?? {};
	const part = [ [ 'alpha', alpha ], [ 'ratio', ratio ] ].filter( ( [ , range ] ) => range && ( range[ 0 ] > 1e-3 || range[ 1 ] < 1 ) ).map( ( [ of, [ from, to ] ] ) => from === to ? `${ of } ${ number( from ) }` : `${ of } ${ number( from ) } to ${ number( to ) }` );
	return [ recipe && title( recipe ), ...part, short( digest ) ].filter( Boolean ).join( ' · ' );
}

/** Whether all surfaces of a recipe are isotropic. */
export const isIsotropic = ( { range } ) => range.ratio[ 0 ] === 1;

/** A complete recipe without the fitter version, which the service fills in. */
export function ownRecipe( { fitter, ...own } ) {
	return own;
}

/** The engines that tables are exported for: name of the export, label, and the layout that the engine reads; your own renderer reads all. */
export const ENGINES = [ [ 'three', 'three.js', 'ltc2017' ], [ 'babylon', 'Babylon.js', 'ltc2017' ], [ 'playcanvas', 'PlayCanvas', 'ltc2017' ], [ 'bevy', 'Bevy', 'ltc2017' ], [ 'godot', 'Godot', 'godot' ], [ 'hdrp', 'Unity HDRP', 'hdrp' ], [ 'o3de', 'O3DE', 'ltc2016' ], [ 'wgpu', 'your own renderer' ] ];
/** The address of the form filled with a recipe. */
export const formOf = ( recipe ) => `#/new?${ new URLSearchParams( { recipe: JSON.stringify( recipe ) } ) }`;
/** A link to the form that starts from a complete recipe. */
export const variation = ( recipe ) => button( formOf( ownRecipe( recipe ) ), 'Fit a variation' );

/** The section that shows a recipe as JSON. */
export function recipeSection( recipe ) {
	return section( 'recipe', 'Recipe', el( 'pre', { tabindex: 0, role: 'region', 'aria-label': 'Recipe as JSON' }, json( recipe ) ) );
}
