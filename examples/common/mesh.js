// The triangles of a surface or a light of the scene, in world space.

import { axesOf } from './scene.js';

/** The number of sectors of a ring. */
const SECTORS = 512;

/**
 * @param {Object} surface - Has `size` or `radii`, see scene.js.
 * @returns {{ positions: number[], normals: number[], tangents: number[], uvs: number[], indices: number[] }} Triangles run
 * counterclockwise as seen from the front. Tangents have four numbers. They run along `right`, and on a ring along the radius.
 */
export function meshOf( surface ) {

	const axes = axesOf( surface );
	const inWorld = ( x, y ) => [ 0, 1, 2 ].map( ( i ) => x * axes[ 0 ][ i ] + y * axes[ 1 ][ i ] );
	const mesh = { positions: [], normals: [], tangents: [], uvs: [], indices: [] };
	const vertex = ( x, y, tangent ) => {

		mesh.positions.push( ...inWorld( x, y ).map( ( value, i ) => value + surface.centre[ i ] ) );
		mesh.normals.push( ...axes[ 2 ] );
		mesh.tangents.push( ...inWorld( ...tangent ), 1 );
		mesh.uvs.push( x, y );

	};

	if ( surface.radii ) {

		for ( let i = 0; i <= SECTORS; i ++ ) {

			const along = [ Math.cos( 2 * Math.PI * i / SECTORS ), Math.sin( 2 * Math.PI * i / SECTORS ) ];
			for ( const radius of surface.radii ) vertex( radius * along[ 0 ], radius * along[ 1 ], along );
			if ( i < SECTORS ) mesh.indices.push( ...[ 0, 1, 3, 0, 3, 2 ].map( ( corner ) => 2 * i + corner ) );

		}

	} else {

		const [ x, y ] = surface.size.map( ( side ) => side / 2 );
		for ( const corner of [ [ - x, - y ], [ x, - y ], [ x, y ], [ - x, y ] ] ) vertex( ...corner, [ 1, 0 ] );
		mesh.indices.push( 0, 1, 2, 0, 2, 3 );

	}

	return mesh;

}

/** The visible rectangle of a light. */
export const glowOf = ( lamp ) => meshOf( { ...lamp, size: [ lamp.width, lamp.height ] } );
