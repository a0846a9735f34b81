// The viewer: compares tables, models without a table and the shading of engines with the truth or with each other, on the user's GPU.

import { bar, copyButton, el, facts, fileField, fill, muted, notice, takeDrops } from '../elements/dom.js';
import { atLeast, number, percent, whole } from '../elements/format.js';
import { isLookup, nameOf } from '../elements/recipe.js';
import { readGltf } from '../gltf/read.js';
import { call } from '../service/api.js';
import { keep, kept } from '../service/kept.js';
import { choice, slider } from '../viewer/controls.js';
import { lightsPanel } from '../viewer/lights.js';
import { modelOf, NAMED, NORMALS, textOf } from '../viewer/models.js';
import { ownLights } from '../viewer/own_lights.js';
import { planned } from '../viewer/planned.js';
import { picture } from '../viewer/picture.js';
import { areNew, CHOICES, DIFFUSE, isPictured, link, MOST_PIXELS, PARAMETERS, read } from '../viewer/scene.js';
import { stage } from '../viewer/stage.js';
import { loadShaders } from '../webgl/shaders.js';

/** Members of the scene that do not affect the samples, only their display. */
const SHOWN = [ 'show', 'split', 'exposure', 'glow' ];

/** The sides to show: name in a link, and label. */
const SIDES = [ [ 'split', 'both' ], [ 'model', 'left' ], [ 'reference', 'right' ], [ 'difference', 'left minus right' ] ];

/** The surfaces: name in a link, and label. */
const SURFACES = CHOICES.surface.slice( 0, - 1 ).map( ( name ) => [ name, name.replace( '_', ' ' ) ] );

/** Without a GPU, frames take more milliseconds than this. While the service plans and fits, pauses of so many frames leave it the processor. */
const [ SLOW, PAUSES ] = [ 30, 10 ];

/** The name of Monte Carlo integration. */
const TRUTH = 'Monte Carlo integration';

export async function show( root, rest, parameters, signal ) {
	const scene = read( parameters );
	const canvas = el( 'canvas', { width: 64, height: 64, role: 'img', 'aria-label': 'The surface under the lights' } );
	const figures = el( 'div' );
	const [ listed ] = await Promise.all( [ call( '/v1/tables?limit=200', { signal } ), loadShaders() ] );
	const items = listed.items.filter( ( { recipe } ) => ! recipe || ! isLookup( recipe ) );
	const known = [ ...new Set( [ scene.table, scene.against, ...items.map( ( { digest } ) => digest ) ] ) ].filter( ( name ) => name && name !== 'normals' && ! Object.hasOwn( NAMED, name ) );
	const models = [ ...Object.entries( NAMED ), ...known.map( ( digest ) => [ digest, `table ${ nameOf( items.find( ( item ) => item.digest === digest ) ?? { digest } ) }` ] ) ];
	const lefts = [ [ '', NORMALS ], ...models ];
	const rights = [ [ '', TRUTH ], [ 'normals', NORMALS ], ...models ];
	const chosen = ( name, label, options, id = `view-${ name }` ) => choice( id, label, options, scene[ name ], ( value ) => change( name, value ) );
	const table = chosen( 'table', 'Left side', lefts, 'model' );
	const against = chosen( 'against', 'Right side', rights, 'against' );
	const [ surface, metal, sides ] = [ chosen( 'surface', 'Surface', SURFACES ), chosen( 'metal', 'Material', CHOICES.metal ), chosen( 'show', 'Show', SIDES ) ];
	const [ occluders, shadows ] = [ chosen( 'occluders', 'Occluders', CHOICES.occluders.map( ( name ) => [ name, name.replaceAll( '_', ' ' ) ] ) ), chosen( 'shadows', 'Shadows', [ [ '4', '4 samples per pixel' ], [ '1', '1 sample per pixel' ], [ 'off', 'only in the truth' ] ] ) ];
	const [ glow, diffuse ] = [ chosen( 'glow', 'Lights', [ [ 'on', 'shown' ], [ 'off', 'hidden' ] ] ), chosen( 'diffuse', 'Diffuse part', CHOICES.diffuse ) ];
	const sliders = PARAMETERS.map( ( field ) => slider( field, '', change ) );
	const split = slider( { name: 'split', label: 'Split position', min: 0, max: 1, step: 0.01 }, '', change );
	const opened = el( 'div', { role: 'status' } );
	const group = ( legend, ...rows ) => el( 'fieldset', {}, el( 'legend', {}, legend ), rows );
	const rows = ( ...names ) => sliders.filter( ( { name } ) => names.some( ( prefix ) => name.startsWith( prefix ) ) ).map( ( { row } ) => row );
	const ofSurface = el( 'div', { class: 'controls' }, metal.row, rows( 'alpha', 'rotation' ) );
	const ofOccluders = el( 'div', { class: 'controls' }, shadows.row, rows( 'occluder' ) );
	const lights = lightsPanel( scene, () => change( 'lights', scene.lights ), () => restart() );
	let pointed = null;
	const overlay = stage( scene, lights, change, ( place ) => {
		pointed = place;
		requestFrame();
	} );
	const dropped = planned( ( name, label ) => {
		for ( const [ control, options, chosen ] of [ [ table, lefts, name ], [ against, rights, scene.against ] ] ) {
			const known = options.findIndex( ( [ other ] ) => other === name );
			if ( label ) options.splice( known < 0 ? options.length : known, 1, [ name, label ] );
			control.offer( options, chosen );
		}
		change( 'table', name );
	}, () => scene.table, useLights, signal );
	const place = el( 'div', { class: 'stage' }, canvas, overlay.root );
	fill( root,
		bar( 'Viewer', null, copyButton( 'Copy link', () => location.href ) ),
		el( 'div', { class: 'view' },
			el( 'div', { class: 'shown' }, place, muted( 'Drag to orbit, scroll or pinch to zoom, double-click to reset. Drag a light or its two handles; hold Shift to move it nearer or farther.' ), figures ),
			el( 'form', { class: 'controls', onsubmit: ( event ) => event.preventDefault() },
				dropped.root,
				group( 'Compare', table.row, against.row, sides.row, split.row ),
				group( 'Camera', rows( 'camera', 'exposure' ) ),
				group( 'Surface', surface.row, el( 'div', { class: 'field' }, el( 'label', { for: 'mesh' }, 'glTF' ), el( 'div', { class: 'file' }, fileField( 'mesh', '.glb,.gltf', 'Open or drop a file', open ) ) ), opened, ofSurface, diffuse.row ),
				group( 'Lights', glow.row, lights.row ),
				group( 'Shadows', occluders.row, ofOccluders ) ) ) );

	/** The meshes of an opened glTF file. Links do not contain them. */
	let mesh = null;
	/** The middle and the radius of the scene in the file. */
	let sceneAt = null;
	/** The picture, or null if WebGL 2 is missing. */
	let drawn = null;
	/** The models of both sides, where null means the truth, and shader texts: one prefilters pictures on lights, one samples shadows. */
	let lit = null;
	let texts = {};
	let asked = 0;
	let isWaiting = false;
	/** Whether the materials of the scene have pictures with the model of the left side. */
	let isPainted = false;
	/** Result of the last frame, or null after a change. */
	let last = null;

	function start() {
		drawn = picture( canvas );
		restart();
	}

	/** Shows an error instead of the figures. */
	const failed = ( error ) => signal.aborted || fill( figures, notice( error.message ) );
	// Browsers restore a lost context only if the default action is prevented.
	canvas.addEventListener( 'webglcontextlost', ( event ) => signal.aborted || event.preventDefault() );
	canvas.addEventListener( 'webglcontextrestored', start );
	const resized = new ResizeObserver( () => size() !== canvas.width && restart() );
	signal.addEventListener( 'abort', () => {
		resized.disconnect();
		drawn?.release();
		lights.release();
	} );

	/** Pixels per side: those of the screen, or the number in the link. */
	const size = () => scene.size || Math.min( MOST_PIXELS, Math.max( 64, Math.round( place.clientWidth * devicePixelRatio ) ) );

	/** The shader texts that the scene needs, apart from its models. */
	const needed = () => [ scene.lights.some( isPictured ) && 'prefilter.glsl', scene.occluders !== 'none' && scene.shadows !== 'off' && 'samplers.glsl' ];

	/** Loads the models that are selected in the scene. */
	async function choose() {
		const turn = ++ asked;
		lit = null;
		try {
			const hasPictures = scene.lights.some( isPictured );
			const right = scene.against ? modelOf( scene.against === 'normals' ? '' : scene.against, hasPictures ) : null;
			const [ prefilter, samplers ] = needed().map( ( file ) => file && textOf( file ) );
			const found = await Promise.all( [ modelOf( scene.table, hasPictures ), right, prefilter, samplers ] );
			if ( turn !== asked || signal.aborted ) return;
			texts = { samplers: found.pop(), prefilter: found.pop() };
			lit = found;
			isPainted = false;
			restart();
		} catch ( error ) {
			if ( turn === asked ) failed( error );
		}
	}

	/** Opens a glTF file. If it is new, its plan chooses the left side. */
	async function open( file, isNew = true ) {
		try {
			const { meshes, place: found, triangles, notes } = await readGltf( await file.arrayBuffer() );
			if ( signal.aborted ) return;
			[ mesh, sceneAt, isPainted ] = [ meshes, found, false ];
			keep( file );
			surface.offer( [ ...SURFACES, [ 'mesh', file.name ] ], 'mesh' );
			fill( opened, muted( [ `${ whole( triangles ) } triangles, ${ meshes.length } material${ meshes.length > 1 ? 's' : '' }`, ...notes ].join( '; ' ) ) );
			scene.mesh = file.name;
			change( 'surface', 'mesh' );
			dropped.start( file, meshes, isNew );
		} catch ( error ) {
			fill( opened, notice( `${ file.name }: ${ error.message }` ) );
		}
	}

	/** Replaces the light of a dropped scene by its own lights, unless the user has changed the light. Returns a sentence about the lights. */
	function useLights( found ) {
		const { lights: own, count } = ownLights( found, sceneAt );
		if ( ! count ) return 'The scene has no area lights. The plan judges by random rectangles around each surface, not by the light shown here, which you can drag.';
		if ( ! areNew( scene.lights ) ) return `The scene has ${ count } area lights. Your own lights are used instead.`;
		scene.lights = own;
		lights.take( 0 );
		change( 'lights', own );
		return `Lit by ${ own.length < count ? `the ${ own.length } strongest of ` : '' }the scene’s ${ count } area lights, scaled by one factor.`;
	}

	/** Opens the file that the link names, if this browser keeps it. */
	async function reopen() {
		const file = await kept();
		if ( file && file.name === scene.mesh ) return open( file, parameters.has( 'dropped' ) );
		fill( opened, notice( `This link shows ${ scene.mesh || 'a glTF file' }, but links contain no files. Drop the file here.` ) );
		change( 'surface', CHOICES.surface[ 0 ] );
	}
	takeDrops( place, open );

	/** Draws the scene again, starting with the first sample. */
	function restart() {
		drawn?.restart();
		last = null;
		requestFrame();
	}

	function change( name, value ) {
		scene[ name ] = value;
		history.replaceState( null, '', `#/viewer?${ link( scene ) }` );
		showValues();
		const needsOtherModels = needed().some( ( file, i ) => Boolean( file ) !== Boolean( [ texts.prefilter, texts.samplers ][ i ] ) );
		if ( name === 'table' || name === 'against' || needsOtherModels ) choose();
		else if ( SHOWN.includes( name ) ) requestFrame();
		else restart();
	}

	function showValues() {
		for ( const control of [ split, ...sliders ] ) control.show( scene );
		lights.show();
		// A glTF file has its own materials.
		ofSurface.hidden = scene.surface === 'mesh';
		ofOccluders.hidden = scene.occluders === 'none';
		dropped.hide( scene.surface !== 'mesh' );
		diffuse.row.hidden = scene.surface !== 'mesh' && ! DIFFUSE[ scene.metal ];
	}

	function requestFrame() {
		if ( isWaiting || signal.aborted ) return;
		isWaiting = true;
		requestAnimationFrame( frame );
	}

	function frame() {
		isWaiting = false;
		overlay.draw();
		if ( signal.aborted || ! lit || ! drawn || drawn.isLost() || scene.surface === 'mesh' && ! mesh ) return;
		try {
			if ( ! isPainted && scene.surface === 'mesh' && dropped.isPlanned() ) {
				dropped.paint( canvas, ( material ) => drawn.swatch( material, lit[ 0 ] ) );
				isPainted = true;
			}
			last = drawn.draw( scene, size(), mesh, lit, lights.layers, texts );
			showFigures();
			if ( last.ofMeshes ) dropped.showErrors( last.ofMeshes, last.isDone );
		} catch ( error ) {
			return failed( error );
		}
		if ( last.isMoving ) restart();
		else if ( ! last.isDone && dropped.isBusy() && last.milliseconds > SLOW ) setTimeout( requestFrame, PAUSES * last.milliseconds );
		else if ( ! last.isDone ) requestFrame();
	}

	/** The error of a side, and its value under the pointer. */
	function row( name, error, value, truth ) {
		const away = value !== null && value !== undefined && truth ? ` (${ value < truth ? '−' : '+' }${ percent( Math.abs( value / truth - 1 ) ) })` : '';
		return el( 'tr', {}, el( 'th', { scope: 'row' }, name ), [ error && `${ atLeast( last.isDone ) }${ percent( error.mean, 2 ) }`, error && percent( error.worst, 0 ), `${ number( value ) }${ away }` ].map( ( text ) => el( 'td', { class: 'number' }, text ?? '–' ) ) );
	}

	function showFigures() {
		const [ left, right ] = lit;
		const { samples, milliseconds, calls, errors, scale } = last;
		const { width } = canvas;
		const at = pointed ? drawn.at( ...[ pointed[ 0 ], 1 - pointed[ 1 ] ].map( ( part ) => Math.min( width - 1, Math.max( 0, Math.floor( part * width ) ) ) ) ) : {};
		const label = ( options, value ) => options.find( ( [ name ] ) => name === value )?.[ 1 ];
		canvas.dataset.samples = samples;
		canvas.dataset.errors = JSON.stringify( errors );
		fill( figures,
			el( 'table', { class: 'figures' },
				el( 'thead', {}, el( 'tr', {}, [ 'Error against the truth', 'mean', 'worst', 'radiance at the pointer' ].map( ( name, i ) => el( 'th', { scope: 'col', class: i ? 'number' : null }, name ) ) ) ),
				el( 'tbody', {},
					row( `Left: ${ label( lefts, scene.table ) }`, errors?.sides[ 0 ], at.left, at.truth ),
					right ? row( `Right: ${ label( rights, scene.against ) }`, errors?.sides[ 1 ], at.right, at.truth ) : null,
					row( `${ right ? 'Truth' : 'Right' }: ${ TRUTH }`, null, at.truth, null ) ) ),
			scene.show === 'difference' ? el( 'div', { class: 'scale muted' }, el( 'span', {}, `−${ number( scale ) }: left darker` ), el( 'span', { class: 'ramp signed' } ), el( 'span', {}, `left brighter: +${ number( scale ) }` ) ) : null,
			facts( [ [ 'Samples', whole( samples ) ], [ 'Noise of the truth', errors ? percent( errors.noise, 2 ) : '–' ], [ 'Frame time', `${ milliseconds.toFixed( 1 ) } ms` ], [ 'Draw calls', calls ] ] ),
			right && right.brdf !== left.brdf ? muted( `Two scattering models: ${ left.brdf } on the left, ${ right.brdf } on the right. Both use the colour of the left side.` ) : null );
	}
	showValues();
	try {
		start();
		resized.observe( place );
		if ( scene.surface === 'mesh' ) reopen();
		choose();
	} catch ( error ) {
		failed( error );
	}
	// The service may have stopped before it returned the models.
	return () => lit || choose();
}
