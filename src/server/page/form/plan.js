// Gets recipes for a scene. The service plans tables for a glTF file or a list of materials.

import { el, fileField, fill, muted, notice, takeDrops } from '../elements/dom.js';
import { bytes, percent, span } from '../elements/format.js';
import { ownRecipe } from '../elements/recipe.js';
import { call } from '../service/api.js';

/** Budgets of a plan: query parameter, label and initial limit. */
const BUDGETS = { '': [ 'no limit', '' ], bytes: [ 'limit bytes', 20_000 ], error: [ 'limit error', 0.05 ], seconds: [ 'limit seconds', 1 ] };

/** A file field for a scene. `take` is called with the first recipe of the plan, and with each recipe that the user selects. */
export function planner( signal, take ) {
	let scene = null;
	let asked = 0;
	const open = ( file ) => {
		scene = file;
		plan();
	};
	const budget = el( 'select', { id: 'budget', 'aria-label': 'Budget', onchange: () => {
		limit.hidden = ! budget.value;
		limit.value = BUDGETS[ budget.value ][ 1 ];
		plan();
	} }, Object.entries( BUDGETS ).map( ( [ value, [ text ] ] ) => el( 'option', { value }, text ) ) );
	const limit = el( 'input', { type: 'number', 'aria-label': 'Limit', min: 0, step: 'any', hidden: true, onchange: plan } );
	const output = el( 'div', { role: 'status' } );

	async function plan() {
		if ( ! scene ) return;
		const [ turn, { name } ] = [ ++ asked, scene ];
		fill( output, muted( `Planning ${ name }…` ) );
		try {
			const query = budget.value ? `?${ budget.value }=${ encodeURIComponent( limit.value ) }` : '';
			const type = /\.json$/i.test( name ) ? 'application/json' : 'model/gltf-binary';
			const { summary, plan } = await call( `/v1/plans${ query }`, { method: 'POST', raw: scene, type, signal } );
			if ( turn !== asked ) return;
			const offers = plan.tables.map( ( { recipe, predicted, error_of } ) => el( 'button', { type: 'button', class: 'quiet', onclick: () => take( ownRecipe( recipe ) ) }, `${ recipe.brdf }: ${ bytes( predicted.bytes ) }, ${ error_of } error ${ percent( predicted.error ) } on the scene, ${ span( predicted.seconds ) }` ) );
			fill( output, el( 'p', {}, name ), summary.map( ( line ) => muted( line ) ), el( 'p', { class: 'actions' }, offers ) );
			if ( plan.tables.length ) take( ownRecipe( plan.tables[ 0 ].recipe ) );
		} catch ( error ) {
			if ( signal.aborted || turn !== asked ) return;
			const faults = error.document?.errors?.map( ( { pointer, detail } ) => `${ pointer || 'the scene' }: ${ detail }` ) || [];
			fill( output, [ `${ name }: ${ error.message }`, ...faults ].map( notice ) );
		}
	}
	const area = el( 'div', { class: 'drop' },
		el( 'div', { class: 'bar file' }, fileField( 'scene', '.glb,.gltf,.json', 'Open or drop a scene', open, 'button' ), el( 'span', { class: 'muted' }, 'glTF, or a list of materials' ), el( 'span', { class: 'grow' } ), budget, limit ), output );
	takeDrops( area, open );
	return area;
}
