// A recipe from a scene: a glTF file or a list of materials that the service plans a table for.

import { el, fileField, fill, muted, notice, takeDrops } from '../elements/dom.js';
import { bytes, percent, span } from '../elements/format.js';
import { ownRecipe } from '../elements/recipe.js';
import { call } from '../service/api.js';

/** Budgets of a plan: the label of each, and its first value. */
const BUDGETS = { '': [ 'nearly as good as any', '' ], bytes: [ 'bytes at most', 20_000 ], error: [ 'error at most', 0.05 ], seconds: [ 'seconds at most', 1 ] };

/** A field for a file; `take` gets the recipe that is chosen of its plan. */
export function planner( signal, take ) {

	let scene = null;
	let asked = 0;
	const open = ( file ) => {

		scene = file;
		plan();

	};

	const budget = el( 'select', { id: 'budget', 'aria-label': 'Budget', onchange: () => {

		most.hidden = ! budget.value;
		most.value = BUDGETS[ budget.value ][ 1 ];
		plan();

	} }, Object.entries( BUDGETS ).map( ( [ value, [ text ] ] ) => el( 'option', { value }, text ) ) );
	const most = el( 'input', { type: 'number', 'aria-label': 'Most', min: 0, step: 'any', hidden: true, onchange: plan } );
	const answer = el( 'div', { role: 'status' } );

	async function plan() {

		if ( ! scene ) return;
		const [ turn, { name } ] = [ ++ asked, scene ];
		fill( answer, muted( `Planning ${ name }…` ) );
		try {

			const query = budget.value ? `?${ budget.value }=${ encodeURIComponent( most.value ) }` : '';
			const type = /\.json$/i.test( name ) ? 'application/json' : 'model/gltf-binary';
			const { summary, plan } = await call( `/v1/plans${ query }`, { method: 'POST', raw: scene, type, signal } );
			if ( turn !== asked ) return;
			const offers = plan.tables.map( ( { recipe, predicted } ) => el( 'button', { type: 'button', class: 'quiet', onclick: () => take( ownRecipe( recipe ) ) }, `${ recipe.brdf }: ${ bytes( predicted.bytes ) }, ${ percent( predicted.error ) }, ${ span( predicted.seconds ) }` ) );
			fill( answer, el( 'p', {}, name ), [ ...summary, ...plan.scene.notes ].map( ( line ) => muted( line ) ), el( 'p', { class: 'actions' }, offers ) );
			if ( plan.tables.length ) take( ownRecipe( plan.tables[ 0 ].recipe ) );

		} catch ( error ) {

			if ( signal.aborted || turn !== asked ) return;
			const faults = error.document?.errors?.map( ( { pointer, detail } ) => `${ pointer || 'the scene' }: ${ detail }` ) || [];
			fill( answer, [ `${ name }: ${ error.message }`, ...faults ].map( notice ) );

		}

	}

	const area = el( 'div', { class: 'drop' },
		el( 'div', { class: 'bar file' }, fileField( 'scene', '.glb,.gltf,.json', 'Open or drop a scene', open, 'button' ), el( 'span', { class: 'muted' }, 'glTF, or a list of materials' ), el( 'span', { class: 'grow' } ), budget, most ), answer );
	takeDrops( area, open );
	return area;

}
