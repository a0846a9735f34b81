// One table: digest, quality, and files for engines.

import { bar, button, copyLine, el, facts, fill, section } from '../elements/dom.js';
import { bytes, short, whole } from '../elements/format.js';
import { recipeSection, title, variation } from '../elements/recipe.js';
import { downloads, save } from '../report/downloads.js';
import { inWords, plots } from '../report/quality.js';
import { address, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

export async function show( root, digest, parameters, signal ) {
	const about = await manifest( digest );
	const { recipe, report, recipe_digest } = about;
	const picture = el( 'img', { alt: 'A sphere under a rectangular light: the reference, this table, and their difference', width: 776, height: 314 } );
	const isShown = load( picture, previewOf( recipe, digest, 256, 'strip' ), signal );
	fill( root,
		bar( title( recipe ), null, variation( recipe ), button( `#/compare?tables=${ digest }`, 'Compare' ), button( `#/viewer?${ new URLSearchParams( { table: digest } ) }`, 'View' ) ),
		el( 'div', { class: 'halves' },
			section( 'identity', 'Identity',
				copyLine( 'Digest', 'Digest', digest ),
				copyLine( 'Lock this table in a project', 'Lock command', `ltcforge lock NAME ${ digest } --from ${ address( '/' ).replace( /\/$/, '' ) }` ),
				facts( [
					[ 'Size', bytes( about.bytes ) ], [ 'Entries', whole( about.entries ) ],
					[ 'Recipe', el( 'code', {}, short( recipe_digest ) ) ], [ 'Fitter', recipe.fitter ],
				] ),
				el( 'p', {}, el( 'a', { class: 'button primary', href: address( `/v1/tables/${ digest }` ), download: true, onclick: save }, `Download .safetensors, ${ bytes( about.bytes ) }` ) ) ),
			el( 'section', { class: 'shown' }, picture ) ),
		section( 'quality', 'Quality', inWords( report ) ),
		plots( digest, recipe, isShown, signal ),
		downloads( digest, signal ),
		recipeSection( recipe ) );
	// A table never changes, so there is nothing to refresh.
	return () => {};
}
