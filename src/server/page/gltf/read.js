// Triangles and materials of a glTF 2.0 file that was dropped on the page. Nothing beside the file itself is read.
//
// Invariant: a file that is broken or too large gives an error that names every fault found, within bounded time and memory.

import { textureReader } from './textures.js';

/** Bytes of a file, triangles of all instances, nodes of a scene, and nodes below each other. */
const [ MOST_BYTES, MOST_TRIANGLES, MOST_NODES, MOST_DEPTH ] = [ 2 ** 26, 2 ** 18, 2 ** 16, 64 ];

const COMPONENTS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
/** Extensions that change nothing of the triangles, or that are read. */
const KNOWN = /^KHR_(materials_.*|texture_.*|mesh_quantization|lights_punctual)$/;

const list = ( value ) => Array.isArray( value ) ? value : [];
const numberOf = ( value, otherwise ) => Number.isFinite( value ) ? value : otherwise;

/** The JSON of a file and its binary chunk. */
function parts( buffer ) {

	if ( buffer.byteLength > MOST_BYTES ) throw new Error( `the file has ${ buffer.byteLength } bytes; at most ${ MOST_BYTES } are read` );
	const view = new DataView( buffer );
	if ( buffer.byteLength < 20 || view.getUint32( 0, true ) !== 0x46546c67 ) return { document: parsed( new Uint8Array( buffer ) ), binary: null };
	const version = view.getUint32( 4, true );
	if ( version !== 2 ) throw new Error( `the GLB is of version ${ version }; version 2 is read` );
	let [ document, binary ] = [ null, null ];
	for ( let at = 12; at + 8 <= buffer.byteLength; ) {

		const [ length, type ] = [ view.getUint32( at, true ), view.getUint32( at + 4, true ) ];
		if ( at + 8 + length > buffer.byteLength ) throw new Error( `the chunk at byte ${ at } has ${ length } bytes, and the file ends after ${ buffer.byteLength - at - 8 }` );
		const chunk = buffer.slice( at + 8, at + 8 + length );
		if ( type === 0x4e4f534a ) document ??= parsed( new Uint8Array( chunk ) );
		if ( type === 0x004e4942 ) binary ??= chunk;
		at += 8 + length;

	}

	if ( ! document ) throw new Error( 'the GLB has no JSON' );
	return { document, binary };

}

function parsed( bytes ) {

	let document = null;
	try {

		document = JSON.parse( new TextDecoder().decode( bytes ) );

	} catch {

		throw new Error( 'this is neither a GLB nor the JSON of a glTF file' );

	}

	if ( ! /^2\./.test( document?.asset?.version ) ) throw new Error( `asset.version is ${ JSON.stringify( document?.asset?.version ) }; 2.0 is read` );
	const needed = list( document.extensionsRequired ).filter( ( name ) => ! KNOWN.test( name ) );
	if ( needed.length ) throw new Error( `the file needs ${ needed.join( ', ' ) }, which is not read here` );
	return document;

}

/** The bytes of a buffer: those in the file itself. */
function bufferOf( document, index, binary ) {

	const { uri } = document.buffers?.[ index ] || {};
	if ( uri === undefined && index === 0 && binary ) return binary;
	const [ , data ] = /^data:[^,]*;base64,(.*)$/s.exec( uri || '' ) || [];
	if ( data === undefined ) throw new Error( `buffers/${ index } is ${ uri === undefined ? 'not in the file' : `the file «${ String( uri ).slice( 0, 60 ) }» beside it` }; save it as one GLB` );
	try {

		return Uint8Array.from( atob( data ), ( byte ) => byte.charCodeAt( 0 ) ).buffer;

	} catch {

		throw new Error( `buffers/${ index }/uri is no base64` );

	}

}

/** What finds the bytes of buffers, each decoded once. */
function bufferReader( document, binary ) {

	const known = new Map();
	return ( index ) => {

		if ( ! known.has( index ) ) known.set( index, bufferOf( document, index, binary ) );
		return known.get( index );

	};

}

/** What reads accessors: each as numbers one behind the other, whole ones of normalized types from -1 to 1. */
function reader( document, bufferOf ) {

	const known = new Map();
	return ( index, type, what ) => {

		// Instances read the same numbers again.
		if ( known.has( `${ index } ${ type }` ) ) return known.get( `${ index } ${ type }` );
		const at = `${ what }: accessors/${ index }`;
		const accessor = document.accessors?.[ index ];
		if ( ! accessor ) throw new Error( `${ at } is not there` );
		if ( accessor.sparse ) throw new Error( `${ at } is sparse, which is not read here` );
		if ( accessor.type !== type ) throw new Error( `${ at } is ${ accessor.type }, not ${ type }` );
		const [ Of, view ] = [ COMPONENTS[ accessor.componentType ], document.bufferViews?.[ accessor.bufferView ] ];
		if ( ! Of || ! view ) throw new Error( `${ at } has ${ Of ? 'no buffer view' : `the component type ${ accessor.componentType }` }` );
		const buffer = bufferOf( view.buffer );
		const width = WIDTHS[ type ];
		const { count } = accessor;
		const stride = view.byteStride || width * Of.BYTES_PER_ELEMENT;
		const start = ( view.byteOffset || 0 ) + ( accessor.byteOffset || 0 );
		if ( ! ( Number.isInteger( count ) && count > 0 && Number.isInteger( start ) && start >= 0 && Number.isInteger( stride ) && stride > 0 ) || start + stride * ( count - 1 ) + width * Of.BYTES_PER_ELEMENT > buffer.byteLength ) throw new Error( `${ at } has ${ count } elements from byte ${ start }, and its buffer ends at byte ${ buffer.byteLength }` );
		const read = new DataView( buffer );
		const method = `get${ Of.name.replace( 'Array', '' ) }`;
		const scale = accessor.normalized && Of !== Float32Array ? 1 / ( 2 ** ( 8 * Of.BYTES_PER_ELEMENT - ( Of.name.startsWith( 'Int' ) ? 1 : 0 ) ) - 1 ) : 1;
		const numbers = new ( type === 'SCALAR' ? Uint32Array : Float32Array )( width * count );
		for ( let i = 0; i < count; i ++ ) for ( let c = 0; c < width; c ++ ) numbers[ width * i + c ] = scale * read[ method ]( start + stride * i + Of.BYTES_PER_ELEMENT * c, true );
		known.set( `${ index } ${ type }`, numbers );
		return numbers;

	};

}

/** What GGX needs of a material: its roughnesses, the turn of its tangent, the reflectance at normal incidence; and what textures multiply of it. */
export function materialOf( { pbrMetallicRoughness: pbr = {}, normalTexture, extensions = {} } = {} ) {

	const alpha = Math.min( 1, Math.max( 0, numberOf( pbr.roughnessFactor, 1 ) ) ) ** 2;
	const { anisotropyStrength, anisotropyRotation } = extensions.KHR_materials_anisotropy || {};
	const strength = Math.min( 1, Math.max( 0, numberOf( anisotropyStrength, 0 ) ) );
	const ior = numberOf( extensions.KHR_materials_ior?.ior, 1.5 );
	const dielectric = ( ( ior - 1 ) / ( ior + 1 ) ) ** 2 * numberOf( extensions.KHR_materials_specular?.specularFactor, 1 );
	const metal = Math.min( 1, Math.max( 0, numberOf( pbr.metallicFactor, 1 ) ) );
	const base = [ 0, 1, 2 ].map( ( c ) => numberOf( pbr.baseColorFactor?.[ c ], 1 ) );
	const f0 = base.map( ( colour ) => dielectric + ( colour - dielectric ) * metal );
	// What textures multiply.
	const factors = { base, factors: [ metal, Math.sqrt( alpha ), dielectric, strength * strength ], normal_scale: numberOf( normalTexture?.scale, 1 ) };
	return { factors, alpha_x: alpha + ( 1 - alpha ) * strength * strength, alpha_y: alpha, rotation: numberOf( anisotropyRotation, 0 ), f0 };

}

/** Columns of a node's own matrix. */
function matrixOf( { matrix, translation: t = [ 0, 0, 0 ], rotation: [ x, y, z, w ] = [ 0, 0, 0, 1 ], scale: [ a, b, c ] = [ 1, 1, 1 ] } ) {

	if ( matrix ) return matrix;
	return [
		a * ( 1 - 2 * ( y * y + z * z ) ), a * 2 * ( x * y + z * w ), a * 2 * ( x * z - y * w ), 0,
		b * 2 * ( x * y - z * w ), b * ( 1 - 2 * ( x * x + z * z ) ), b * 2 * ( y * z + x * w ), 0,
		c * 2 * ( x * z + y * w ), c * 2 * ( y * z - x * w ), c * ( 1 - 2 * ( x * x + y * y ) ), 0,
		...t, 1,
	];

}

const product = ( a, b ) => Array.from( { length: 16 }, ( _, i ) => [ 0, 1, 2, 3 ].reduce( ( sum, k ) => sum + a[ 4 * k + i % 4 ] * b[ 4 * Math.floor( i / 4 ) + k ], 0 ) );

/** Every mesh of the scene with its matrix in the world. */
function instances( document ) {

	const nodes = list( document.nodes );
	const children = new Set( nodes.flatMap( ( node ) => list( node?.children ) ) );
	const roots = document.scenes?.[ document.scene ?? 0 ]?.nodes ?? nodes.map( ( _, i ) => i ).filter( ( i ) => ! children.has( i ) );
	const found = [];
	let visited = 0;
	const visit = ( index, above, depth ) => {

		const node = nodes[ index ];
		if ( ! node ) throw new Error( `nodes/${ index } is not there` );
		if ( depth > MOST_DEPTH ) throw new Error( `nodes/${ index } is below ${ depth } others; at most ${ MOST_DEPTH } are read` );
		if ( ++ visited > MOST_NODES ) throw new Error( `the scene has more than ${ MOST_NODES } nodes` );
		const world = product( above, matrixOf( node ) );
		if ( node.mesh !== undefined ) found.push( { mesh: node.mesh, world } );
		for ( const child of list( node.children ) ) visit( child, world, depth + 1 );

	};

	for ( const root of list( roots ) ) visit( root, matrixOf( {} ), 0 );
	return found;

}

/** Corners of triangles, three each, from indices of a mode; null for points and lines. */
function triangles( mode, indices ) {

	if ( mode === 4 ) return indices.subarray( 0, indices.length - indices.length % 3 );
	if ( mode !== 5 && mode !== 6 ) return null;
	return Uint32Array.from( { length: 3 * Math.max( indices.length - 2, 0 ) }, ( _, i ) => {

		const [ triangle, corner ] = [ Math.floor( i / 3 ), i % 3 ];
		if ( mode === 6 ) return indices[ corner ? triangle + corner : 0 ];
		// Every second triangle of a strip runs the other way.
		return indices[ triangle + ( triangle % 2 && corner ? 3 - corner : corner ) ];

	} );

}

/** Appends the triangles of an instance of a primitive, in the world: place, normal and tangent with its side, ten numbers a corner, and its place in textures where they are shown. */
function append( { numbers, uv, textures }, budget, primitive, world, read, what ) {

	const { attributes = {} } = primitive;
	if ( attributes.POSITION === undefined ) throw new Error( `${ what }/attributes/POSITION is missing` );
	const positions = read( attributes.POSITION, 'VEC3', `${ what }/attributes/POSITION` );
	const normals = attributes.NORMAL === undefined ? null : read( attributes.NORMAL, 'VEC3', `${ what }/attributes/NORMAL` );
	const tangents = attributes.TANGENT === undefined ? null : read( attributes.TANGENT, 'VEC4', `${ what }/attributes/TANGENT` );
	const places = textures ? read( attributes.TEXCOORD_0, 'VEC2', `${ what }/attributes/TEXCOORD_0` ) : null;
	const count = positions.length / 3;
	if ( places && places.length !== 2 * count ) throw new Error( `${ what }: ${ places.length / 2 } places in textures of ${ count } corners` );
	const all = primitive.indices === undefined ? Uint32Array.from( { length: count }, ( _, i ) => i ) : read( primitive.indices, 'SCALAR', `${ what }/indices` );
	const corners = triangles( primitive.mode ?? 4, all );
	if ( ! corners ) return 'points and lines are left out';
	const most = corners.reduce( ( most, index ) => Math.max( most, index ), 0 );
	if ( most >= count || normals && normals.length !== positions.length || tangents && 3 * tangents.length !== 4 * positions.length ) throw new Error( `${ what }: index ${ most } of ${ count } places, ${ normals ? normals.length / 3 : 'no' } normals, ${ tangents ? tangents.length / 4 : 'no' } tangents` );
	budget.triangles += corners.length / 3;
	if ( budget.triangles > MOST_TRIANGLES ) throw new Error( `${ what } has triangle ${ budget.triangles }; at most ${ MOST_TRIANGLES } are shown` );
	const m = world;
	const turned = ( [ x, y, z ], w = 0 ) => [ 0, 1, 2 ].map( ( r ) => m[ r ] * x + m[ 4 + r ] * y + m[ 8 + r ] * z + m[ 12 + r ] * w );
	const column = ( c ) => m.slice( 4 * c, 4 * c + 3 );
	const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];
	// Normals turn by the cofactors, which a matrix that mirrors turns over; corners then run the other way.
	const cofactors = [ cross( column( 1 ), column( 2 ) ), cross( column( 2 ), column( 0 ) ), cross( column( 0 ), column( 1 ) ) ];
	const side = Math.sign( cofactors[ 0 ].reduce( ( sum, x, r ) => sum + x * m[ r ], 0 ) ) || 1;
	for ( let i = 0; i < corners.length; i += 3 ) {

		const three = side < 0 ? [ corners[ i ], corners[ i + 2 ], corners[ i + 1 ] ] : [ corners[ i ], corners[ i + 1 ], corners[ i + 2 ] ];
		const at = three.map( ( k ) => turned( positions.subarray( 3 * k, 3 * k + 3 ), 1 ) );
		const flat = cross( at[ 1 ].map( ( x, r ) => x - at[ 0 ][ r ] ), at[ 2 ].map( ( x, r ) => x - at[ 0 ][ r ] ) );
		three.forEach( ( k, corner ) => {

			const normal = normals ? [ 0, 1, 2 ].map( ( r ) => side * cofactors.reduce( ( sum, row, c ) => sum + row[ r ] * normals[ 3 * k + c ], 0 ) ) : flat;
			const tangent = tangents ? [ ...turned( tangents.subarray( 4 * k, 4 * k + 3 ) ), side * tangents[ 4 * k + 3 ] ] : [ 0, 0, 0, 1 ];
			numbers.push( ...at[ corner ], ...normal, ...tangent );
			if ( places ) uv.push( places[ 2 * k ], places[ 2 * k + 1 ] );

		} );

	}

	return tangents ? '' : 'without tangents, anisotropy runs around the vertical';

}

/** Moves and scales all places so that they lie in the sphere of radius one around the origin. */
function fitted( meshes ) {

	const bounds = [ 0, 1, 2 ].map( ( r ) => {

		let [ least, most ] = [ Infinity, - Infinity ];
		for ( const { numbers } of meshes ) for ( let i = r; i < numbers.length; i += 10 ) [ least, most ] = [ Math.min( least, numbers[ i ] ), Math.max( most, numbers[ i ] ) ];
		return [ least, most ];

	} );
	const middle = bounds.map( ( [ least, most ] ) => ( least + most ) / 2 );
	let radius = 0;
	for ( const { numbers } of meshes ) for ( let i = 0; i < numbers.length; i += 10 ) radius = Math.max( radius, Math.hypot( ...middle.map( ( x, r ) => numbers[ i + r ] - x ) ) );
	if ( ! ( radius > 0 && Number.isFinite( radius ) ) ) throw new Error( 'the triangles have no extent' );
	for ( const { numbers } of meshes ) for ( let i = 0; i < numbers.length; i += 10 ) for ( let r = 0; r < 3; r ++ ) numbers[ i + r ] = ( numbers[ i + r ] - middle[ r ] ) / radius;
	return meshes.map( ( mesh ) => ( { ...mesh, numbers: new Float32Array( mesh.numbers ), uv: mesh.textures && new Float32Array( mesh.uv ) } ) );

}

/** The meshes of a file, one a material, in a sphere of radius one, and notes on what was not read. */
export async function readGltf( buffer ) {

	try {

		return await found( buffer );

	} catch ( error ) {

		// A member of another type than glTF has it.
		throw error instanceof TypeError ? new Error( `the glTF is malformed: ${ error.message }` ) : error;

	}

}

async function found( buffer ) {

	const { document, binary } = parts( buffer );
	const bufferOf = bufferReader( document, binary );
	const read = reader( document, bufferOf );
	const byMaterial = new Map();
	const budget = { triangles: 0 };
	const [ faults, notes ] = [ new Set(), new Set() ];
	const texturesOf = textureReader( document, bufferOf, notes );
	for ( const { mesh, world } of instances( document ) ) {

		const { primitives } = document.meshes?.[ mesh ] || {};
		if ( ! primitives ) faults.add( `meshes/${ mesh } is not there` );
		for ( const [ i, primitive ] of list( primitives ).entries() ) {

			const material = document.materials?.[ primitive.material ];
			const hasPlaces = primitive.attributes?.TEXCOORD_0 !== undefined;
			const isTextured = hasPlaces && /"index":/.test( JSON.stringify( material ?? {} ) );
			const key = `${ material ? primitive.material : '' } ${ isTextured }`;
			if ( ! byMaterial.has( key ) ) {

				const [ own, { textures, isBent } ] = [ materialOf( material ), await texturesOf( material ?? {}, hasPlaces ) ];
				if ( ! isBent ) own.factors.normal_scale = 0;
				byMaterial.set( key, { material: own, textures, numbers: [], uv: [] } );

			}

			try {

				notes.add( append( byMaterial.get( key ), budget, primitive, world, read, `meshes/${ mesh }/primitives/${ i }` ) );

			} catch ( error ) {

				faults.add( error.message );

			}

		}

	}

	if ( faults.size ) throw new Error( [ ...faults ].slice( 0, 8 ).join( '; ' ) );
	const meshes = [ ...byMaterial.values() ].filter( ( { numbers } ) => numbers.length );
	if ( ! meshes.length ) throw new Error( 'the file has no triangles' );
	return { meshes: fitted( meshes ), triangles: budget.triangles, notes: [ ...notes ].filter( Boolean ) };

}
