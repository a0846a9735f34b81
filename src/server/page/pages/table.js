// One table: label, digest, quality, and files for engines.

import { bar, button, copyLine, el, facts, fill, notice, section } from '../elements/dom.js';
import { bytes, short, whole } from '../elements/format.js';
import { isLookup, keepLabel, labelOf, recipeSection, title, variation } from '../elements/recipe.js';
import { downloads, save } from '../report/downloads.js';
import { inWords, lookupInWords, plots } from '../report/quality.js';
import { address, manifest } from '../service/api.js';
import { load, previewOf } from '../service/pictures.js';

/** A field for the label of a table. `changed` is called after a change. */
function labelField( digest, changed ) {
	const fault = el( 'div' );
	const input = el( 'input', { type: 'text', id: 'label', value: labelOf( digest ), maxlength: 80, autocomplete: 'off', placeholder: 'none', onchange: () => {
		try {
			keepLabel( digest, input.value.trim() );
			fill( fault );
			changed();
		} catch {
			fill( fault, notice( 'This browser blocks storage, so the label is not saved.' ) );
		}
	} } );
	return el( 'div', { class: 'field label-field' }, el( 'label', { for: 'label' }, 'Label, kept in this browser' ), input, fault );
}

export async function show( root, digest, parameters, signal ) {
	const about = await manifest( digest );
	const { recipe, report, recipe_digest } = about;
	const isLut = isLookup( recipe );
	const name = () => labelOf( digest ) || title( recipe );
	const picture = isLut ? el( 'img', { alt: 'Values of the table, and errors after linear filtering' } )
		: el( 'img', { alt: 'A sphere under a rectangular light: the reference, this table, and their difference', width: 776, height: 314 } );
	const isShown = load( picture, isLut ? `/v1/tables/${ digest }/plots/error.png` : previewOf( recipe, digest, 256, 'strip' ), signal );
	const others = [ button( `#/compare?tables=${ digest }`, 'Compare' ), button( `#/viewer?${ new URLSearchParams( { table: digest } ) }`, 'View' ) ];
	const subtitle = el( 'span', { class: 'muted' } );
	const top = bar( '', subtitle, variation( recipe ), isLut ? null : others );
	const rename = () => {
		top.querySelector( 'h1' ).textContent = name();
		document.title = `${ name() } – ltcforge`;
		subtitle.textContent = labelOf( digest ) && title( recipe );
	};

	rename();
	fill( root, top,
		el( 'div', { class: 'halves' },
			section( 'identity', 'Identity',
				labelField( digest, rename ),
				copyLine( 'Digest', 'Digest', digest ),
				copyLine( 'Lock this table in a project', 'Lock command', `ltcforge lock NAME ${ digest } --from ${ address( '/' ).replace( /\/$/, '' ) }` ),
				facts( [
					[ 'Size', bytes( about.bytes ) ], [ 'Entries', whole( about.entries ) ],
					[ 'Recipe', el( 'code', {}, short( recipe_digest ) ) ], [ 'Fitter', recipe.fitter ],
				] ),
				el( 'p', {}, el( 'a', { class: 'button primary', href: address( `/v1/tables/${ digest }` ), download: true, onclick: save }, `Download .safetensors, ${ bytes( about.bytes ) }` ) ) ),
			el( 'section', { class: 'shown' }, picture ) ),
		section( 'quality', 'Quality', isLut ? lookupInWords( report ) : inWords( report ) ),
		isLut ? null : plots( digest, recipe, isShown, signal ),
		downloads( digest, recipe, signal ),
		recipeSection( recipe ) );
	// A table never changes, so there is nothing to refresh.
	return () => {};
}
