// A recipe in a form, with what it would take and give.
//
// The document is a preset and what was changed of it. The service fills in the rest and finds the faults, so that the form
// knows no default.

import { copyButton, el, facts, fill, notice } from '../elements/dom.js';
import { bytes, percent, short, span } from '../elements/format.js';
import { documentField, isDocument } from '../form/document.js';
import { get, GROUPS, LEFT_OUT, PRESETS, set, STARTS } from '../form/fields.js';
import { input } from '../form/inputs.js';
import { planner } from '../form/plan.js';
import { tradeoff } from '../form/tradeoff.js';
import { address, call } from '../service/api.js';
import { hasToken } from '../service/token.js';

/** How long a change waits for the next one before the service is asked, in milliseconds. */
const PAUSE = 120;

/** A word of a shell's line, whatever is in it: recipes come from links of others too. */
const quoted = ( text ) => `'${ text.replaceAll( "'", "'\\''" ) }'`;

export async function show( root, rest, parameters, signal ) {

	let recipe = initial( parameters );
	let timer = 0;
	let asked = 0;
	/** The last complete recipe, of which a document with faults lacks what it does not say. */
	let filled = null;
	const inputs = GROUPS.flatMap( ( { fields } ) => fields ).map( ( field ) => input( field, ( value ) => change( field, value ) ) );
	// Until the service has told the layout.
	for ( const { field, row } of inputs ) row.hidden = Boolean( field.layout );
	const presets = PRESETS.map( ( preset ) => el( 'label', {}, el( 'input', { type: 'radio', name: 'preset', value: preset, onchange: () => change( { pointer: '/preset' }, preset ) } ), preset ) );
	const expected = el( 'div', { 'aria-live': 'polite' } );
	const others = el( 'div' );
	const entered = documentField( take, () => submit.disabled = true );
	const curl = el( 'pre', { tabindex: 0, role: 'region', 'aria-label': 'Call by curl' } );
	const submit = el( 'button', { type: 'submit', class: 'primary' }, 'Submit' );
	const reset = el( 'button', { type: 'button', class: 'quiet', onclick: clear }, 'Back to the preset' );
	const answer = el( 'div' );

	const starts = el( 'select', { id: 'start', onchange: () => take( { ...STARTS[ starts.value ] } ) }, el( 'option', { value: '', disabled: true, selected: true }, 'Choose…' ), Object.keys( STARTS ).map( ( name ) => el( 'option', {}, name ) ) );
	const chart = tradeoff( signal );

	const groups = GROUPS.map( ( { name, fields } ) => el( 'fieldset', {}, el( 'legend', {}, name ), inputs.filter( ( { field } ) => fields.includes( field ) ).map( ( { row } ) => row ) ) );
	fill( root,
		el( 'h1', {}, 'New table' ),
		el( 'div', { class: 'form' },
			el( 'form', { novalidate: true, onsubmit: send },
				el( 'fieldset', { class: 'single' }, el( 'legend', {}, 'From a scene' ), planner( signal, take ) ),
				el( 'fieldset', { class: 'single' }, el( 'legend', {}, 'Preset' ), el( 'div', { class: 'presets' }, presets, el( 'label', { for: 'start', class: 'start' }, el( 'span', {}, 'or for' ), starts ) ) ), groups,
				answer, el( 'p', { class: 'actions' }, submit, reset ) ),
			el( 'aside', { 'aria-label': 'What it would take' },
				el( 'h2', {}, 'Forecast' ), expected, others, el( 'div', { class: 'charts' }, chart.charts ),
				el( 'div', { class: 'bar' }, el( 'h2', {}, 'Recipe' ), copyButton( 'Copy', entered.text ) ), el( 'p', { class: 'muted' }, 'Edit it, or paste another. It may say more than the form has fields for.' ), entered.root,
				el( 'div', { class: 'bar' }, el( 'h2', {}, 'The same by curl' ), copyButton( 'Copy', () => curl.textContent ) ), curl ) ) );

	function change( { pointer, decides = [] }, value ) {

		set( recipe, pointer, value );
		for ( const decided of decides ) set( recipe, decided, undefined );
		changed();

	}

	/** Takes another recipe in place of what was entered. */
	function take( other ) {

		recipe = other;
		changed();

	}

	function clear() {

		recipe = { preset: recipe.preset || 'standard' };
		changed();

	}

	function changed() {

		entered.show( recipe );
		for ( const radio of root.querySelectorAll( '[name=preset]' ) ) radio.checked = radio.value === ( recipe.preset ?? ( recipe.fit ? '' : 'standard' ) );
		fill( curl, `curl -H 'content-type: application/json' \\\n${ hasToken() ? '  -H "authorization: Bearer $TOKEN" \\\n' : '' }  -d ${ quoted( JSON.stringify( recipe ) ) } \\\n  ${ quoted( address( '/v1/jobs' ) ) }` );
		// A page that is loaded again has the same recipe.
		history.replaceState( null, '', `#/new?${ new URLSearchParams( { recipe: JSON.stringify( recipe ) } ) }` );
		clearTimeout( timer );
		timer = setTimeout( foresee, PAUSE );

	}

	async function foresee() {

		const turn = ++ asked;
		try {

			const foreseen = await call( '/v1/recipes', { method: 'POST', body: recipe, signal } );
			if ( turn !== asked ) return;
			tell( foreseen );
			// A link may bring a recipe with faults; all that it does not say is that of the preset.
			if ( ! foreseen.recipe && ! filled ) fillIn( ( await call( '/v1/recipes', { method: 'POST', body: { preset: recipe.preset || 'standard' }, signal } ) ).recipe );

		} catch ( error ) {

			if ( ! signal.aborted && turn === asked ) fill( expected, notice( error.message ) );

		}

	}

	/** Shows the document's values, and those of a complete recipe where it has none. */
	function fillIn( complete ) {

		filled = complete;
		for ( const { field, show } of inputs ) show( get( recipe, field.pointer ) ?? get( complete, field.pointer ) ?? LEFT_OUT[ field.pointer ] );

	}

	/** Shows the recipe in force, its forecast and its faults, each at its field. */
	function tell( { recipe: complete, entries, expected: forecast, table, recipe_digest, problem } ) {

		const faults = problem?.errors || [];
		const placed = new Set();
		for ( const { field, row, blame } of inputs ) {

			const own = faults.filter( ( { pointer } ) => pointer === field.pointer || pointer.startsWith( `${ field.pointer }/` ) );
			own.forEach( ( fault ) => placed.add( fault ) );
			// Of a list, the item and its member too.
			blame( own.map( ( { pointer, detail } ) => pointer === field.pointer ? detail : `${ pointer.slice( 1 ) }: ${ detail }` ) );
			row.hidden = Boolean( field.layout ) && ! own.length && ( complete || recipe ).layout !== field.layout;

		}

		if ( complete || filled ) fillIn( complete || filled );
		const rest = faults.filter( ( fault ) => ! placed.has( fault ) ).map( ( { pointer, detail } ) => `${ pointer || 'the document' }: ${ detail }` );
		fill( others, problem && ! faults.length ? notice( problem.detail ) : null, rest.map( notice ) );
		submit.disabled = Boolean( problem ) || entered.isRefused();
		chart.show( forecast );
		fill( submit, table ? 'Open the table' : 'Submit' );
		fill( expected, complete ? facts( [
			[ 'Time', table ? 'fitted already' : forecast ? span( forecast.seconds ) : '–' ],
			[ 'Error', forecast ? percent( forecast.error ) : '–' ],
			[ 'Size', forecast ? bytes( forecast.bytes ) : '–' ],
			[ 'Entries', entries.toLocaleString( 'en' ) ],
			[ 'Digest', el( 'code', {}, short( recipe_digest ) ) ],
		] ) : el( 'p', { class: 'muted' }, problem.detail ) );

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
	return foresee;

}

/** The recipe in the page's address, or the default. */
function initial( parameters ) {

	try {

		const recipe = JSON.parse( parameters.get( 'recipe' ) );
		if ( isDocument( recipe ) ) return recipe;

	} catch {

		// A link that was cut short shows the default.

	}

	return { preset: 'standard' };

}
