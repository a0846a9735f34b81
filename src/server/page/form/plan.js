// A recipe from a scene: a glTF file or a list of materials that the service plans a table for.

import { el, fill, notice } from '../elements/dom.js';
import { bytes, percent, span } from '../elements/format.js';
import { call } from '../service/api.js';

/** Budgets of a plan: what each is, and what is entered at first. */
const BUDGETS = { '': [ 'nearly as good as any', '' ], bytes: [ 'bytes at most', 20_000 ], error: [ 'error at most', 0.05 ], seconds: [ 'seconds at most', 1 ] };

/** A field for a file; `take` gets the recipe that is chosen of its plan. */
export function planner( signal, take ) {

	const file = el( 'input', { type: 'file', id: 'scene', accept: '.glb,.gltf,.json', class: 'hidden', onchange: () => plan( file.files[ 0 ] ) } );
	const budget = el( 'select', { id: 'budget', 'aria-label': 'Budget', onchange: () => {

		const first = BUDGETS[ budget.value ][ 1 ];
		most.hidden = ! budget.value;
		most.value = first;
		again();

	} }, Object.entries( BUDGETS ).map( ( [ value, [ text ] ] ) => el( 'option', { value }, text ) ) );
	const most = el( 'input', { type: 'number', 'aria-label': 'Most', min: 0, step: 'any', hidden: true, onchange: again } );
	const answer = el( 'div', { role: 'status' } );
	let given = null;
	let asked = 0;

	function again() {

		if ( given ) plan( given );

	}

	async function plan( scene ) {

		if ( ! scene ) return;
		given = scene;
		const turn = ++ asked;
		const isList = /\.json$/i.test( scene.name );
		fill( answer, el( 'p', { class: 'muted' }, `Planning ${ scene.name }…` ) );
		try {

			const query = budget.value ? `?${ budget.value }=${ encodeURIComponent( most.value ) }` : '';
			const { summary, plan } = await call( `/v1/plans${ query }`, { method: 'POST', raw: scene, type: isList ? 'application/json' : 'model/gltf-binary', signal } );
			if ( turn !== asked ) return;
			const offers = plan.tables.map( ( table ) => el( 'button', { type: 'button', class: 'quiet', onclick: () => take( ownRecipe( table ) ) }, `${ table.recipe.brdf }: ${ bytes( table.predicted.bytes ) }, ${ percent( table.predicted.error ) }, ${ span( table.predicted.seconds ) }` ) );
			fill( answer, el( 'p', {}, scene.name ), summary.map( ( line ) => el( 'p', { class: 'muted' }, line ) ), plan.scene.notes.map( ( line ) => el( 'p', { class: 'muted' }, line ) ), el( 'p', { class: 'actions' }, offers ) );
			if ( plan.tables.length ) take( ownRecipe( plan.tables[ 0 ] ) );

		} catch ( error ) {

			if ( signal.aborted || turn !== asked ) return;
			const faults = error.document?.errors?.map( ( { pointer, detail } ) => `${ pointer || 'the scene' }: ${ detail }` ) || [];
			fill( answer, [ `${ scene.name }: ${ error.message }`, ...faults ].map( notice ) );

		}

	}

	const area = el( 'div', { class: 'drop', ondragover: ( event ) => event.preventDefault(), ondrop: ( event ) => {

		event.preventDefault();
		plan( event.dataTransfer.files[ 0 ] );

	} }, el( 'div', { class: 'bar file' }, file, el( 'label', { for: 'scene', class: 'button' }, 'Open or drop a scene' ), el( 'span', { class: 'muted' }, 'glTF, or a list of materials' ), el( 'span', { class: 'grow' } ), budget, most ), answer );
	return area;

}

/** The recipe of a planned table without the number of the fitter, which the service fills in. */
function ownRecipe( { recipe } ) {

	const own = { ...recipe };
	delete own.fitter;
	return own;

}
