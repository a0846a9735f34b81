// A dropped scene: its plan, its materials with their errors, and the files for an engine.

import { el, fill, muted, notice } from '../elements/dom.js';
import { bytes, number, percent, span } from '../elements/format.js';
import { ENGINES, json, ownRecipe } from '../elements/recipe.js';
import { call, reach } from '../service/api.js';
import { fitted } from '../service/jobs.js';
import { saveAs, zip } from '../service/zip.js';
import { choice } from './controls.js';

/** Seconds that a planned table may take without a question. */
const AT_ONCE = 10;

/** Materials with a picture. Others have a flat colour. */
const PAINTED = 32;

/** The sRGB byte of a linear number. */
const srgb = ( y ) => Math.round( 255 * ( y <= 0.0031308 ? 12.92 * y : 1.055 * y ** ( 1 / 2.4 ) - 0.055 ) );

/** Languages of includes by the name of an engine. Others use GLSL. */
const LANGUAGES = { bevy: [ 'wgsl' ], hdrp: [ 'hlsl' ], o3de: [ 'hlsl' ], wgpu: [ 'glsl', 'wgsl', 'hlsl' ] };

async function downloaded( path ) {
	const response = await reach( path );
	if ( ! response.ok ) throw new Error( `${ path }: the service returned status ${ response.status }` );
	return new Uint8Array( await response.arrayBuffer() );
}

/** The panel of a scene. `show` is called with the model for the left side, and `light` with the lights of the scene; it returns a sentence about them. */
export function planned( show, light, signal ) {
	let [ turn, scene, answer, plan, digest, timer ] = [ 0, null, null, null, null, 0 ];
	const planOf = ( file, query = '' ) => call( `/v1/plans${ query }`, { method: 'POST', raw: file, type: 'model/gltf-binary', signal } );
	let rows = [];
	let isBusy = false;
	const status = el( 'div', { role: 'status' } );
	const words = el( 'div' );
	const models = el( 'p', { class: 'actions' } );
	const materials = el( 'tbody' );
	let engine = ENGINES[ 0 ];
	const engines = choice( 'view-engine', 'Engine', ENGINES, engine[ 0 ], ( value ) => {
		engine = ENGINES.find( ( [ name ] ) => name === value );
		label();
	} );
	const files = el( 'button', { type: 'button', class: 'primary', onclick: () => save().catch( failed ) } );
	const label = () => files.textContent = `Files for ${ engine[ 1 ] }`;
	label();
	const root = el( 'fieldset', { class: 'scene', hidden: true }, el( 'legend', {}, 'This scene' ), status, words, models,
		el( 'div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Materials' }, el( 'table', { class: 'figures' }, el( 'thead', {}, el( 'tr', {}, [ 'Material', 'roughness', 'plan', 'mean error' ].map( ( name, i ) => el( 'th', { scope: 'col', class: i ? 'number' : null }, name ) ) ) ), materials ) ),
		muted( 'Each ball under one light: left half by the left side, right half by the truth.' ),
		el( 'div', { class: 'bar' }, engines.row, files ) );

	/** Shows what the page does, with the seconds since it began, or the progress from 0 to 1. */
	function busy( text, progress ) {
		clearInterval( timer );
		isBusy = true;
		const since = performance.now();
		const seconds = el( 'span', { class: 'muted', 'aria-hidden': 'true' } );
		fill( status, el( 'div', { class: 'progress' }, el( 'span', {}, text ), el( 'progress', { 'aria-label': text, max: 1, value: progress } ), seconds ) );
		if ( progress === undefined ) timer = setInterval( () => seconds.textContent = span( ( performance.now() - since ) / 1000 ), 500 );
	}

	function idle( ...shown ) {
		clearInterval( timer );
		isBusy = false;
		fill( status, shown );
	}
	const failed = ( error ) => signal.aborted || idle( notice( error.message ), ( error.document?.errors ?? [] ).map( ( { pointer, detail } ) => muted( `${ pointer }: ${ detail }` ) ) );
	signal.addEventListener( 'abort', () => clearInterval( timer ) );

	/** The table of a recipe. Shows the progress of its job. */
	const tableOf = ( recipe ) => fitted( recipe, signal, ( { progress: { entries_done: done, entries_total: all } } ) => busy( 'Fitting the table…', done / all ) );

	async function fit() {
		const own = turn;
		const found = await tableOf( ownRecipe( plan.recipe ) );
		if ( own !== turn ) return;
		digest = found;
		idle();
		offer();
		show( digest );
	}

	/** The buttons for the left side. */
	function offer() {
		const button = ( text, onclick ) => el( 'button', { type: 'button', class: 'quiet', onclick }, text );
		fill( models, button( 'Engines’ table', () => show( 'engines' ) ), button( 'Closed form', () => show( plan?.model === 'ltc-formula' ? 'ltc-formula' : '' ) ),
			plan && button( digest ? 'Planned table' : `Fit the planned table: ${ bytes( plan.predicted.bytes ) }, ${ span( plan.predicted.seconds ) }`, () => digest ? show( digest ) : fit().catch( failed ) ) );
	}

	/** Saves the files of the table that is planned for the engine, with includes, the recipe and a README. */
	async function save() {
		const [ name, called, layout ] = engine;
		if ( layout || ! answer ) busy( `Planning the table for ${ called }…` );
		const { summary, plan: { tables: [ best ] } } = ! layout && answer ? answer : await planOf( scene, `?engine=${ name }` );
		if ( ! best ) throw new Error( `${ called } has no table for these materials` );
		busy( 'Fitting the table…' );
		const table = await tableOf( ownRecipe( best.recipe ) );
		busy( 'Making the files…' );
		const [ made, { recipe } ] = await Promise.all( [ 'exports/' + name, 'manifest' ].map( ( of ) => call( `/v1/tables/${ table }/${ of }`, { signal } ) ) );
		const form = best.model && [ best.model, best.rule ].filter( Boolean ).join( '-' );
		const lookup = layout ? null : `ltc-${ recipe.layout }${ typeof recipe.fresnel === 'string' && recipe.fresnel !== 'one' ? '-two-lobes' : '' }`;
		const includes = [ lookup, form ].filter( Boolean ).flatMap( ( text ) => ( LANGUAGES[ name ] ?? [ 'glsl' ] ).map( ( extension ) => `${ text }.${ extension }` ) );
		const packed = await Promise.all( [ ...made.files.map( ( { path, url } ) => [ path, url ] ), ...includes.map( ( file ) => [ `include/${ file }`, `/page/${ file }` ] ) ].map( async ( [ path, url ] ) => ( { path, bytes: await downloaded( url ) } ) ) );
		const readme = [ `# Area lights for ${ scene.name } in ${ called }`, '', ...summary.map( ( line ) => `- ${ line.trim() }` ), '',
			'## The table', '', `The files hold the table that is planned for this scene${ layout ? `, in the layout of ${ called } (\`${ layout }\`)` : '' }: ${ table }.`, '', ...made.steps.map( ( step, i ) => `${ i + 1 }. ${ step }` ), '',
			lookup && `The includes that begin with \`${ lookup }\` read the table.\n`, '`ltcforge fit recipe.json` makes the table again.', '',
			...( form ? [ '## Without a table', '', `The includes that begin with \`${ form }\` light the same materials by a closed form. Use them if the plan above says so, and leave the table out. The folders examples/three, examples/babylon and examples/playcanvas of ltcforge show how.`, '' ] : [] ) ];
		const text = ( path, content ) => ( { path, bytes: new TextEncoder().encode( content ) } );
		saveAs( zip( [ text( 'README.md', readme.filter( ( line ) => line !== null ).join( '\n' ) ), text( 'recipe.json', json( recipe ) ), ...packed ] ), `${ scene.name.replace( /\.\w+$/, '' ) }-${ name }.zip` );
		idle( muted( `Saved ${ packed.length + 2 } files.` ) );
	}
	return {
		root,
		/** Plans the tables of a file, and lists its materials. */
		async start( file, meshes ) {
			const own = ++ turn;
			[ scene, answer, plan, digest ] = [ file, null, null, null ];
			root.hidden = false;
			fill( words );
			offer();
			rows = meshes.map( ( { name, material } ) => {
				const [ use, error ] = [ el( 'td', { class: 'number' }, '–' ), el( 'td', { class: 'number' }, '–' ) ];
				const swatch = el( 'canvas', { class: 'swatch', width: 1, height: 1, 'aria-hidden': 'true' } );
				swatch.style.background = `rgb(${ material.factors.base.map( srgb ) })`;
				const { alpha_x: x, alpha_y: y } = material;
				return { name, material, swatch, use, error, row: el( 'tr', {}, el( 'th', { scope: 'row' }, swatch, name ), el( 'td', { class: 'number' }, x === y ? number( x ) : `${ number( x ) }, ${ number( y ) }` ), use, error ) };
			} );
			fill( materials, rows.map( ( { row } ) => row ) );
			busy( 'Planning the best table for this scene…' );
			try {
				const found = await planOf( file );
				if ( own !== turn || signal.aborted ) return;
				answer = found;
				const { summary, plan: { scene: read, tables } } = answer;
				plan = tables[ 0 ] ?? null;
				const more = [ light( read.lights ), ...summary.slice( 1 ) ];
				fill( words, el( 'p', {}, summary[ 0 ] ), el( 'details', {}, el( 'summary', {}, 'More about the plan and the lights' ), el( 'div', {}, more.map( ( line ) => muted( line ) ) ) ) );
				// A plan has the errors of light by the table, by the engine's table, and by the closed form.
				for ( const { material, light: [ table, , closed ] } of plan?.materials ?? [] ) {
					const best = closed !== null && closed < ( table ?? Infinity ) ? 'closed form' : 'table';
					for ( const { name, use } of rows ) if ( name === read.materials[ material ].name ) use.textContent = best;
				}
				idle();
				offer();
				if ( plan && plan.predicted.seconds <= AT_ONCE ) await fit();
			} catch ( error ) {
				if ( own === turn ) failed( error );
			}
		},
		/** Shows the mean error of each material, or null for a material that is not visible. */
		showErrors: ( errors ) => errors.forEach( ( error, i ) => rows[ i ] && fill( rows[ i ].error, error ? percent( error.sides[ 0 ].mean, 2 ) : 'not visible' ) ),
		/** Whether the scene has a plan. */
		isPlanned: () => Boolean( answer ),
		/** Shows the picture of each material that `draw` makes on a canvas. */
		paint( canvas, draw ) {
			for ( const { material, swatch } of rows.slice( 0, PAINTED ) ) {
				draw( material );
				[ swatch.width, swatch.height ] = [ canvas.width, canvas.height ];
				swatch.getContext( '2d' ).drawImage( canvas, 0, 0 );
			}
		},
		/** Whether the service works for this scene. */
		isBusy: () => isBusy,
		hide: ( isHidden ) => root.hidden = isHidden || ! scene,
	};
}
