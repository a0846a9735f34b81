// One table: what it is, how good it is, and the files for each engine.

import { copyLine, el, facts, fill } from '../elements/dom.js';
import { bytes, json, short, title } from '../elements/format.js';
import { downloads, save } from '../report/downloads.js';
import { inWords, plots } from '../report/quality.js';
import { address, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

export async function show( root, digest, parameters, signal ) {

	const about = await manifest( digest );
	const { recipe, report, recipe_digest } = about;
	const picture = el( 'img', { alt: 'A sphere under a rectangle of light: the reference, this table, and their difference', width: 776, height: 314 } );
	const isShown = load( picture, previewOf( recipe, digest, 256, 'strip' ), signal );
	const variation = { ...recipe };
	delete variation.fitter;
	fill( root,
		el( 'div', { class: 'bar' }, el( 'h1', {}, title( recipe ) ), el( 'span', { class: 'grow' } ),
			el( 'a', { class: 'button', href: `#/new?${ new URLSearchParams( { recipe: JSON.stringify( variation ) } ) }` }, 'Fit a variation' ),
			el( 'a', { class: 'button', href: `#/compare?tables=${ digest }` }, 'Compare' ),
			el( 'a', { class: 'button', href: `#/viewer?${ new URLSearchParams( { table: digest } ) }` }, 'View' ) ),
		el( 'div', { class: 'halves' },
			el( 'section', { 'aria-labelledby': 'identity' }, el( 'h2', { id: 'identity' }, 'Identity' ),
				el( 'div', { class: 'label' }, 'Digest' ), copyLine( 'Digest', digest ),
				el( 'div', { class: 'label' }, 'Pin it in a project' ), copyLine( 'Lock line', `ltcforge lock NAME ${ digest } --from ${ address( '/' ).replace( /\/$/, '' ) }` ),
				facts( [
					[ 'Size', bytes( about.bytes ) ], [ 'Entries', about.entries.toLocaleString( 'en' ) ],
					[ 'Recipe', el( 'code', {}, short( recipe_digest ) ) ], [ 'Fitter', recipe.fitter ],
				] ),
				el( 'p', {}, el( 'a', { class: 'button primary', href: address( `/v1/tables/${ digest }` ), download: true, onclick: save }, `Download .safetensors, ${ bytes( about.bytes ) }` ) ) ),
			el( 'section', { class: 'shown' }, picture ) ),
		el( 'section', { 'aria-labelledby': 'quality' }, el( 'h2', { id: 'quality' }, 'Quality' ), inWords( report ) ),
		plots( digest, recipe, isShown, signal ),
		downloads( digest, signal ),
		el( 'section', { 'aria-labelledby': 'recipe' }, el( 'h2', { id: 'recipe' }, 'Recipe' ), el( 'pre', { tabindex: 0, role: 'region', 'aria-label': 'Recipe as JSON' }, json( recipe ) ) ) );
	// What is told of a table never changes, and nothing is asked anew.
	return () => {};

}
