// Names of recipes and tables, and links to the form.

import { button, el, section } from './dom.js';
import { number, percent, short } from './format.js';

/** The name of the labels that users give to tables, in the browser's storage. */
const LABELS = 'ltcforge labels';

/** All labels by digest. Some private windows have no storage. */
function labels() {
	try {
		return JSON.parse( localStorage.getItem( LABELS ) ) ?? {};
	} catch {
		return {};
	}
}

/** The label of a table, or an empty text. */
export const labelOf = ( digest ) => labels()[ digest ] ?? '';

/** Keeps the label of a table in this browser. An empty text removes the label. Throws an error if the browser has no storage. */
export function keepLabel( digest, text ) {
	localStorage.setItem( LABELS, JSON.stringify( { ...labels(), [ digest ]: text || undefined } ) );
}

/** Indented JSON. A list of numbers or strings is on one line. */
export function json( value ) {
	return JSON.stringify( value, null, 2 ).replace( /\[[^[\]{}]*\]/g, ( list ) => list.replace( /\s+/g, ' ' ) );
}

/** Whether a recipe is for a BRDF lookup table. Such a table has no lobes, so it lights no surface. */
export const isLookup = ( { table } ) => table !== undefined && table !== 'ltc';

/** A short title of a recipe. */
export function title( { table, brdf, form, layout, resolution, precision, lobe, fresnel } ) {
	const nodes = [ 'alpha', 'ratio', 'theta', 'phi', 'roughness', 'cos_theta' ].map( ( axis ) => resolution[ axis ] ).filter( ( count ) => count > 1 );
	const materials = Array.isArray( fresnel ) ? `F0 ${ fresnel.map( ( { f0 } ) => f0 ).join( ', ' ) }` : fresnel?.replaceAll( '_', ' ' );
	return [ table, brdf, form, layout, nodes.join( ' × ' ) || '1', precision, lobe, materials ].filter( Boolean ).join( ' · ' );
}

/** The title of a table's recipe, with its range if it is a part. */
export function wholeTitle( recipe ) {
	const { alpha, ratio } = recipe.range ?? {};
	const part = [ [ 'alpha', alpha ], [ 'ratio', ratio ] ].filter( ( [ , range ] ) => range && ( range[ 0 ] > 1e-3 || range[ 1 ] < 1 ) ).map( ( [ of, [ from, to ] ] ) => from === to ? `${ of } ${ number( from ) }` : `${ of } ${ number( from ) } to ${ number( to ) }` );
	return [ title( recipe ), ...part ].join( ' · ' );
}

/** The name of a table in menus: its label, or the title of its recipe, and the first digits of its digest. */
export function nameOf( { digest, recipe } ) {
	return [ labelOf( digest ) || ( recipe && wholeTitle( recipe ) ), short( digest ) ].filter( Boolean ).join( ' · ' );
}

/** Whether all surfaces of a recipe are isotropic. */
export const isIsotropic = ( { range } ) => range.ratio[ 0 ] === 1;

/** The surfaces for which a table is fitted. Errors of tables are comparable if this text is the same. */
export const domain = ( { brdf, fresnel, range, materials } ) => JSON.stringify( [ brdf, fresnel, range, materials ] );

/** The name and the text of the error in a forecast. */
export const expectedError = ( recipe, error ) => isLookup( recipe ) ? [ 'Mean error of a value', number( error ) ] : [ 'Lobe error over the range', percent( error ) ];

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
