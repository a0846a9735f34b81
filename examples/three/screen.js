// The contents of the example's light: a picture, and a video that is drawn while it plays.

/** The size in texels, which are square on the scene's first light of 2.4 x 1. */
export const width = 192;
export const height = 80;

/**
 * Draws the contents.
 *
 * @param {CanvasRenderingContext2D} to - The context of a canvas of this size.
 * @param {'picture' | 'video' | 'colour'} what - Coloured bars with a sign, the same with a moving disc, or grey.
 * @param {number} seconds - The time of the video.
 */
export function drawScreen( to, what, seconds ) {

	to.fillStyle = '#bcbcbc';
	to.fillRect( 0, 0, width, height );
	if ( what === 'colour' ) return;

	[ '#101820', '#ff5030', '#ffd040', '#20c060', '#3080ff', '#f0f0f0' ].forEach( ( colour, i ) => {

		to.fillStyle = colour;
		to.fillRect( i * width / 6, 0, width / 6, height * ( i % 2 ? 1 : 0.7 ) );

	} );
	if ( what !== 'video' ) return;

	to.fillStyle = '#ffffff';
	to.beginPath();
	to.arc( width * ( 0.5 + 0.42 * Math.sin( 1.3 * seconds ) ), height * ( 0.5 + 0.3 * Math.cos( 2.1 * seconds ) ), height / 5, 0, 2 * Math.PI );
	to.fill();

}
