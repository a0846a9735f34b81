// A dropped scene: its plan, its materials with their errors, and the files for an engine.

import { el, fill, muted, notice } from '../elements/dom.js';
import { atLeast, bytes, number, percent, span } from '../elements/format.js';
import { ENGINES, json, nameOf, ownRecipe } from '../elements/recipe.js';
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

/** The panel of a scene. `show` is called with the model for the left side and with the label of a new model; `shown` returns the model of the left side. `light` is called with the lights of the scene and returns a sentence about them. */
export function planned( show, shown, light, signal ) {
	let [ turn, scene, answer, timer ] = [ 0, null, null, 0 ];
	/** The plans for surfaces and for sheen, and the digests of their tables. */
	let [ plans, digests ] = [ [], [] ];
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
		muted( 'Each ball has one light. Left half: the method of the left side. Right half: the truth.' ),
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

	/** Fits the planned table and shows it, unless the left side has changed meanwhile. */
	async function fit( i ) {
		const [ own, before ] = [ turn, shown() ];
		const { recipe } = plans[ i ];
		const found = await tableOf( ownRecipe( recipe ) );
		if ( own !== turn ) return;
		digests[ i ] = found;
		idle();
		offer();
		if ( shown() === before ) showTable( i );
	}

	const showTable = ( i ) => show( digests[ i ], `planned table ${ nameOf( { digest: digests[ i ], recipe: plans[ i ].recipe } ) }` );

	/** The closed form that suits the scene best: its name in a link. */
	const closedForm = () => plans[ 0 ]?.rule && plans[ 0 ].rule !== 'balanced' ? `${ plans[ 0 ].model }-${ plans[ 0 ].rule }` : plans[ 0 ]?.model === 'ltc-formula' ? 'ltc-formula' : '';

	/** The buttons for the left side. */
	function offer() {
		const button = ( text, onclick ) => el( 'button', { type: 'button', class: 'quiet', onclick }, text );
		fill( models, button( 'Engine table', () => show( 'engines' ) ), button( 'Closed form', () => show( closedForm() ) ), plans.map( ( { recipe, predicted }, i ) => {
			const name = recipe.brdf === 'ggx' ? 'planned table' : 'planned table for sheen';
			return button( digests[ i ] ? `${ name[ 0 ].toUpperCase() }${ name.slice( 1 ) }` : `Fit the ${ name }: ${ bytes( predicted.bytes ) }, ${ span( predicted.seconds ) }`, () => digests[ i ] ? showTable( i ) : fit( i ).catch( failed ) );
		} ) );
	}

	/** The files of a planned table below a folder: its files for the engine, its recipe and its includes. */
	async function filesOf( { recipe: planned }, folder, [ name, , layout ] ) {
		busy( 'Fitting the table…' );
		const table = await tableOf( ownRecipe( planned ) );
		busy( 'Making the files…' );
		const [ { files, steps }, { recipe } ] = await Promise.all( [ 'exports/' + name, 'manifest' ].map( ( of ) => call( `/v1/tables/${ table }/${ of }`, { signal } ) ) );
		const lookup = layout ? null : `ltc-${ recipe.layout }${ typeof recipe.fresnel === 'string' && recipe.fresnel !== 'one' ? '-two-lobes' : '' }`;
		const packed = await Promise.all( files.map( async ( { path, url } ) => ( { path: folder + path, bytes: await downloaded( url ) } ) ) );
		return { table, steps, lookup, packed: [ { path: `${ folder }recipe.json`, bytes: new TextEncoder().encode( json( recipe ) ) }, ...packed ] };
	}

	/** Saves the files of the tables that are planned for the engine, with includes, recipes and a README. Engines have no sheen by tables. */
	async function save() {
		const [ name, called, layout ] = engine;
		if ( layout || ! answer ) busy( `Planning the table for ${ called }…` );
		const { summary, plan: { tables } } = ! layout && answer ? answer : await planOf( scene, `?engine=${ name }` );
		if ( ! tables.length ) throw new Error( `No table in the layout of ${ called } fits these materials` );
		const parts = [];
		for ( const [ i, planned ] of tables.entries() ) if ( i === 0 || ! layout ) parts.push( await filesOf( planned, i ? 'sheen/' : '', engine ) );
		const [ { model, rule } ] = tables;
		const form = model && [ model, rule ].filter( Boolean ).join( '-' );
		const texts = new Set( [ ...parts.map( ( { lookup } ) => lookup ), form ].filter( Boolean ) );
		const includes = [ ...texts ].flatMap( ( text ) => ( LANGUAGES[ name ] ?? [ 'glsl' ] ).map( ( extension ) => `${ text }.${ extension }` ) );
		const packed = [ ...parts.flatMap( ( part ) => part.packed ), ...await Promise.all( includes.map( async ( file ) => ( { path: `include/${ file }`, bytes: await downloaded( `/page/${ file }` ) } ) ) ) ];
		const readme = [ `# Area lights for ${ scene.name } in ${ called }`, '', ...summary.map( ( line ) => `- ${ line.trim() }` ), '',
			...parts.flatMap( ( { table, steps, lookup }, i ) => [ i ? '## The table for sheen' : '## The table', '', `The files${ i ? ' in `sheen`' : '' } hold the table that is planned for this scene${ layout ? `, in the layout of ${ called } (\`${ layout }\`)` : '' }: ${ table }.`, '', ...steps.map( ( step, k ) => `${ k + 1 }. ${ step }` ), '',
				...( lookup ? [ `The includes that begin with \`${ lookup }\` read the table.`, '' ] : [] ) ] ),
			'`ltcforge fit recipe.json` makes the table again.', '',
			...( form ? [ '## Without a table', '', `The includes that begin with \`${ form }\` light the same materials by a closed form. Use them if the plan above says so, and leave the table out. The folders examples/three, examples/babylon and examples/playcanvas of ltcforge show how.`, '' ] : [] ) ];
		saveAs( zip( [ { path: 'README.md', bytes: new TextEncoder().encode( readme.join( '\n' ) ) }, ...packed ] ), `${ scene.name.replace( /\.\w+$/, '' ) }-${ name }.zip` );
		idle( muted( `Saved ${ packed.length + 1 } files.` ) );
	}
	return {
		root,
		/** Plans the tables of a file, and lists its materials. */
		async start( file, meshes, isNew ) {
			const own = ++ turn;
			[ scene, answer, plans, digests ] = [ file, null, [], [] ];
			const before = shown();
			root.hidden = false;
			fill( words );
			offer();
			rows = meshes.map( ( { name, material } ) => {
				const [ use, error ] = [ el( 'td', { class: 'number' }, '–' ), el( 'td', { class: 'number' }, '–' ) ];
				const swatch = el( 'canvas', { class: 'swatch', width: 1, height: 1, 'aria-hidden': 'true' } );
				swatch.style.background = `rgb(${ material.factors.base.map( srgb ) })`;
				const { alpha_x: x, alpha_y: y } = material;
				return { name, material, swatch, use, error, row: el( 'tr', {}, el( 'th', { scope: 'row' }, el( 'span', { class: 'named' }, swatch, name ) ), el( 'td', { class: 'number' }, ( x === y ? [ x ] : [ x, y ] ).map( ( alpha ) => number( Math.sqrt( alpha ) ) ).join( ', ' ) ), use, error ) };
			} );
			fill( materials, rows.map( ( { row } ) => row ) );
			busy( 'Planning the best table for this scene…' );
			try {
				const found = await planOf( file );
				if ( own !== turn || signal.aborted ) return;
				answer = found;
				const { summary, plan: { scene: read, tables } } = answer;
				plans = tables;
				const more = [ light( read.lights ), ...summary.slice( 1 ) ];
				fill( words, el( 'p', {}, summary[ 0 ] ), el( 'details', {}, el( 'summary', {}, 'More about the plan and the lights' ), el( 'div', {}, more.map( ( line ) => muted( line ) ) ) ) );
				for ( const { name, use } of rows ) {
					// The lobes of a material, each with the errors of light by the table, by the engine's table, and by the closed form.
					const lobes = tables.flatMap( ( { materials } ) => materials ).filter( ( { material } ) => read.materials[ material ].name === name );
					const error = ( method ) => lobes.reduce( ( sum, { share, light } ) => sum + share * ( light[ method ] ?? NaN ), 0 );
					if ( lobes.length ) use.textContent = error( 2 ) < error( 0 ) ? 'closed form' : 'table';
				}
				idle();
				offer();
				// The picture follows the advice for a new scene, unless the user has chosen the left side.
				if ( ! plans.length || ! isNew || shown() !== before ) return;
				if ( plans[ 0 ].use_closed_form ) show( closedForm() );
				else if ( plans[ 0 ].predicted.seconds <= AT_ONCE ) await fit( 0 );
			} catch ( error ) {
				if ( own === turn ) failed( error );
			}
		},
		/** Shows the mean error of each material, or null for a material that is not visible. */
		showErrors: ( errors, isDone ) => errors.forEach( ( error, i ) => rows[ i ] && fill( rows[ i ].error, error ? `${ atLeast( isDone ) }${ percent( error.sides[ 0 ].mean, 2 ) }` : 'not visible' ) ),
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
