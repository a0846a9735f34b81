// The shader ball: a sphere with a groove around a tilted axis, on a foot with a ring, all of radius one around the origin.
//
// Each part is a surface of revolution. Its normals are those of its profile, its tangents run along the circles.

/** The ball: its middle, radius, and the tilt of its axis to the viewer; the angle of its groove from the axis, half width and depth. */
const [ MIDDLE, RADIUS, TILT ] = [ 0.29, 0.69, 0.6 ];
const GROOVE = { angle: 1.05, width: 0.16, depth: 0.13 };
/** The foot: radius and height of its neck in the ball, those of its plate, and what the rim rounds. */
const FOOT = { neck: 0.13, top: - 0.3, plate: 0.42, bottom: - 0.84, rim: 0.03 };
/** The ring around the neck: its radius, thickness and height. */
const RING = { radius: 0.27, thick: 0.055, height: - 0.52 };

/**
 * Profiles by a parameter from 0 to 1: distance from the axis and height, and the derivatives of both. Each runs down its
 * outside, so that (- dy, dr) is the way out.
 */
const PARTS = [
	{ rows: 160, columns: 192, tilt: TILT, up: MIDDLE, profile( s ) {

		const t = Math.PI * s;
		const across = ( t - GROOVE.angle ) / GROOVE.width;
		const inside = Math.max( 1 - across * across, 0 );
		// A polynomial with a continuous slope, so that the groove has no edge.
		const radius = RADIUS * ( 1 - GROOVE.depth * inside * inside );
		const slope = 4 * RADIUS * GROOVE.depth * inside * across / GROOVE.width;
		return [ radius * Math.sin( t ), radius * Math.cos( t ), slope * Math.sin( t ) + radius * Math.cos( t ), slope * Math.cos( t ) - radius * Math.sin( t ) ];

	} },
	{ rows: 32, columns: 96, profile( s ) {

		const height = FOOT.bottom - FOOT.top;
		return [ FOOT.neck + ( FOOT.plate - FOOT.neck ) * s ** 4, FOOT.top + height * s, 4 * ( FOOT.plate - FOOT.neck ) * s ** 3, height ];

	} },
	arc( FOOT.plate, FOOT.bottom - FOOT.rim, FOOT.rim, - 0.5, 0.5, 8 ),
	{ rows: 1, columns: 96, profile: ( s ) => [ FOOT.plate * ( 1 - s ), FOOT.bottom - 2 * FOOT.rim, - 1, 0 ] },
	arc( RING.radius, RING.height, RING.thick, - 1, 1, 32 ),
];

/** A part whose profile is an arc around a point, between angles in half turns, downwards from the outside. */
function arc( middle, height, radius, from, to, rows ) {

	return { rows, columns: 96, profile( s ) {

		const angle = Math.PI * ( from + ( to - from ) * s );
		const [ cosine, sine ] = [ radius * Math.cos( angle ), radius * Math.sin( angle ) ];
		return [ middle + cosine, height - sine, - sine, - cosine ];

	} };

}

/** Appends the triangles of a part: place, normal and tangent with its side, as meshes of files have them. */
function append( numbers, { rows, columns, profile, tilt = 0, up = 0 } ) {

	const [ c, s ] = [ Math.cos( tilt ), Math.sin( tilt ) ];
	const turned = ( [ x, y, z ] ) => [ x, c * y - s * z, s * y + c * z ];
	const corner = ( row, column ) => {

		const [ r, y, dr, dy ] = profile( row / rows );
		// The last column is the first one to the last bit.
		const angle = 2 * Math.PI * ( column % columns ) / columns;
		const [ sine, cosine, length ] = [ Math.sin( angle ), Math.cos( angle ), Math.hypot( dr, dy ) ];
		const place = turned( [ r * sine, y, r * cosine ] );
		return [ place[ 0 ], place[ 1 ] + up, place[ 2 ], ...turned( [ - dy / length * sine, dr / length, - dy / length * cosine ] ), ...turned( [ cosine, 0, - sine ] ), 1 ];

	};

	for ( let row = 0; row < rows; row ++ ) for ( let column = 0; column < columns; column ++ ) {

		const [ a, b, d, e ] = [ corner( row, column ), corner( row, column + 1 ), corner( row + 1, column ), corner( row + 1, column + 1 ) ];
		numbers.push( ...a, ...d, ...b, ...b, ...d, ...e );

	}

}

/** The triangles of the shader ball, ten numbers a corner, made once. */
export function shaderBall() {

	return made ??= new Float32Array( PARTS.reduce( ( numbers, part ) => ( append( numbers, part ), numbers ), [] ) );

}

let made = null;
