// What a table, model normals or the shading of engines does, on the visitor's own GPU, beside the truth or each other.

import { copyButton, el, facts, fill, notice } from '../elements/dom.js';
import { short } from '../elements/format.js';
import { call } from '../service/api.js';
import { deviceFor, DRAWN_BY } from '../viewer/backend.js';
import { choice, drag, slider } from '../viewer/controls.js';
import { lightsPanel } from '../viewer/lights.js';
import { modelOf, PUBLISHED, textOf } from '../viewer/models.js';
import { camera, CHOICES, isPictured, link, METALS, moved, outline, PARAMETERS, placed, read, seen, uniformsOf } from '../viewer/scene.js';
import { shaderBall } from '../viewer/shader_ball.js';

/** Pixels a side. */
const SIZE = 512;
/** Samples of a frame, and those after which the reference is still. */
const [ PER_FRAME, MOST ] = [ 8, 1024 ];
/** The difference, in radiance, at the end of the colours. */
const DIFFERENCE = 0.2;
/** What only how the picture is shown depends on, so that samples stay. */
const SHOWN = [ 'show', 'split', 'exposure' ];

/** What is shown of both sides, by its names in a link. */
const SIDES = [ [ 'split', 'both' ], [ 'model', 'left' ], [ 'reference', 'right' ], [ 'difference', 'difference' ] ];

/** Surfaces by their names in a link. */
const SURFACES = CHOICES.surface.map( ( name ) => [ name, name.replace( '_', ' ' ) ] );

/** What draws, by its names in a link. */
const BACKENDS = [ [ 'automatic', 'WebGPU, else WebGL 2' ], [ 'webgl2', 'WebGL 2' ], [ 'webgpu', 'WebGPU' ] ];

const SVG = 'http://www.w3.org/2000/svg';

export async function show( root, rest, parameters, signal ) {

	const scene = read( parameters );
	const fresh = () => el( 'canvas', { width: SIZE, height: SIZE, role: 'img', 'aria-label': 'The surface under the lights' } );
	let canvas = fresh();
	const overlay = document.createElementNS( SVG, 'svg' );
	overlay.setAttribute( 'viewBox', '-1 -1 2 2' );
	overlay.setAttribute( 'aria-hidden', 'true' );
	const border = overlay.appendChild( document.createElementNS( SVG, 'line' ) );
	const outlines = [];
	const figures = el( 'div' );
	const { items } = await call( '/v1/tables?limit=200', { signal } );
	const known = [ ...new Set( [ scene.table, scene.against, ...items.map( ( { digest } ) => digest ) ] ) ].filter( ( name ) => name && name !== 'normals' && ! Object.hasOwn( PUBLISHED, name ) );
	const models = [ ...Object.entries( PUBLISHED ), ...known.map( ( digest ) => [ digest, `table ${ short( digest ) }` ] ) ];
	const table = choice( 'model', 'Lit by', [ [ '', 'normals, no table' ], ...models ], scene.table, ( name ) => change( 'table', name ) );
	const against = choice( 'against', 'Beside', [ [ '', 'Monte Carlo integration' ], [ 'normals', 'normals, no table' ], ...models ], scene.against, ( name ) => change( 'against', name ) );
	const choices = Object.fromEntries( [ [ 'surface', 'Surface' ], [ 'metal', 'Material' ], [ 'show', 'Shown' ], [ 'drawn_by', 'Drawn by' ] ].map( ( [ name, label ] ) => [ name, choice( `view-${ name }`, label, { show: SIDES, surface: SURFACES, drawn_by: BACKENDS }[ name ] || CHOICES[ name ], scene[ name ], ( value ) => change( name, value ) ) ] ) );
	const sliders = PARAMETERS.map( ( field ) => slider( field, '', change ) );
	const split = slider( { name: 'split', label: 'Split at', min: 0, max: 1, step: 0.01 }, '', change );
	const files = el( 'input', { type: 'file', id: 'mesh', accept: '.glb,.gltf', class: 'hidden', onchange: () => open( files.files[ 0 ] ) } );
	const opened = el( 'div', { role: 'status' } );
	const group = ( legend, ...rows ) => el( 'fieldset', {}, el( 'legend', {}, legend ), rows );
	const rows = ( ...names ) => sliders.filter( ( { name } ) => names.some( ( begin ) => name.startsWith( begin ) ) ).map( ( { row } ) => row );
	const ofSurface = el( 'div', { class: 'controls' }, choices.metal.row, rows( 'alpha', 'rotation' ) );
	const lights = lightsPanel( scene, () => change( 'lights', scene.lights ), () => begin() );

	fill( root,
		el( 'div', { class: 'bar' }, el( 'h1', {}, 'Viewer' ), el( 'span', { class: 'grow' } ), copyButton( 'Copy link', () => location.href ) ),
		el( 'div', { class: 'view' },
			el( 'div', {}, el( 'div', { class: 'stage' }, canvas, overlay ),
				el( 'p', { class: 'muted' }, 'Drag to orbit. Drag a light to move it, with Shift nearer and farther.' ), figures ),
			el( 'form', { class: 'controls', onsubmit: ( event ) => event.preventDefault() },
				group( 'Compared', table.row, against.row, choices.show.row, split.row ),
				group( 'Surface', choices.surface.row, el( 'div', { class: 'field' }, el( 'label', { for: 'mesh' }, 'glTF' ), el( 'div', { class: 'file' }, files, el( 'label', { for: 'mesh', class: 'button quiet' }, 'Open or drop a file' ) ) ), opened, ofSurface ),
				group( 'Lights', lights.row ),
				group( 'Camera', rows( 'camera', 'exposure' ), choices.drawn_by.row ) ) ) );

	/** The meshes of a glTF file that was opened; they are no part of the link. */
	let mesh = null;
	/** What draws; null until it is there. */
	let drawn = null;
	signal.addEventListener( 'abort', () => {

		drawn?.release();
		lights.release();

	} );

	/** Begins to draw, on a canvas of its own: one knows WebGL or WebGPU for good. */
	async function start( by = scene.drawn_by ) {

		drawn?.release();
		[ drawn, sides ] = [ null, null ];
		asked ++;
		const here = fresh();
		canvas.replaceWith( here );
		canvas = here;
		// Without this a lost context never comes back.
		here.addEventListener( 'webglcontextlost', ( event ) => here === canvas && ! signal.aborted && event.preventDefault() );
		here.addEventListener( 'webglcontextrestored', async () => {

			if ( here !== canvas ) return;
			drawn = await deviceFor( 'webgl2', here );
			begin();

		} );
		const failed = ( message ) => {

			if ( here !== canvas || signal.aborted ) return;
			if ( scene.drawn_by === 'automatic' ) start( 'webgl2' );
			else fill( figures, notice( message ) );

		};

		try {

			const made = await deviceFor( by, here, failed );
			if ( here !== canvas || signal.aborted ) return made.release();
			drawn = made;
			await choose();

		} catch ( error ) {

			if ( here === canvas ) fill( figures, notice( error.message ) );

		}

	}

	/** The models of both sides, null where the right one is the reference, and the text that prefilters pictures on lights. */
	let sides = null;
	let prefilter = null;
	let asked = 0;
	let samples = 0;
	let isSeen = false;
	let isMoving = false;
	let isWaiting = false;

	/** Asks for the models that the scene names; a failure is told in place of the figures. */
	async function choose() {

		const turn = ++ asked;
		sides = null;
		// It is asked again once there is what draws.
		if ( ! drawn ) return;
		try {

			const hasPictures = scene.lights.some( isPictured );
			const model = ( name ) => modelOf( name, drawn.language, hasPictures );
			const found = await Promise.all( [ model( scene.table ), scene.against ? model( scene.against === 'normals' ? '' : scene.against ) : null, hasPictures ? textOf( `prefilter.${ drawn.language }` ) : null ] );
			if ( turn !== asked || signal.aborted ) return;
			prefilter = found.pop();
			sides = found;
			begin();

		} catch ( error ) {

			if ( turn === asked && ! signal.aborted ) fill( figures, notice( error.message ) );

		}

	}

	async function open( file ) {

		if ( ! file ) return;
		try {

			const { readGltf } = await import( '../gltf/read.js' );
			const { meshes, triangles, notes } = await readGltf( await file.arrayBuffer() );
			if ( signal.aborted ) return;
			mesh = meshes;
			choices.surface.offer( [ ...SURFACES, [ 'mesh', file.name ] ], 'mesh' );
			fill( opened, el( 'p', { class: 'muted' }, [ `${ triangles.toLocaleString( 'en' ) } triangles, ${ meshes.length } material${ meshes.length > 1 ? 's' : '' }`, ...notes ].join( '; ' ) ) );
			change( 'surface', 'mesh' );

		} catch ( error ) {

			fill( opened, notice( `${ file.name }: ${ error.message }` ) );

		}

	}

	for ( const kind of [ 'dragover', 'drop' ] ) canvas.parentElement.addEventListener( kind, ( event ) => {

		event.preventDefault();
		if ( kind === 'drop' ) open( event.dataTransfer.files[ 0 ] );

	} );

	/** Shows the scene anew. */
	function begin() {

		samples = 0;
		isSeen = false;
		later();

	}

	function change( name, value ) {

		scene[ name ] = value;
		history.replaceState( null, '', `#/viewer?${ link( scene ) }` );
		tell();
		const isOther = scene.lights.some( isPictured ) !== ( prefilter !== null );
		if ( name === 'drawn_by' ) start();
		else if ( name === 'table' || name === 'against' || isOther ) choose();
		else if ( SHOWN.includes( name ) ) later();
		else begin();

	}

	function tell() {

		for ( const control of [ split, ...sliders ] ) control.tell( scene );
		lights.tell();
		// A mesh has its own materials.
		ofSurface.hidden = scene.surface === 'mesh';

	}

	function later() {

		if ( isWaiting || signal.aborted ) return;
		isWaiting = true;
		requestAnimationFrame( frame );

	}

	async function frame() {

		isWaiting = false;
		outlineLights();
		if ( signal.aborted || ! sides || ! drawn || drawn.isLost() ) return;
		const by = drawn;
		const since = performance.now();
		let calls = 0;
		try {

			calls = draw();
			await by.done();

		} catch ( error ) {

			if ( by === drawn ) fill( figures, notice( error.message ) );
			return;

		}

		if ( signal.aborted || by !== drawn ) return;

		const isReference = ! sides[ 1 ] && scene.show !== 'model';
		canvas.dataset.samples = sides[ 1 ] ? MOST : samples;
		fill( figures, facts( [ [ 'Samples', isReference ? samples : '–' ], [ 'Frame', `${ ( performance.now() - since ).toFixed( 1 ) } ms` ], [ 'Draw calls', calls ], [ 'Drawn by', DRAWN_BY[ by.language ] ] ] ), sides[ 1 ] && sides[ 1 ].brdf !== sides[ 0 ].brdf ? el( 'p', { class: 'muted' }, `Two scattering models: ${ sides[ 0 ].brdf } on the left, ${ sides[ 1 ].brdf } on the right. Both have the colour of the left one.` ) : null, scene.show === 'difference' ? el( 'div', { class: 'scale muted' }, el( 'span', {}, 'no difference' ), el( 'span', { class: 'ramp difference' } ), el( 'span', {}, `${ DIFFERENCE } of radiance and more` ) ) : null );
		if ( isMoving ) begin();
		else if ( isReference && samples < MOST ) later();

	}

	/** Draws what changed since the last frame, and tells by how many calls. */
	function draw() {

		const { eye, right, up, forward, half } = camera( scene );
		const { uniforms, shapes } = uniformsOf( scene.lights );
		const numbers = { ...uniforms, eye, size: SIZE };
		const [ left, other ] = sides;
		let calls = 1;
		if ( ! isSeen ) {

			const shown = lights.layers();
			isMoving = shown.isMoving;
			calls += drawn.picture( shown.layers, prefilter );
			const colour = ( f0 ) => left.brdf === 'ggx' ? f0 : METALS.white;
			const ofMaterial = ( { alpha_x, alpha_y, rotation, f0, factors } ) => ( { ...factors, is_white: Number( left.brdf !== 'ggx' ), f0: colour( f0 ), material: [ alpha_x, alpha_y, Math.cos( rotation ), Math.sin( rotation ) ] } );
			const view = { ...numbers, right, up, forward };
			const own = { ...scene, f0: METALS[ scene.metal ] };
			const meshes = { mesh, shader_ball: [ { numbers: shaderBall(), material: own } ] }[ scene.surface ];
			if ( meshes ) drawn.seeMeshes( view, meshes.map( ( { material, ...of } ) => ( { ...of, ofMaterial: ofMaterial( material ) } ) ) );
			else drawn.see( { ...view, ...ofMaterial( own ), pixel_width: 2 * half / SIZE, surface: CHOICES.surface.indexOf( scene.surface ) } );
			drawn.light( 'left', left, numbers, shapes );
			if ( other ) drawn.light( 'right', other, numbers, shapes );
			calls += ( meshes?.length || 1 ) + ( other ? 2 : 1 );
			isSeen = true;

		}

		if ( ! other && scene.show !== 'model' && samples < MOST ) {

			drawn.sample( left.brdf, numbers, shapes, samples, PER_FRAME );
			samples += PER_FRAME;
			calls ++;

		}

		drawn.display( { size: SIZE, exposure: scene.exposure, split: scene.split, show: CHOICES.show.indexOf( scene.show ), difference_scale: DIFFERENCE }, other ? null : samples );
		return calls;

	}

	/** The lights' outlines over the picture, which are dragged. */
	function outlineLights() {

		const from = camera( scene );
		while ( outlines.length > scene.lights.length ) outlines.pop().remove();
		while ( outlines.length < scene.lights.length ) outlines.push( dragged( outlines.length ) );
		outlines.forEach( ( polygon, i ) => {

			const seenAt = outline( scene.lights[ i ], from.eye ).map( ( corner ) => seen( from, corner ) );
			polygon.setAttribute( 'points', seenAt.every( Boolean ) ? seenAt.map( ( { x, y } ) => `${ x },${ - y }` ).join( ' ' ) : '' );
			polygon.classList.toggle( 'other', i !== lights.chosen() );

		} );
		const at = scene.show === 'split' ? 2 * scene.split - 1 : 2;
		for ( const [ name, value ] of Object.entries( { x1: at, x2: at, y1: - 1, y2: 1 } ) ) border.setAttribute( name, value );

	}

	function dragged( i ) {

		const polygon = overlay.appendChild( document.createElementNS( SVG, 'polygon' ) );
		drag( polygon, ( x, y, isNear ) => {

			const light = scene.lights[ i ];
			const from = camera( scene );
			const distance = seen( from, placed( light ).centre )?.distance || 0;
			const way = isNear ? from.forward.map( ( part ) => 2 * y * part ) : moved( from, distance, x, y );
			lights.choose( i );
			[ 'x', 'y', 'z' ].forEach( ( name, axis ) => light[ name ] = Number( ( light[ name ] + way[ axis ] ).toFixed( 3 ) ) );
			change( 'lights', scene.lights );

		} );
		return polygon;

	}

	drag( overlay, ( x, y ) => {

		change( 'camera_azimuth', wrapped( scene.camera_azimuth - 2 * x ) );
		change( 'camera_elevation', Math.min( 1.5, Math.max( - 1.5, scene.camera_elevation - 2 * y ) ) );

	} );
	tell();
	start();
	// Models that a service that went did not bring.
	return () => sides || choose();

}

const wrapped = ( angle ) => angle - 2 * Math.PI * Math.round( angle / ( 2 * Math.PI ) );
