// The viewer: compares tables, models without a table and the shading of engines with the reference or with each other, on the user's GPU.

import { bar, copyButton, el, facts, fileField, fill, muted, notice, svg, takeDrops } from '../elements/dom.js';
import { short, whole } from '../elements/format.js';
import { call } from '../service/api.js';
import { choice, drag, slider } from '../viewer/controls.js';
import { lightsPanel } from '../viewer/lights.js';
import { modelOf, NAMED, textOf } from '../viewer/models.js';
import { camera, CHOICES, isPictured, link, METALS, moved, outline, PARAMETERS, placed, projected, read, uniformsOf } from '../viewer/scene.js';
import { shaderBall } from '../viewer/shader_ball.js';
import { device } from '../webgl/device.js';

/** Pixels per side of the picture. */
const SIZE = 512;
/** Number of samples per frame, and of a finished reference. */
const [ PER_FRAME, MOST ] = [ 8, 1024 ];
/** The difference in radiance at the end of the colour scale. */
const DIFFERENCE = 0.2;
/** Members of the scene that do not affect the samples, only their display. */
const SHOWN = [ 'show', 'split', 'exposure' ];

/** The sides to show: name in a link, and label. */
const SIDES = [ [ 'split', 'both' ], [ 'model', 'left' ], [ 'reference', 'right' ], [ 'difference', 'difference' ] ];

/** The surfaces: name in a link, and label. */
const SURFACES = CHOICES.surface.map( ( name ) => [ name, name.replace( '_', ' ' ) ] );

export async function show( root, rest, parameters, signal ) {
	const scene = read( parameters );
	const canvas = el( 'canvas', { width: SIZE, height: SIZE, role: 'img', 'aria-label': 'The surface under the lights' } );
	const border = svg( 'line' );
	const overlay = svg( 'svg', { viewBox: '-1 -1 2 2', 'aria-hidden': 'true' }, border );
	const outlines = [];
	const figures = el( 'div' );
	const { items } = await call( '/v1/tables?limit=200', { signal } );
	const known = [ ...new Set( [ scene.table, scene.against, ...items.map( ( { digest } ) => digest ) ] ) ].filter( ( name ) => name && name !== 'normals' && ! Object.hasOwn( NAMED, name ) );
	const models = [ ...Object.entries( NAMED ), ...known.map( ( digest ) => [ digest, `table ${ short( digest ) }` ] ) ];
	const chosen = ( name, label, options, id = `view-${ name }` ) => choice( id, label, options, scene[ name ], ( value ) => change( name, value ) );
	const table = chosen( 'table', 'Left side', [ [ '', 'normals, no table' ], ...models ], 'model' );
	const against = chosen( 'against', 'Right side', [ [ '', 'Monte Carlo integration' ], [ 'normals', 'normals, no table' ], ...models ], 'against' );
	const [ surface, metal, sides ] = [ chosen( 'surface', 'Surface', SURFACES ), chosen( 'metal', 'Material', CHOICES.metal ), chosen( 'show', 'Show', SIDES ) ];
	const sliders = PARAMETERS.map( ( field ) => slider( field, '', change ) );
	const split = slider( { name: 'split', label: 'Split at', min: 0, max: 1, step: 0.01 }, '', change );
	const opened = el( 'div', { role: 'status' } );
	const group = ( legend, ...rows ) => el( 'fieldset', {}, el( 'legend', {}, legend ), rows );
	const rows = ( ...names ) => sliders.filter( ( { name } ) => names.some( ( prefix ) => name.startsWith( prefix ) ) ).map( ( { row } ) => row );
	const ofSurface = el( 'div', { class: 'controls' }, metal.row, rows( 'alpha', 'rotation' ) );
	const lights = lightsPanel( scene, () => change( 'lights', scene.lights ), () => restart() );

	fill( root,
		bar( 'Viewer', null, copyButton( 'Copy link', () => location.href ) ),
		el( 'div', { class: 'view' },
			el( 'div', {}, el( 'div', { class: 'stage' }, canvas, overlay ),
				muted( 'Drag to orbit. Drag a light to move it. Hold Shift to move it nearer or farther.' ), figures ),
			el( 'form', { class: 'controls', onsubmit: ( event ) => event.preventDefault() },
				group( 'Compare', table.row, against.row, sides.row, split.row ),
				group( 'Surface', surface.row, el( 'div', { class: 'field' }, el( 'label', { for: 'mesh' }, 'glTF' ), el( 'div', { class: 'file' }, fileField( 'mesh', '.glb,.gltf', 'Open or drop a file', open ) ) ), opened, ofSurface ),
				group( 'Lights', lights.row ),
				group( 'Camera', rows( 'camera', 'exposure' ) ) ) ) );

	/** The meshes of an opened glTF file. Links do not contain them. */
	let mesh = null;
	/** The WebGL device, or null if WebGL 2 is missing. */
	let gpu = null;
	/** The models of both sides, where null means the reference, and the shader text that prefilters pictures on lights. */
	let lit = null;
	let prefilter = null;
	let asked = 0;
	let samples = 0;
	let isDrawn = false;
	let isMoving = false;
	let isWaiting = false;

	function start() {
		gpu = device( canvas );
		restart();
	}

	/** Shows an error instead of the figures. */
	const failed = ( error ) => signal.aborted || fill( figures, notice( error.message ) );
	// Browsers restore a lost context only if the default action is prevented.
	canvas.addEventListener( 'webglcontextlost', ( event ) => signal.aborted || event.preventDefault() );
	canvas.addEventListener( 'webglcontextrestored', start );
	signal.addEventListener( 'abort', () => {
		gpu?.release();
		lights.release();
	} );

	/** Loads the models that are selected in the scene. */
	async function choose() {
		const turn = ++ asked;
		lit = null;
		try {
			const hasPictures = scene.lights.some( isPictured );
			const right = scene.against ? modelOf( scene.against === 'normals' ? '' : scene.against, hasPictures ) : null;
			const found = await Promise.all( [ modelOf( scene.table, hasPictures ), right, hasPictures ? textOf( 'prefilter.glsl' ) : null ] );
			if ( turn !== asked || signal.aborted ) return;
			prefilter = found.pop();
			lit = found;
			restart();
		} catch ( error ) {
			if ( turn === asked ) failed( error );
		}
	}

	async function open( file ) {
		try {
			const { readGltf } = await import( '../gltf/read.js' );
			const { meshes, triangles, notes } = await readGltf( await file.arrayBuffer() );
			if ( signal.aborted ) return;
			mesh = meshes;
			surface.offer( [ ...SURFACES, [ 'mesh', file.name ] ], 'mesh' );
			fill( opened, muted( [ `${ whole( triangles ) } triangles, ${ meshes.length } material${ meshes.length > 1 ? 's' : '' }`, ...notes ].join( '; ' ) ) );
			change( 'surface', 'mesh' );
		} catch ( error ) {
			fill( opened, notice( `${ file.name }: ${ error.message }` ) );
		}
	}

	takeDrops( canvas.parentElement, open );

	/** Draws the scene again, starting with the first sample. */
	function restart() {
		samples = 0;
		isDrawn = false;
		requestFrame();
	}

	function change( name, value ) {
		scene[ name ] = value;
		history.replaceState( null, '', `#/viewer?${ link( scene ) }` );
		showValues();
		const needsOtherModels = scene.lights.some( isPictured ) !== ( prefilter !== null );
		if ( name === 'table' || name === 'against' || needsOtherModels ) choose();
		else if ( SHOWN.includes( name ) ) requestFrame();
		else restart();
	}

	function showValues() {
		for ( const control of [ split, ...sliders ] ) control.show( scene );
		lights.show();
		// A glTF file has its own materials.
		ofSurface.hidden = scene.surface === 'mesh';
	}

	function requestFrame() {
		if ( isWaiting || signal.aborted ) return;
		isWaiting = true;
		requestAnimationFrame( frame );
	}

	function frame() {
		isWaiting = false;
		outlineLights();
		if ( signal.aborted || ! lit || ! gpu || gpu.isLost() ) return;
		const since = performance.now();
		let calls = 0;
		try {
			calls = draw();
		} catch ( error ) {
			return failed( error );
		}

		const [ left, right ] = lit;
		const isReference = ! right && scene.show !== 'model';
		canvas.dataset.samples = right ? MOST : samples;
		fill( figures,
			facts( [ [ 'Samples', isReference ? samples : '–' ], [ 'Frame time', `${ ( performance.now() - since ).toFixed( 1 ) } ms` ], [ 'Draw calls', calls ] ] ),
			right && right.brdf !== left.brdf ? muted( `Two scattering models: ${ left.brdf } on the left, ${ right.brdf } on the right. Both use the colour of the left side.` ) : null,
			scene.show === 'difference' ? el( 'div', { class: 'scale muted' }, el( 'span', {}, 'no difference' ), el( 'span', { class: 'ramp difference' } ), el( 'span', {}, `radiance differs by ${ DIFFERENCE } or more` ) ) : null );
		if ( isMoving ) restart();
		else if ( isReference && samples < MOST ) requestFrame();
	}

	/** Draws the changes since the last frame. Returns the number of draw calls. */
	function draw() {
		const { eye, right, up, forward, half } = camera( scene );
		const { uniforms, shapes } = uniformsOf( scene.lights );
		const numbers = { ...uniforms, eye, size: SIZE };
		const [ left, other ] = lit;
		let calls = 1;
		if ( ! isDrawn ) {
			const shown = lights.layers();
			isMoving = shown.isMoving;
			calls += gpu.picture( shown.layers, prefilter );
			const isWhite = left.brdf !== 'ggx';
			const ofMaterial = ( { alpha_x, alpha_y, rotation, f0, factors } ) => ( { ...factors, is_white: Number( isWhite ), f0: isWhite ? METALS.white : f0, material: [ alpha_x, alpha_y, Math.cos( rotation ), Math.sin( rotation ) ] } );
			const view = { ...numbers, right, up, forward };
			const own = { ...scene, f0: METALS[ scene.metal ] };
			const meshes = { mesh, shader_ball: [ { numbers: shaderBall(), material: own } ] }[ scene.surface ];
			if ( meshes ) gpu.drawMeshes( view, meshes.map( ( { material, ...of } ) => ( { ...of, ofMaterial: ofMaterial( material ) } ) ) );
			else gpu.drawSurface( { ...view, ...ofMaterial( own ), pixel_width: 2 * half / SIZE, surface: CHOICES.surface.indexOf( scene.surface ) } );
			gpu.light( 'left', left, numbers, shapes );
			if ( other ) gpu.light( 'right', other, numbers, shapes );
			calls += ( meshes?.length || 1 ) + ( other ? 2 : 1 );
			isDrawn = true;
		}

		if ( ! other && scene.show !== 'model' && samples < MOST ) {
			gpu.sample( left.brdf, numbers, shapes, samples, PER_FRAME );
			samples += PER_FRAME;
			calls ++;
		}

		gpu.display( { size: SIZE, exposure: scene.exposure, split: scene.split, show: CHOICES.show.indexOf( scene.show ), difference_scale: DIFFERENCE }, other ? null : samples );
		return calls;
	}

	/** Draws the outlines of the lights over the picture. Users can drag the outlines. */
	function outlineLights() {
		const from = camera( scene );
		while ( outlines.length > scene.lights.length ) outlines.pop().remove();
		while ( outlines.length < scene.lights.length ) outlines.push( dragged( outlines.length ) );
		outlines.forEach( ( polygon, i ) => {
			const points = outline( scene.lights[ i ], from.eye ).map( ( corner ) => projected( from, corner ) );
			polygon.setAttribute( 'points', points.every( Boolean ) ? points.map( ( { x, y } ) => `${ x },${ - y }` ).join( ' ' ) : '' );
			polygon.classList.toggle( 'other', i !== lights.chosen() );
		} );
		const at = scene.show === 'split' ? 2 * scene.split - 1 : 2;
		for ( const [ name, value ] of Object.entries( { x1: at, x2: at, y1: - 1, y2: 1 } ) ) border.setAttribute( name, value );
	}

	function dragged( i ) {
		const polygon = overlay.appendChild( svg( 'polygon' ) );
		drag( polygon, ( x, y, isNear ) => {
			const light = scene.lights[ i ];
			const from = camera( scene );
			const distance = projected( from, placed( light ).centre )?.distance || 0;
			const way = isNear ? from.forward.map( ( part ) => 2 * y * part ) : moved( from, distance, x, y );
			lights.take( i );
			[ 'x', 'y', 'z' ].forEach( ( name, axis ) => light[ name ] = Number( ( light[ name ] + way[ axis ] ).toFixed( 3 ) ) );
			change( 'lights', scene.lights );
		} );
		return polygon;
	}

	drag( overlay, ( x, y ) => {
		const azimuth = scene.camera_azimuth - 2 * x;
		change( 'camera_azimuth', azimuth - 2 * Math.PI * Math.round( azimuth / ( 2 * Math.PI ) ) );
		change( 'camera_elevation', Math.min( 1.5, Math.max( - 1.5, scene.camera_elevation - 2 * y ) ) );
	} );
	showValues();
	try {
		start();
		choose();
	} catch ( error ) {
		failed( error );
	}

	// The service may have stopped before it returned the models.
	return () => lit || choose();
}
