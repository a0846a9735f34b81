// The area lights of a dropped scene, which its plan lists, as lights of the viewer.

import { cross, dot, LIGHT_SHAPES, MOST_LIGHTS, OF_LIGHT, plus, scaled, unit } from './scene.js';

/** The light at the middle of the scene, to which all lights are scaled together. */
const BRIGHTNESS = 3;

/** The largest relative difference of areas, of sides and of corners that are equal except for rounding. */
const EQUAL = 1e-3;

const minus = ( a, b ) => plus( a, scaled( b, - 1 ) );

const luminance = ( [ r, g, b ] ) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/** Twice the signed area of the triangle of three points in a plane. */
const turn = ( a, b, c ) => ( b[ 0 ] - a[ 0 ] ) * ( c[ 1 ] - a[ 1 ] ) - ( b[ 1 ] - a[ 1 ] ) * ( c[ 0 ] - a[ 0 ] );

/** The area of a polygon. */
const areaOf = ( points ) => points.reduce( ( sum, point, i ) => sum + Math.abs( i > 1 ? turn( points[ 0 ], points[ i - 1 ], point ) : 0 ) / 2, 0 );

/** The convex hull of points in a plane, clockwise, without points on its sides [Andrew 1979]. */
function hullOf( points ) {
	const sorted = points.toSorted( ( a, b ) => a[ 0 ] - b[ 0 ] || a[ 1 ] - b[ 1 ] );
	const least = EQUAL * Math.max( ...[ 0, 1 ].map( ( axis ) => Math.max( ...points.map( ( point ) => point[ axis ] ) ) - Math.min( ...points.map( ( point ) => point[ axis ] ) ) ) ) ** 2;
	const half = ( chain, point ) => {
		while ( chain.length > 1 && turn( chain.at( - 2 ), chain.at( - 1 ), point ) > - least ) chain.pop();
		return [ ...chain, point ];
	};
	return [ sorted, sorted.toReversed() ].flatMap( ( order ) => order.reduce( half, [] ).slice( 0, - 1 ) );
}

/** A flat light: name, radiance, unit normal of its front, an axis in its plane, and its corners or half axes. */
function flat( { name, shape, two_sided: isBoth, points, radiance } ) {
	const [ a, b, c ] = points;
	const isDisk = shape === 'disk';
	const normal = unit( isDisk ? cross( b, c ) : cross( minus( c, a ), minus( b, a ) ), [ 0, 0, 1 ] );
	return { name, isBoth, radiance, normal, points, isDisk, axis: unit( isDisk ? b : minus( b, a ), [ 1, 0, 0 ] ), level: dot( normal, a ) };
}

/** The lights with the triangles of each convex emitter as one polygon, if it has at most eight corners. */
function merged( lights ) {
	const groups = new Map();
	for ( const [ i, light ] of lights.entries() ) {
		const { name, normal, level, isDisk } = light;
		const key = isDisk ? i : JSON.stringify( [ name, ...[ ...normal, level ].map( ( number ) => Math.round( 500 * number ) ) ] );
		groups.set( key, [ ...( groups.get( key ) ?? [] ), light ] );
	}
	return [ ...groups.values() ].flatMap( ( group ) => {
		const [ first ] = group;
		if ( group.length < 2 ) return group;
		const across = cross( first.normal, first.axis );
		const inPlane = ( point ) => [ dot( point, first.axis ), dot( point, across ) ];
		const hull = hullOf( group.flatMap( ( { points } ) => points.map( inPlane ) ) );
		const whole = group.reduce( ( sum, { points } ) => sum + areaOf( points.map( inPlane ) ), 0 );
		if ( hull.length > 8 || Math.abs( areaOf( hull ) / whole - 1 ) > EQUAL ) return group;
		const points = hull.map( ( [ x, y ] ) => plus( scaled( first.axis, x ), scaled( across, y ), scaled( first.normal, first.level ) ) );
		return [ { ...first, points, axis: unit( minus( points[ 1 ], points[ 0 ] ), first.axis ) } ];
	} );
}

/** The light of the viewer for a flat light. Its angles are those of `placed` in `scene.js`. */
function turned( { isBoth, radiance, normal, points, isDisk, axis } ) {
	const across = cross( normal, axis );
	const [ us, vs ] = isDisk ? [ [], [] ] : [ axis, across ].map( ( along ) => points.map( ( point ) => dot( point, along ) ) );
	const [ width, height ] = isDisk ? points.slice( 1 ).map( ( half ) => Math.hypot( ...half ) ) : [ us, vs ].map( ( values ) => ( Math.max( ...values ) - Math.min( ...values ) ) / 2 );
	const [ u, v ] = [ us, vs ].map( ( values ) => ( Math.max( ...values ) + Math.min( ...values ) ) / 2 );
	const centre = isDisk ? points[ 0 ] : plus( scaled( axis, u ), scaled( across, v ), scaled( normal, dot( normal, points[ 0 ] ) ) );
	const outline = us.map( ( at, i ) => [ ( at - u ) / width, ( vs[ i ] - v ) / height ] );
	const isRectangle = outline.length === 4 && outline.flat().every( ( at ) => Math.abs( Math.abs( at ) - 1 ) < EQUAL );
	const facing = unit( scaled( centre, - 1 ), [ 0, 0, 1 ] );
	const right = unit( cross( [ 0, 1, 0 ], facing ), [ 1, 0, 0 ] );
	const own = ( vector ) => [ right, cross( facing, right ), facing ].map( ( side ) => dot( vector, side ) );
	const [ n, a ] = [ own( normal ), own( axis ) ];
	const [ yaw, pitch ] = [ Math.atan2( n[ 0 ], n[ 2 ] ), Math.asin( Math.max( - 1, Math.min( 1, - n[ 1 ] ) ) ) ];
	const roll = Math.atan2( dot( a, [ Math.sin( yaw ) * Math.sin( pitch ), Math.cos( pitch ), Math.cos( yaw ) * Math.sin( pitch ) ] ), Math.cos( yaw ) * a[ 0 ] - Math.sin( yaw ) * a[ 2 ] );
	const brightest = Math.max( ...radiance );
	const byte = ( y ) => Math.round( 255 * ( y <= 0.0031308 ? 12.92 * y : 1.055 * y ** ( 1 / 2.4 ) - 0.055 ) ).toString( 16 ).padStart( 2, '0' );
	const numbers = { x: centre[ 0 ], y: centre[ 1 ], z: centre[ 2 ], width, height, yaw, pitch, roll, intensity: brightest };
	const cosine = Math.max( isBoth ? Math.abs( n[ 2 ] ) : n[ 2 ], EQUAL );
	const area = isDisk ? Math.PI * width * height : areaOf( us.map( ( at, i ) => [ at, vs[ i ] ] ) );
	return {
		shape: isDisk ? 'disk' : isRectangle ? 'rectangle' : 'polygon',
		picture: '', colour: `#${ radiance.map( ( channel ) => byte( channel / brightest ) ).join( '' ) }`, sides: isBoth ? 'both' : '',
		outline: isDisk || isRectangle ? '' : outline.flat().map( ( at ) => at.toFixed( 4 ) ).join( ' ' ),
		...numbers, reaches: luminance( radiance ) * area * cosine / Math.max( dot( centre, centre ), area ),
	};
}

/**
 * The strongest lights of a scene as lights of the viewer, and the number of all. `place` is the middle and the radius of
 * the scene, which the viewer moves into the unit sphere. The brightness of all lights changes by one factor.
 */
export function ownLights( found, { middle, radius } ) {
	const moved = ( { shape, points, ...light } ) => ( { ...light, shape, points: points.map( ( point, i ) => scaled( shape === 'disk' && i ? point : minus( point, middle ), 1 / radius ) ) } );
	const all = merged( found.filter( ( { shape } ) => Object.hasOwn( LIGHT_SHAPES, shape ) ).map( moved ).map( flat ) ).map( turned );
	const lights = all.toSorted( ( a, b ) => b.reaches - a.reaches ).slice( 0, MOST_LIGHTS );
	const factor = BRIGHTNESS / lights.reduce( ( sum, { reaches } ) => sum + reaches, 0 );
	const rounded = ( light ) => Object.fromEntries( OF_LIGHT.map( ( { name } ) => [ name, Number( ( ( name === 'intensity' ? factor : 1 ) * light[ name ] ).toFixed( 5 ) ) ] ) );
	return { lights: lights.map( ( { reaches, ...light } ) => ( { ...light, ...rounded( light ) } ) ), count: all.length };
}
