// The form for a recipe, with its forecast.
//
// The document is a preset with changes. The service fills in the other fields and finds the errors, so the form does
// not need to know the defaults.

import { copyButton, el, facts, fill, muted, notice } from '../elements/dom.js';
import { bytes, short, span, whole } from '../elements/format.js';
import { expectedError, formOf, isLookup } from '../elements/recipe.js';
import { documentField, parsed } from '../form/document.js';
import { get, groupsOf, set, STARTS } from '../form/fields.js';
import { input } from '../form/inputs.js';
import { planner } from '../form/plan.js';
import { address, call, constant } from '../service/api.js';
import { hasToken } from '../service/token.js';

/** Milliseconds without a change before the page requests a forecast. */
const PAUSE = 120;

/** Quotes any text as one word for a shell. Recipes can come from untrusted links. */
const quoted = ( text ) => `'${ text.replaceAll( "'", "'\\''" ) }'`;

/** The shell command that submits a recipe. */
function curlOf( recipe ) {
	const token = hasToken() ? '  -H "authorization: Bearer $TOKEN" \\\n' : '';
	return `curl -H 'content-type: application/json' \\\n${ token }  -d ${ quoted( JSON.stringify( recipe ) ) } \\\n  ${ quoted( address( '/v1/jobs' ) ) }`;
}

/** The recipe in the address, or the default recipe. */
function initial( parameters ) {
	try {
		return parsed( parameters.get( 'recipe' ) );
	} catch {
		// If the link has no valid recipe, the form shows the default recipe.
		return { preset: 'standard' };
	}
}

export async function show( root, rest, parameters, signal ) {
	const schema = await constant( '/v1/recipes/schema' );
	let recipe = initial( parameters );
	let timer = 0;
	let asked = 0;

	/** The last complete recipe. While the document has errors, missing values are taken from it. */
	let filled = null;
	const groups = groupsOf( schema ).map( ( { name, fields } ) => ( { name, inputs: fields.map( ( field ) => input( field, ( value ) => change( field, value ) ) ) } ) );
	const inputs = groups.flatMap( ( { inputs } ) => inputs );
	// Fields for one layout stay hidden until the service has returned the recipe's layout.
	for ( const { field, row } of inputs ) row.hidden = Boolean( field.layout );
	const presets = schema.properties.preset.enum.map( ( value ) => el( 'label', {}, el( 'input', { type: 'radio', name: 'preset', value, onchange: () => isLookup( recipe ) ? take( { preset: value } ) : change( { pointer: '/preset' }, value ) } ), value ) );
	const expected = el( 'div', { 'aria-live': 'polite' } );
	const others = el( 'div' );
	const entered = documentField( take, () => submit.disabled = true );
	const curl = el( 'pre', { tabindex: 0, role: 'region', 'aria-label': 'curl command' } );
	const submit = el( 'button', { type: 'submit', class: 'primary' }, 'Submit' );
	const reset = el( 'button', { type: 'button', class: 'quiet', onclick: () => take( { preset: recipe.preset || 'standard' } ) }, 'Back to the preset' );
	const answer = el( 'div' );
	const starts = el( 'select', { id: 'start', 'aria-label': 'Engine or use', onchange: () => take( { ...STARTS[ starts.value ] } ) }, el( 'option', { value: '', disabled: true, selected: true }, 'Choose…' ), Object.keys( STARTS ).map( ( name ) => el( 'option', {}, name ) ) );
	const single = ( legend, content ) => el( 'fieldset', { class: 'single' }, el( 'legend', {}, legend ), content );
	const fields = el( 'div', {}, groups.map( ( { name, inputs } ) => el( 'fieldset', {}, el( 'legend', {}, name ), inputs.map( ( { row } ) => row ) ) ) );
	const copied = ( heading, read ) => el( 'div', { class: 'bar' }, el( 'h2', {}, heading ), copyButton( 'Copy', read ) );
	fill( root,
		el( 'h1', {}, 'New table' ),
		el( 'div', { class: 'form' },
			el( 'form', { novalidate: true, onsubmit: send },
				single( 'For which engine or use?', starts ),
				single( 'From a scene', planner( signal, take ) ),
				single( 'Preset', el( 'div', { class: 'presets' }, presets ) ),
				fields,
				answer, el( 'p', { class: 'actions' }, submit, reset ) ),
			el( 'aside', { 'aria-label': 'Forecast' },
				el( 'h2', {}, 'Forecast' ), expected, others,
				copied( 'Recipe', entered.text ), muted( 'Edit the recipe, or paste another recipe. It can contain fields that the form does not show.' ), entered.root,
				copied( 'Submit with curl', () => curl.textContent ), curl ) ) );

	function change( { pointer, decided = [] }, value ) {
		set( recipe, pointer, value );
		for ( const other of decided ) set( recipe, other, undefined );
		changed();
	}

	/** Replaces the recipe. */
	function take( other ) {
		recipe = other;
		changed();
	}

	function changed() {
		entered.show( recipe );
		for ( const radio of root.querySelectorAll( '[name=preset]' ) ) radio.checked = radio.value === ( recipe.preset ?? ( recipe.fit || recipe.table ? '' : 'standard' ) );
		// Lookup tables have other fields. They are edited as JSON.
		fields.hidden = isLookup( recipe );
		fill( curl, curlOf( recipe ) );
		// The address contains the recipe, so reloading the page keeps it.
		history.replaceState( null, '', formOf( recipe ) );
		clearTimeout( timer );
		timer = setTimeout( requestForecast, PAUSE );
	}

	async function requestForecast() {
		const turn = ++ asked;
		const ask = ( body ) => call( '/v1/recipes', { method: 'POST', body, signal } );
		try {
			const response = await ask( recipe );
			if ( turn !== asked ) return;
			showForecast( response );
			// The recipe in a link can have errors. Missing values then come from the preset.
			if ( ! response.recipe && ! filled ) fillIn( ( await ask( { preset: recipe.preset || 'standard' } ) ).recipe );
		} catch ( error ) {
			if ( ! signal.aborted && turn === asked ) fill( expected, notice( error.message ) );
		}
	}

	/** Shows the values of the document. Missing values come from the complete recipe. */
	function fillIn( complete ) {
		filled = complete;
		for ( const { field: { pointer }, show } of inputs ) show( get( recipe, pointer ) ?? get( complete, pointer ) );
	}

	/** Shows the complete recipe, its forecast, and each error next to its field. */
	function showForecast( { recipe: complete, entries, expected: forecast, table, recipe_digest, problem } ) {
		const faults = new Set( problem?.errors );
		for ( const { field: { pointer, layout }, row, showFaults } of inputs ) {
			const own = [ ...faults ].filter( ( fault ) => `${ fault.pointer }/`.startsWith( `${ pointer }/` ) );
			own.forEach( ( fault ) => faults.delete( fault ) );
			// For an error inside a list, the message also names the item and its member.
			showFaults( own.map( ( fault ) => fault.pointer === pointer ? fault.detail : `${ fault.pointer.slice( 1 ) }: ${ fault.detail }` ) );
			row.hidden = Boolean( layout ) && ! own.length && ( complete || recipe ).layout !== layout;
		}
		if ( complete || filled ) fillIn( complete || filled );
		fill( others, problem && ! problem.errors?.length ? notice( problem.detail ) : null, [ ...faults ].map( ( { pointer, detail } ) => notice( `${ pointer || 'the document' }: ${ detail }` ) ) );
		submit.disabled = Boolean( problem ) || entered.isRefused();
		fill( submit, table ? 'Open the table' : 'Submit' );
		fill( expected, complete ? facts( [
			[ 'Time', table ? 'already fitted' : forecast ? span( forecast.seconds ) : '–' ],
			forecast && expectedError( complete, forecast.error ),
			[ 'Size', forecast ? bytes( forecast.bytes ) : '–' ],
			[ 'Entries', whole( entries ) ],
			[ 'Digest', el( 'code', {}, short( recipe_digest ) ) ],
		] ) : muted( problem.detail ) );
	}

	async function send( event ) {
		event.preventDefault();
		submit.disabled = true;
		try {
			const job = await call( '/v1/jobs', { method: 'POST', body: recipe } );
			location.hash = job.table ? `#/tables/${ job.table }` : `#/jobs/${ job.id }`;
		} catch ( error ) {
			submit.disabled = false;
			fill( answer, notice( error.message ) );
		}
	}
	changed();
	return requestForecast;
}
