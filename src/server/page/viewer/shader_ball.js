// The shader ball: a sphere with a groove around a tilted axis, on a foot with a ring. It fits into the unit sphere.
//
// Each part is a surface of revolution with exact normals. Tangents run along its circles.

/** The ball: height of its centre, radius, and tilt of its axis towards the viewer. The groove: angle from the axis, half width, and relative depth. */
const [ MIDDLE, RADIUS, TILT ] = [ 0.29, 0.69, 0.6 ];
const GROOVE = { angle: 1.05, width: 0.16, depth: 0.13 };

/** The foot: radius and height of the neck inside the ball, radius and height of the plate, and radius of the rounded rim. */
const FOOT = { neck: 0.13, top: - 0.3, plate: 0.42, bottom: - 0.84, rim: 0.03 };

/** The ring around the neck: its radius, thickness and height. */
const RING = { radius: 0.27, thick: 0.055, height: - 0.52 };

/**
 * The parts. The parameter of a profile runs from 0 to 1. A profile returns the distance r from the axis, the height y, and their
 * derivatives dr and dy. Profiles run down the outside, so (-dy, dr) points outwards.
 */
const PARTS = [
	{ rows: 160, columns: 192, tilt: TILT, up: MIDDLE, profile( s ) {
		const t = Math.PI * s;
		const across = ( t - GROOVE.angle ) / GROOVE.width;
		const inside = Math.max( 1 - across * across, 0 );
		// A polynomial with a continuous slope gives a groove without an edge.
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

/** A part whose profile is an arc around a point. Angles are in half turns, measured downwards from the horizontal. */
function arc( middle, height, radius, from, to, rows ) {
	return { rows, columns: 96, profile( s ) {
		const angle = Math.PI * ( from + ( to - from ) * s );
		const [ cosine, sine ] = [ radius * Math.cos( angle ), radius * Math.sin( angle ) ];
		return [ middle + cosine, height - sine, - sine, - cosine ];
	} };
}

/** Appends the triangles of a part: position, normal, and tangent with its sign, as for meshes from files. */
function append( numbers, { rows, columns, profile, tilt = 0, up = 0 } ) {
	const [ c, s ] = [ Math.cos( tilt ), Math.sin( tilt ) ];
	const turned = ( [ x, y, z ] ) => [ x, c * y - s * z, s * y + c * z ];
	const corner = ( row, column ) => {
		const [ r, y, dr, dy ] = profile( row / rows );
		// The last column is exactly equal to the first column.
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

/** The triangles of the shader ball, with ten numbers per corner. They are computed once. */
export function shaderBall() {
	return made ??= new Float32Array( PARTS.reduce( ( numbers, part ) => ( append( numbers, part ), numbers ), [] ) );
}

let made = null;
