// What a table or model normals does, on the visitor's own GPU, beside the truth.

import { call, manifest } from './api.js';
import { copyButton, el, facts, fill, notice } from './dom.js';
import { device } from './device.js';
import { number, short } from './format.js';
import { camera, CHOICES, light, link, METALS, moved, PARAMETERS, read, seen } from './scene.js';

/** Pixels a side. */
const SIZE = 512;
/** Samples of a frame, and those after which the reference is still. */
const [ PER_FRAME, MOST ] = [ 8, 1024 ];
/** The difference, in radiance, at the end of the colours. */
const DIFFERENCE = 0.2;

const SVG = 'http://www.w3.org/2000/svg';

export async function show( root, rest, parameters, signal ) {

	const scene = read( parameters );
	const canvas = el( 'canvas', { width: SIZE, height: SIZE, role: 'img', 'aria-label': 'The surface under the light' } );
	const overlay = document.createElementNS( SVG, 'svg' );
	overlay.setAttribute( 'viewBox', '-1 -1 2 2' );
	overlay.setAttribute( 'aria-hidden', 'true' );
	const border = overlay.appendChild( document.createElementNS( SVG, 'line' ) );
	const outline = overlay.appendChild( document.createElementNS( SVG, 'polygon' ) );
	const figures = el( 'div' );
	const { items } = await call( '/v1/tables?limit=200', { signal } );
	const known = [ ...new Set( [ ...( scene.table ? [ scene.table ] : [] ), ...items.map( ( { digest } ) => digest ) ] ) ];
	const model = el( 'select', { id: 'model', onchange: () => location.hash = `#/viewer?${ link( { ...scene, table: model.value } ) }` },
		el( 'option', { value: '' }, 'normals, without a table' ), known.map( ( digest ) => el( 'option', { value: digest, selected: digest === scene.table }, `table ${ short( digest ) }` ) ) );
	const sliders = new Map( PARAMETERS.map( ( field ) => [ field.name, slider( field ) ] ) );
	const split = slider( { name: 'split', label: 'Split at', min: 0, max: 1, step: 0.01 } );

	function slider( { name, label, min, max, step } ) {

		const output = el( 'output', { for: `view-${ name }` } );
		const input = el( 'input', { type: 'range', id: `view-${ name }`, min, max, step, oninput: () => change( name, Number( input.value ) ) } );
		const tell = () => {

			input.value = scene[ name ];
			output.textContent = number( scene[ name ] );

		};

		tell();
		return { tell, row: el( 'div', { class: 'slider' }, el( 'label', { for: `view-${ name }` }, label ), input, output ) };

	}

	const choice = ( name, label ) => {

		const select = el( 'select', { id: `view-${ name }`, onchange: () => change( name, select.value ) }, CHOICES[ name ].map( ( option ) => el( 'option', { selected: option === scene[ name ] }, option ) ) );
		return el( 'div', { class: 'field' }, el( 'label', { for: `view-${ name }` }, label ), select );

	};

	fill( root,
		el( 'div', { class: 'bar' }, el( 'h1', {}, 'Viewer' ), el( 'span', { class: 'grow' } ), copyButton( 'Copy link', () => location.href ) ),
		el( 'div', { class: 'view' },
			el( 'div', {}, el( 'div', { class: 'stage' }, canvas, overlay ),
				el( 'p', { class: 'muted' }, 'Drag to orbit, drag the light to move it. Left of the split is the model, right of it Monte Carlo integration of GGX.' ), figures ),
			el( 'form', { class: 'controls' },
				el( 'div', { class: 'field' }, el( 'label', { for: 'model' }, 'Lit by' ), model ),
				choice( 'surface', 'Surface' ), choice( 'metal', 'Material' ), choice( 'show', 'Shown' ), split.row, [ ...sliders.values() ].map( ( { row } ) => row ) ) ) );

	const recipe = scene.table ? ( await manifest( scene.table ) ).recipe : null;
	const refused = recipe && unfit( recipe );
	if ( refused ) return fill( figures, notice( refused ) ) && null;
	const drawn = await device( canvas, scene.table, recipe?.layout ).catch( ( error ) => fill( figures, notice( error.message ) ) && null );
	if ( ! drawn ) return null;
	signal.addEventListener( 'abort', () => drawn.release() );

	let samples = 0;
	let isWaiting = false;
	/** What the shaders read. Samples stay while only how they are shown changes. */
	function uniforms() {

		const { eye, right, up, forward, half } = camera( scene );
		const { normal, area, corners } = light( scene );
		const turn = scene.rotation;
		return {
			size: SIZE, surface: CHOICES.surface.indexOf( scene.surface ), eye, right, up, forward, pixel_width: 2 * half / SIZE,
			f0: METALS[ scene.metal ], 'corners': corners, light_normal: normal, light_area: area, radiance: scene.light_intensity,
			material: [ scene.alpha_x, scene.alpha_y, Math.cos( turn ), Math.sin( turn ) ], exposure: scene.exposure,
			split: scene.split, show: CHOICES.show.indexOf( scene.show ), difference_scale: DIFFERENCE,
		};

	}

	function change( name, value ) {

		scene[ name ] = value;
		if ( ! [ 'show', 'split', 'exposure', 'metal' ].includes( name ) ) samples = 0;
		( name === 'split' ? split : sliders.get( name ) )?.tell();
		history.replaceState( null, '', `#/viewer?${ link( scene ) }` );
		later();

	}

	function later() {

		if ( isWaiting || signal.aborted ) return;
		isWaiting = true;
		requestAnimationFrame( frame );

	}

	function frame() {

		isWaiting = false;
		if ( signal.aborted ) return;
		const start = performance.now();
		const numbers = uniforms();
		const isCompared = scene.show !== 'model';
		if ( isCompared && samples < MOST ) {

			drawn.sample( numbers, samples, PER_FRAME );
			samples += PER_FRAME;

		}

		drawn.draw( numbers, samples );
		const seenAt = light( scene ).corners.map( ( corner ) => seen( camera( scene ), corner ) );
		outline.setAttribute( 'points', seenAt.every( Boolean ) ? seenAt.map( ( { x, y } ) => `${ x },${ - y }` ).join( ' ' ) : '' );
		const at = scene.show === 'split' ? 2 * scene.split - 1 : 2;
		for ( const [ name, value ] of Object.entries( { x1: at, x2: at, y1: - 1, y2: 1 } ) ) border.setAttribute( name, value );
		canvas.dataset.samples = samples;
		fill( figures, facts( [ [ 'Samples', isCompared ? samples : '–' ], [ 'Frame', `${ ( performance.now() - start ).toFixed( 1 ) } ms` ], [ 'Draw calls', isCompared && samples < MOST ? 2 : 1 ], scene.show === 'difference' && [ 'Red is', `${ DIFFERENCE } of radiance` ] ] ) );
		if ( isCompared && samples < MOST ) later();

	}

	drag( overlay, ( x, y ) => {

		change( 'camera_azimuth', wrapped( scene.camera_azimuth - 2 * x ) );
		change( 'camera_elevation', Math.min( 1.5, Math.max( - 1.5, scene.camera_elevation - 2 * y ) ) );

	} );
	drag( outline, ( x, y ) => {

		const { centre } = light( scene );
		const from = camera( scene );
		const way = moved( from, seen( from, centre )?.distance || 0, x, y );
		[ 'light_x', 'light_y', 'light_z' ].forEach( ( name, i ) => change( name, Number( ( centre[ i ] + way[ i ] ).toFixed( 3 ) ) ) );

	} );
	later();
	return () => {};

}

/** Why a table is not shown: the reference beside it is of GGX, and the text reads one LTC an entry. */
function unfit( { brdf, lobe, fresnel } ) {

	if ( brdf !== 'ggx' ) return `The reference here is of GGX, and this table is of ${ brdf }; its page has a picture beside its own.`;
	if ( lobe ) return `This table is of lobe ${ lobe }, and the shader here reads LTCs.`;
	return typeof fresnel === 'string' ? 'This table has two lobes an entry, and the shader here reads one.' : '';

}

const wrapped = ( angle ) => angle - 2 * Math.PI * Math.round( angle / ( 2 * Math.PI ) );

/** Tells how far a pointer is dragged over an element, in halves of the picture, y upwards. */
function drag( element, onMove ) {

	element.addEventListener( 'pointerdown', ( event ) => {

		event.stopPropagation();
		event.preventDefault();
		element.setPointerCapture( event.pointerId );
		const half = ( element.ownerSVGElement || element ).getBoundingClientRect().width / 2;
		let [ x, y ] = [ event.clientX, event.clientY ];
		const move = ( to ) => {

			onMove( ( to.clientX - x ) / half, ( y - to.clientY ) / half );
			[ x, y ] = [ to.clientX, to.clientY ];

		};

		const end = () => element.removeEventListener( 'pointermove', move );
		element.addEventListener( 'pointermove', move );
		element.addEventListener( 'pointerup', end, { once: true } );
		element.addEventListener( 'pointercancel', end, { once: true } );

	} );

}
