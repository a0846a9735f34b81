// Pictures on lights: a built-in picture, a built-in video, or a file of the user. Files stay in the browser.

import { el, fileField, fill, notice } from '../elements/dom.js';
import { choice } from './controls.js';
import { isPictured, PICTURES } from './scene.js';

/** Texels of the longer side of a picture on a light. */
const LONGER = 256;

/** Draws coloured bars, white squares that halve in size, and black stripes. */
function drawSigns( to, width, height ) {
	[ '#101820', '#ff5030', '#ffd040', '#20c060', '#3080ff', '#f0f0f0' ].forEach( ( colour, i ) => {
		to.fillStyle = colour;
		to.fillRect( Math.round( i * width / 6 ), 0, Math.ceil( width / 6 ), height );
	} );
	to.fillStyle = '#ffffff';
	for ( let [ x, side ] = [ 0.04, 0.36 ]; side > 0.02; side /= 2 ) {
		to.fillRect( x * width, 0.12 * height, side * width, side * height );
		x += 1.35 * side;
	}
	to.fillStyle = '#000000';
	for ( let i = 0; i < 24; i += 2 ) to.fillRect( Math.round( i * width / 24 ), Math.round( 0.8 * height ), Math.round( width / 24 ), Math.ceil( 0.2 * height ) );
}

/** Draws a disc that moves over a grid. Its position depends only on the time. */
function drawDisc( to, width, height, seconds ) {
	to.fillStyle = '#0c2440';
	to.fillRect( 0, 0, width, height );
	to.fillStyle = '#2f6f9f';
	for ( let i = 1; i < 8; i ++ ) to.fillRect( Math.round( i * width / 8 ), 0, 2, height );
	for ( let i = 1; i < 5; i ++ ) to.fillRect( 0, Math.round( i * height / 5 ), width, 2 );
	to.fillStyle = '#ffd9a0';
	to.beginPath();
	to.arc( width * ( 0.5 + 0.4 * Math.sin( 1.3 * seconds ) ), height * ( 0.5 + 0.3 * Math.cos( 2.1 * seconds ) ), height / 5, 0, 2 * Math.PI );
	to.fill();
}

/** Reads an image or a video from a file. */
async function read( file ) {
	const address = URL.createObjectURL( file );
	const isVideo = file.type.startsWith( 'video/' );
	const shown = isVideo ? Object.assign( document.createElement( 'video' ), { loop: true, muted: true, playsInline: true } ) : new Image();
	shown.src = address;
	try {
		await ( isVideo ? new Promise( ( done, failed ) => Object.assign( shown, { onloadeddata: done, onerror: failed } ) ) : shown.decode() );
	} catch {
		URL.revokeObjectURL( address );
		throw new Error( `${ file.name }: this browser cannot show the file; open another image or video` );
	}
	return { name: file.name, shown, isVideo, release() {
		shown.removeAttribute( 'src' );
		URL.revokeObjectURL( address );
	} };
}

/**
 * The inputs for pictures on lights, and the pixels of the pictures. `change` is called with the picture's name for the selected
 * light. `again` is called when the user starts or pauses the video.
 */
export function screens( change, again ) {
	let opened = null;
	let chosen = null;
	let isPlaying = ! matchMedia( '(prefers-reduced-motion: reduce)' ).matches;
	/** The position in the built-in video in seconds, and the time of the last update. */
	let [ seconds, since ] = [ 0, null ];
	const shows = choice( 'view-light_picture', 'Image', [], '', change );
	const play = el( 'button', { type: 'button', class: 'quiet', onclick: () => {
		isPlaying = ! isPlaying;
		since = null;
		updatePlayback();
		again();
	} } );
	const message = el( 'div', { role: 'status' } );
	const small = el( 'canvas', { class: 'screen', role: 'img', 'aria-label': 'The picture on the light' } );
	const openRow = el( 'div', { class: 'field' }, el( 'label', { for: 'picture' }, 'Picture or video' ), el( 'div', { class: 'file' }, fileField( 'picture', 'image/*,video/*', 'Open a file', open ), play, small ) );
	const isMoving = ( { picture } ) => picture === 'disc' || picture === 'file' && opened.isVideo;

	/** Makes the button and an opened video match `isPlaying`. */
	function updatePlayback() {
		play.textContent = isPlaying ? 'Pause' : 'Play';
		if ( opened?.isVideo ) isPlaying ? opened.shown.play() : opened.shown.pause();
	}

	async function open( file ) {
		try {
			const next = await read( file );
			opened?.release();
			opened = next;
			fill( message );
			updatePlayback();
			change( 'file' );
		} catch ( error ) {
			fill( message, notice( error.message ) );
		}
	}

	function paint( canvas, { picture } ) {
		const to = canvas.getContext( '2d', { willReadFrequently: true } );
		const { width, height } = canvas;
		if ( picture === 'signs' ) return drawSigns( to, width, height );
		if ( picture === 'disc' ) return drawDisc( to, width, height, seconds );
		to.fillStyle = '#000000';
		to.fillRect( 0, 0, width, height );
		to.imageSmoothingQuality = 'high';
		to.drawImage( opened.shown, 0, 0, width, height );
	}
	const canvases = [];
	updatePlayback();
	return {
		row: [ shows.row, openRow, message ],
		/** Shows the inputs for a light. They are hidden unless it is a rectangle. */
		show( light ) {
			chosen = light;
			shows.offer( [ ...Object.entries( PICTURES ), ...( opened ? [ [ 'file', opened.name ] ] : [] ) ], light.picture );
			shows.row.hidden = openRow.hidden = light.shape !== 'rectangle';
			small.hidden = ! isPictured( light );
			play.hidden = small.hidden || ! isMoving( light );
		},
		/**
		 * The pixels of all pictures, in the order of their lights, and whether any of them moves. All pictures have the same size. Their
		 * pixels are square on the first of these lights.
		 */
		layers( lights ) {
			const pictured = lights.filter( isPictured );
			if ( ! pictured.length ) return { layers: [], isMoving: false };
			const now = performance.now() / 1000;
			if ( isPlaying ) seconds += now - ( since ?? now );
			since = now;
			const [ { width: half, height: other } ] = pictured;
			const [ width, height ] = [ half, other ].map( ( side ) => Math.max( 1, Math.round( LONGER * side / Math.max( half, other ) ) ) );
			const layers = pictured.map( ( light, i ) => {
				const canvas = canvases[ i ] ??= document.createElement( 'canvas' );
				// Setting the size of a canvas clears it, which takes time.
				if ( canvas.width !== width || canvas.height !== height ) Object.assign( canvas, { width, height } );
				paint( canvas, light );
				if ( light === chosen ) Object.assign( small, { width, height } ).getContext( '2d' ).drawImage( canvas, 0, 0 );
				return canvas;
			} );
			return { layers, isMoving: isPlaying && pictured.some( isMoving ) };
		},
		release: () => opened?.release(),
	};
}
