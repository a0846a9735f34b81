// What lies over the picture: outlines and handles of lights, and the border between both sides. It also takes gestures.

import { svg } from '../elements/dom.js';
import { bounded, camera, dot, moved, outline, PARAMETERS, placed, plus, projected, scaled, unit } from './scene.js';

/** Length of the handle that turns a light. */
const REACH = 0.6;

/** Added to squared lengths when the tip of the handle is moved. */
const DAMPING = 1e-3;

/** Steps of keys: names and values to add. A negative distance step zooms in. */
const KEYS = {
	ArrowLeft: [ 'camera_azimuth', 0.1 ], ArrowRight: [ 'camera_azimuth', - 0.1 ], ArrowUp: [ 'camera_elevation', 0.1 ], ArrowDown: [ 'camera_elevation', - 0.1 ],
	'+': [ 'camera_distance', - 0.5 ], '-': [ 'camera_distance', 0.5 ], '[': [ 'split', - 0.05 ], ']': [ 'split', 0.05 ],
};

/** Calls `onMove` while the user drags an element with one pointer: the movement to the right and upwards, relative to half of the picture's width, and whether Shift is pressed. Calls `onPinch` with the ratio of distances between two pointers. */
function drag( element, onMove, onPinch ) {
	const pointers = new Map();
	const apart = () => {
		const [ a, b ] = [ ...pointers.values() ];
		return Math.hypot( a.clientX - b.clientX, a.clientY - b.clientY );
	};
	element.addEventListener( 'pointerdown', ( event ) => {
		event.stopPropagation();
		element.setPointerCapture( event.pointerId );
		if ( pointers.size < 2 ) pointers.set( event.pointerId, event );
	} );
	element.addEventListener( 'pointermove', ( event ) => {
		const from = pointers.get( event.pointerId );
		if ( ! from ) return;
		const before = pointers.size > 1 && apart();
		pointers.set( event.pointerId, event );
		const half = ( element.ownerSVGElement || element ).getBoundingClientRect().width / 2;
		if ( before ) onPinch?.( before / Math.max( apart(), 1 ) );
		else onMove( ( event.clientX - from.clientX ) / half, ( from.clientY - event.clientY ) / half, event.shiftKey );
	} );
	element.addEventListener( 'lostpointercapture', ( event ) => pointers.delete( event.pointerId ) );
}

/** The overlay of a scene. `change` is called with the name and the value of a parameter, and `point` with a place in the picture from 0 to 1, or null. `lights` knows the selected light. */
export function stage( scene, lights, change, point ) {
	const border = svg( 'line', { class: 'border' } );
	const grip = svg( 'line', { class: 'grip' } );
	const arm = svg( 'line', { class: 'arm' } );
	const [ turn, stretch ] = [ 'turn', 'stretch' ].map( ( name ) => svg( 'circle', { class: name, r: 0.025 } ) );
	const shapes = svg( 'g' );
	const set = ( name, value ) => change( name, name === 'split' ? Math.min( 1, Math.max( 0, value ) ) : bounded( name, value ) );
	const zoom = ( by ) => set( 'camera_distance', scene.camera_distance * by );
	const reset = () => PARAMETERS.filter( ( { name } ) => name.startsWith( 'camera' ) ).forEach( ( { name, value } ) => change( name, value ) );
	const root = svg( 'svg', {
		viewBox: '-1 -1 2 2', tabindex: 0, role: 'application',
		'aria-label': 'Camera: arrow keys orbit, + and - zoom, [ and ] move the border, Home resets',
		ondblclick: reset,
		onkeydown( event ) {
			const [ name, step ] = KEYS[ event.key ] || [];
			if ( ! name && event.key !== 'Home' ) return;
			event.preventDefault();
			if ( name ) set( name, scene[ name ] + step );
			else reset();
		},
		onwheel( event ) {
			event.preventDefault();
			// A pinch on a touchpad arrives as a wheel with Ctrl. Some mice count lines.
			zoom( Math.exp( event.deltaY * ( event.ctrlKey ? 0.01 : event.deltaMode ? 0.03 : 0.001 ) ) );
		},
		onpointermove( event ) {
			const { left, top, width, height } = root.getBoundingClientRect();
			point( [ ( event.clientX - left ) / width, ( event.clientY - top ) / height ] );
		},
		onpointerleave: () => point( null ),
	}, shapes, arm, turn, stretch, border, grip );
	drag( root, ( x, y ) => {
		set( 'camera_azimuth', scene.camera_azimuth - 2 * x );
		set( 'camera_elevation', scene.camera_elevation - 2 * y );
	}, zoom );
	drag( grip, ( x ) => set( 'split', scene.split + x / 2 ) );

	/** Changes numbers of a light. */
	function turnTo( light, values ) {
		for ( const [ name, value ] of Object.entries( values ) ) light[ name ] = Number( bounded( name, value ).toFixed( 3 ) );
		change( 'lights', scene.lights );
	}

	/** The vector in the scene for a movement in the picture at a light. */
	const way = ( light, x, y ) => {
		const from = camera( scene );
		return moved( from, projected( from, placed( light ).centre )?.distance || 0, x, y );
	};
	const tip = ( light ) => {
		const { centre, normal } = placed( light );
		return projected( camera( scene ), plus( centre, scaled( normal, REACH ) ) );
	};
	drag( turn, ( x, y ) => {
		// The angles that move the tip of the handle by (x, y), from how the tip follows a small turn.
		const light = scene.lights[ lights.chosen() ];
		const [ from, step ] = [ tip( light ), 1e-3 ];
		const [ a, b ] = [ 'yaw', 'pitch' ].map( ( name ) => tip( { ...light, [ name ]: light[ name ] + step } ) );
		if ( ! from || ! a || ! b ) return;
		const [ ax, ay, bx, by ] = [ a.x - from.x, a.y - from.y, b.x - from.x, b.y - from.y ].map( ( part ) => part / step );
		// Damped least squares, because a tip that points at the camera hardly moves.
		const [ aa, bb, ab, ad, bd ] = [ ax * ax + ay * ay + DAMPING, bx * bx + by * by + DAMPING, ax * bx + ay * by, ax * x + ay * y, bx * x + by * y ];
		const determinant = aa * bb - ab * ab;
		turnTo( light, { yaw: light.yaw + ( ad * bb - bd * ab ) / determinant, pitch: light.pitch + ( bd * aa - ad * ab ) / determinant } );
	} );
	drag( stretch, ( x, y ) => {
		const light = scene.lights[ lights.chosen() ];
		const { along, across } = placed( light );
		const by = way( light, x, y );
		turnTo( light, { width: light.width + dot( by, unit( along, [ 0, 0, 0 ] ) ), height: light.height + dot( by, unit( across, [ 0, 0, 0 ] ) ) } );
	} );

	function added( i ) {
		const polygon = shapes.appendChild( svg( 'polygon' ) );
		drag( polygon, ( x, y, isNear ) => {
			const light = scene.lights[ i ];
			lights.take( i );
			const by = isNear ? scaled( camera( scene ).forward, 2 * y ) : way( light, x, y );
			turnTo( light, { x: light.x + by[ 0 ], y: light.y + by[ 1 ], z: light.z + by[ 2 ] } );
		} );
	}

	/** Moves a mark to a point of the scene, or hides it. */
	function put( mark, point ) {
		mark.setAttribute( 'visibility', point ? 'visible' : 'hidden' );
		if ( ! point ) return;
		mark.setAttribute( 'cx', point.x );
		mark.setAttribute( 'cy', - point.y );
	}

	function draw() {
		const from = camera( scene );
		while ( shapes.children.length > scene.lights.length ) shapes.lastChild.remove();
		while ( shapes.children.length < scene.lights.length ) added( shapes.children.length );
		[ ...shapes.children ].forEach( ( polygon, i ) => {
			const points = outline( scene.lights[ i ], from.eye ).map( ( corner ) => projected( from, corner ) );
			polygon.setAttribute( 'points', points.every( Boolean ) ? points.map( ( { x, y } ) => `${ x },${ - y }` ).join( ' ' ) : '' );
			polygon.classList.toggle( 'other', i !== lights.chosen() );
		} );
		const light = scene.lights[ lights.chosen() ];
		const { centre, at, ends } = placed( light );
		const [ middle, end ] = [ projected( from, centre ), light.shape === 'sphere' ? null : tip( light ) ];
		put( turn, end );
		put( stretch, projected( from, light.shape === 'tube' || light.shape === 'line' || light.shape === 'sphere' ? ends[ 1 ] : at( [ 1, 1 ] ) ) );
		const ofBorder = scene.show === 'split' ? { x1: 2 * scene.split - 1, x2: 2 * scene.split - 1, y1: - 1, y2: 1 } : { x1: 2, x2: 2, y1: 0, y2: 0 };
		const ofArm = middle && end ? { x1: middle.x, y1: - middle.y, x2: end.x, y2: - end.y } : { x1: 2, x2: 2, y1: 0, y2: 0 };
		for ( const [ line, places ] of [ [ border, ofBorder ], [ grip, ofBorder ], [ arm, ofArm ] ] ) for ( const [ name, value ] of Object.entries( places ) ) line.setAttribute( name, value );
	}
	return { root, draw };
}
