// Reads the triangles and materials of a glTF 2.0 file. Files that the glTF file refers to are not read.
//
// Invariant: time and memory are bounded. A malformed or too large file causes an error that lists the faults.

import { textureReader } from './textures.js';

/** Limits: bytes of a file, triangles of all instances, nodes of a scene, and depth of the node tree. */
const [ MOST_BYTES, MOST_TRIANGLES, MOST_NODES, MOST_DEPTH ] = [ 2 ** 26, 2 ** 18, 2 ** 16, 64 ];
const COMPONENTS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

/** Extensions that a file may require, because this module reads them or can ignore them. */
const KNOWN = /^(KHR_(materials_.*|texture_.*|mesh_quantization|lights_punctual)|EXT_lights_area)$/;

/** The largest number of vertices or indices of an emissive mesh that a plan reads as a light. */
const MOST_OF_LAMP = 64;

const list = ( value ) => Array.isArray( value ) ? value : [];

const numberOf = ( value, otherwise ) => Number.isFinite( value ) ? value : otherwise;

/** The JSON of a file and its binary chunk. */
function parts( buffer ) {
	if ( buffer.byteLength > MOST_BYTES ) throw new Error( `the file has ${ buffer.byteLength } bytes; the limit is ${ MOST_BYTES }` );
	const view = new DataView( buffer );
	if ( buffer.byteLength < 20 || view.getUint32( 0, true ) !== 0x46546c67 ) return { document: parsed( new Uint8Array( buffer ) ), binary: null };
	const version = view.getUint32( 4, true );
	if ( version !== 2 ) throw new Error( `the GLB has version ${ version }; only version 2 is supported` );
	let [ document, binary ] = [ null, null ];
	for ( let at = 12; at + 8 <= buffer.byteLength; ) {
		const [ length, type ] = [ view.getUint32( at, true ), view.getUint32( at + 4, true ) ];
		if ( at + 8 + length > buffer.byteLength ) throw new Error( `the chunk at byte ${ at } has ${ length } bytes, but the file has only ${ buffer.byteLength - at - 8 } more` );
		const chunk = buffer.slice( at + 8, at + 8 + length );
		if ( type === 0x4e4f534a ) document ??= parsed( new Uint8Array( chunk ) );
		if ( type === 0x004e4942 ) binary ??= chunk;
		at += 8 + length;
	}
	if ( ! document ) throw new Error( 'the GLB has no JSON chunk' );
	return { document, binary };
}

function parsed( bytes ) {
	let document = null;
	try {
		document = JSON.parse( new TextDecoder().decode( bytes ) );
	} catch {
		throw new Error( 'the file is neither a GLB nor a glTF file in JSON' );
	}
	if ( ! /^2\./.test( document?.asset?.version ) ) throw new Error( `asset.version is ${ JSON.stringify( document?.asset?.version ) }; only 2.x is supported` );
	const needed = list( document.extensionsRequired ).filter( ( name ) => ! KNOWN.test( name ) );
	if ( needed.length ) throw new Error( `the file requires ${ needed.join( ', ' ) }, which the viewer does not support; export the scene without them` );
	return document;
}

/** The bytes of a buffer inside the file. */
function bufferOf( document, index, binary ) {
	const { uri } = document.buffers?.[ index ] || {};
	if ( uri === undefined && index === 0 && binary ) return binary;
	const [ , data ] = /^data:[^,]*;base64,(.*)$/s.exec( uri || '' ) || [];
	if ( data === undefined ) throw new Error( `buffers/${ index } is ${ uri === undefined ? 'missing' : `in another file, «${ String( uri ).slice( 0, 60 ) }»` }; save the scene as one GLB` );
	try {
		return Uint8Array.from( atob( data ), ( byte ) => byte.charCodeAt( 0 ) ).buffer;
	} catch {
		throw new Error( `buffers/${ index }/uri is not valid base64` );
	}
}

/** Returns a function that decodes buffers. Each buffer is decoded once. */
function bufferReader( document, binary ) {
	const known = new Map();
	return ( index ) => {
		if ( ! known.has( index ) ) known.set( index, bufferOf( document, index, binary ) );
		return known.get( index );
	};
}

/** Returns a function that reads accessors as contiguous numbers. Normalized integers are scaled to -1 to 1 or 0 to 1. */
function reader( document, bufferOf ) {
	const known = new Map();
	return ( index, type, path ) => {
		// Several instances can read the same accessor.
		if ( known.has( `${ index } ${ type }` ) ) return known.get( `${ index } ${ type }` );
		const at = `${ path }: accessors/${ index }`;
		const accessor = document.accessors?.[ index ];
		if ( ! accessor ) throw new Error( `${ at } does not exist` );
		if ( accessor.sparse ) throw new Error( `${ at } is sparse, which the viewer does not support` );
		if ( accessor.type !== type ) throw new Error( `${ at } has type ${ accessor.type }; it must be ${ type }` );
		const [ Of, view ] = [ COMPONENTS[ accessor.componentType ], document.bufferViews?.[ accessor.bufferView ] ];
		if ( ! Of || ! view ) throw new Error( `${ at } has ${ Of ? 'no buffer view' : `the unknown component type ${ accessor.componentType }` }` );
		const buffer = bufferOf( view.buffer );
		const width = WIDTHS[ type ];
		const { count } = accessor;
		const stride = view.byteStride || width * Of.BYTES_PER_ELEMENT;
		const start = ( view.byteOffset || 0 ) + ( accessor.byteOffset || 0 );
		if ( ! ( Number.isInteger( count ) && count > 0 && Number.isInteger( start ) && start >= 0 && Number.isInteger( stride ) && stride > 0 ) || start + stride * ( count - 1 ) + width * Of.BYTES_PER_ELEMENT > buffer.byteLength ) throw new Error( `${ at } has ${ count } elements from byte ${ start }, but its buffer ends at byte ${ buffer.byteLength }` );
		const read = new DataView( buffer );
		const method = `get${ Of.name.replace( 'Array', '' ) }`;
		const scale = accessor.normalized && Of !== Float32Array ? 1 / ( 2 ** ( 8 * Of.BYTES_PER_ELEMENT - ( Of.name.startsWith( 'Int' ) ? 1 : 0 ) ) - 1 ) : 1;
		const numbers = new ( type === 'SCALAR' ? Uint32Array : Float32Array )( width * count );
		for ( let i = 0; i < count; i ++ ) for ( let c = 0; c < width; c ++ ) numbers[ width * i + c ] = scale * read[ method ]( start + stride * i + Of.BYTES_PER_ELEMENT * c, true );
		known.set( `${ index } ${ type }`, numbers );
		return numbers;
	};
}

/** The parameters of GGX for a material: both roughnesses, rotation of the tangent, reflectance at normal incidence, and the factors of textures. */
export function materialOf( { pbrMetallicRoughness: pbr = {}, normalTexture, extensions = {} } = {} ) {
	const alpha = Math.min( 1, Math.max( 0, numberOf( pbr.roughnessFactor, 1 ) ) ) ** 2;
	const { anisotropyStrength, anisotropyRotation } = extensions.KHR_materials_anisotropy || {};
	const strength = Math.min( 1, Math.max( 0, numberOf( anisotropyStrength, 0 ) ) );
	const ior = numberOf( extensions.KHR_materials_ior?.ior, 1.5 );
	const dielectric = ( ( ior - 1 ) / ( ior + 1 ) ) ** 2 * numberOf( extensions.KHR_materials_specular?.specularFactor, 1 );
	const metal = Math.min( 1, Math.max( 0, numberOf( pbr.metallicFactor, 1 ) ) );
	const base = [ 0, 1, 2 ].map( ( c ) => numberOf( pbr.baseColorFactor?.[ c ], 1 ) );
	const f0 = base.map( ( colour ) => dielectric + ( colour - dielectric ) * metal );
	const diffuse = base.map( ( colour ) => colour * ( 1 - metal ) );
	// Textures multiply these factors.
	const factors = { base, factors: [ metal, Math.sqrt( alpha ), dielectric, strength * strength ], normal_scale: numberOf( normalTexture?.scale, 1 ) };
	return { factors, alpha_x: alpha + ( 1 - alpha ) * strength * strength, alpha_y: alpha, rotation: numberOf( anisotropyRotation, 0 ), f0, diffuse };
}

/** The local matrix of a node, by columns. */
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

/** Every mesh of the scene with its world matrix. */
function instances( document ) {
	const nodes = list( document.nodes );
	const children = new Set( nodes.flatMap( ( node ) => list( node?.children ) ) );
	const roots = document.scenes?.[ document.scene ?? 0 ]?.nodes ?? nodes.map( ( _, i ) => i ).filter( ( i ) => ! children.has( i ) );
	const found = [];
	let visited = 0;
	const visit = ( index, above, depth ) => {
		const node = nodes[ index ];
		if ( ! node ) throw new Error( `nodes/${ index } does not exist` );
		if ( depth > MOST_DEPTH ) throw new Error( `nodes/${ index } is nested ${ depth } levels deep; the limit is ${ MOST_DEPTH }` );
		if ( ++ visited > MOST_NODES ) throw new Error( `the scene has too many nodes; the limit is ${ MOST_NODES }` );
		const world = product( above, matrixOf( node ) );
		if ( node.mesh !== undefined ) found.push( { mesh: node.mesh, world } );
		for ( const child of list( node.children ) ) visit( child, world, depth + 1 );
	};
	for ( const root of list( roots ) ) visit( root, matrixOf( {} ), 0 );
	return found;
}

/** Converts the indices of a primitive to the indices of triangles, three per triangle. Returns null for points and lines. */
function triangles( mode, indices ) {
	if ( mode === 4 ) return indices.subarray( 0, indices.length - indices.length % 3 );
	if ( mode !== 5 && mode !== 6 ) return null;
	return Uint32Array.from( { length: 3 * Math.max( indices.length - 2, 0 ) }, ( _, i ) => {
		const [ triangle, corner ] = [ Math.floor( i / 3 ), i % 3 ];
		if ( mode === 6 ) return indices[ corner ? triangle + corner : 0 ];
		// Every second triangle of a strip has the opposite orientation.
		return indices[ triangle + ( triangle % 2 && corner ? 3 - corner : corner ) ];
	} );
}

/** Appends the triangles of a primitive in world space: position, normal, and tangent with its sign, ten numbers per corner. If the material has textures, also appends texture coordinates. Returns a note or ''. */
function append( { numbers, uv, textures }, budget, primitive, world, read, path ) {
	const { attributes = {} } = primitive;
	if ( attributes.POSITION === undefined ) throw new Error( `${ path }/attributes/POSITION is missing` );
	const positions = read( attributes.POSITION, 'VEC3', `${ path }/attributes/POSITION` );
	const normals = attributes.NORMAL === undefined ? null : read( attributes.NORMAL, 'VEC3', `${ path }/attributes/NORMAL` );
	const tangents = attributes.TANGENT === undefined ? null : read( attributes.TANGENT, 'VEC4', `${ path }/attributes/TANGENT` );
	const places = textures ? read( attributes.TEXCOORD_0, 'VEC2', `${ path }/attributes/TEXCOORD_0` ) : null;
	const count = positions.length / 3;
	if ( places && places.length !== 2 * count ) throw new Error( `${ path }: TEXCOORD_0 has ${ places.length / 2 } elements, but POSITION has ${ count }` );
	const all = primitive.indices === undefined ? Uint32Array.from( { length: count }, ( _, i ) => i ) : read( primitive.indices, 'SCALAR', `${ path }/indices` );
	const corners = triangles( primitive.mode ?? 4, all );
	if ( ! corners ) return 'points and lines are not shown';
	const most = corners.reduce( ( most, index ) => Math.max( most, index ), 0 );
	if ( most >= count || normals && normals.length !== positions.length || tangents && 3 * tangents.length !== 4 * positions.length ) throw new Error( `${ path }: index ${ most } is too large or the counts differ: ${ count } positions, ${ normals ? normals.length / 3 : 'no' } normals, ${ tangents ? tangents.length / 4 : 'no' } tangents` );
	budget.triangles += corners.length / 3;
	if ( budget.triangles > MOST_TRIANGLES ) throw new Error( `${ path }: the scene has ${ budget.triangles } triangles so far; the limit is ${ MOST_TRIANGLES }` );
	const m = world;
	const turned = ( [ x, y, z ], w = 0 ) => [ 0, 1, 2 ].map( ( r ) => m[ r ] * x + m[ 4 + r ] * y + m[ 8 + r ] * z + m[ 12 + r ] * w );
	const column = ( c ) => m.slice( 4 * c, 4 * c + 3 );
	const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];
	// The cofactor matrix transforms normals. If the world matrix mirrors, `side` flips normals and the order of corners.
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
	return tangents ? '' : 'the file has no tangents, so anisotropy runs around the vertical axis';
}

/** Whether a plan reads a primitive as a light. */
function isLamp( document, { attributes = {}, indices }, { emissiveFactor, emissiveTexture } ) {
	const counts = [ ...Object.values( attributes ), indices ].map( ( index ) => document.accessors?.[ index ]?.count ?? 0 );
	return ! emissiveTexture && list( emissiveFactor ).some( ( channel ) => channel > 0 ) && Math.max( ...counts ) <= MOST_OF_LAMP;
}

/** Moves and scales all positions into the unit sphere around the origin. Also returns the middle and the radius of the scene. */
function fitted( meshes ) {
	const bounds = [ 0, 1, 2 ].map( ( r ) => {
		let [ least, most ] = [ Infinity, - Infinity ];
		for ( const { numbers } of meshes ) for ( let i = r; i < numbers.length; i += 10 ) [ least, most ] = [ Math.min( least, numbers[ i ] ), Math.max( most, numbers[ i ] ) ];
		return [ least, most ];
	} );
	const middle = bounds.map( ( [ least, most ] ) => ( least + most ) / 2 );
	let radius = 0;
	for ( const { numbers } of meshes ) for ( let i = 0; i < numbers.length; i += 10 ) radius = Math.max( radius, Math.hypot( ...middle.map( ( x, r ) => numbers[ i + r ] - x ) ) );
	if ( ! ( radius > 0 && Number.isFinite( radius ) ) ) throw new Error( 'all triangles are at one point, or their positions are not finite' );
	for ( const { numbers } of meshes ) for ( let i = 0; i < numbers.length; i += 10 ) for ( let r = 0; r < 3; r ++ ) numbers[ i + r ] = ( numbers[ i + r ] - middle[ r ] ) / radius;
	return { place: { middle, radius }, meshes: meshes.map( ( mesh ) => ( { ...mesh, numbers: new Float32Array( mesh.numbers ), uv: mesh.textures && new Float32Array( mesh.uv ) } ) ) };
}

/** Reads a file. Returns one mesh per material, scaled into the unit sphere, the place of the scene, and notes about parts that are not shown. */
export async function readGltf( buffer ) {
	try {
		return await found( buffer );
	} catch ( error ) {
		// A type error means that a member has a type that glTF does not allow.
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
		if ( ! primitives ) faults.add( `meshes/${ mesh } does not exist` );
		for ( const [ i, primitive ] of list( primitives ).entries() ) {
			const material = document.materials?.[ primitive.material ];
			const hasPlaces = primitive.attributes?.TEXCOORD_0 !== undefined;
			const isTextured = hasPlaces && /"index":/.test( JSON.stringify( material ?? {} ) );
			const isLight = isLamp( document, primitive, material ?? {} );
			const key = `${ material ? primitive.material : '' } ${ isTextured } ${ isLight }`;
			if ( ! byMaterial.has( key ) ) {
				const [ own, { textures, isBent } ] = [ materialOf( material ), await texturesOf( material ?? {}, hasPlaces ) ];
				if ( ! isBent ) own.factors.normal_scale = 0;
				byMaterial.set( key, { name: material?.name || `material ${ byMaterial.size + 1 }`, material: own, textures, isLight, numbers: [], uv: [] } );
			}
			try {
				notes.add( append( byMaterial.get( key ), budget, primitive, world, read, `meshes/${ mesh }/primitives/${ i }` ) );
			} catch ( error ) {
				faults.add( error.message );
			}
		}
	}
	if ( faults.size ) throw new Error( [ ...faults ].slice( 0, 8 ).join( '; ' ) );
	const all = [ ...byMaterial.values() ].filter( ( { numbers } ) => numbers.length );
	if ( ! all.length ) throw new Error( 'the file has no triangles' );
	// Lamps are lights, which the viewer draws itself.
	const surfaces = all.filter( ( { isLight } ) => ! isLight );
	return { ...fitted( surfaces.length ? surfaces : all ), triangles: budget.triangles, notes: [ ...notes ].filter( Boolean ) };
}
