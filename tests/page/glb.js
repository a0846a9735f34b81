// Generates scenes in glTF 2.0.

/** A sphere of triangles with centre (4, 5, 6) and radius 2, both by its nodes. Tangents run along circles of latitude. */
export function sphere( rows, material ) {

	const [ places, tangents, indices ] = [ [], [], [] ];
	for ( let row = 0; row <= rows; row ++ ) for ( let column = 0; column <= 2 * rows; column ++ ) {

		const [ theta, phi ] = [ Math.PI * row / rows, Math.PI * column / rows ];
		places.push( Math.sin( theta ) * Math.sin( phi ), Math.cos( theta ), Math.sin( theta ) * Math.cos( phi ) );
		tangents.push( Math.cos( phi ), 0, - Math.sin( phi ), 1 );
		const at = row * ( 2 * rows + 1 ) + column;
		if ( row < rows && column < 2 * rows ) indices.push( at, at + 2 * rows + 1, at + 1, at + 1, at + 2 * rows + 1, at + 2 * rows + 2 );

	}

	const count = places.length / 3;
	const chunks = [ new Float32Array( places ), new Float32Array( tangents ), new Uint32Array( indices ) ].map( ( { buffer } ) => Buffer.from( buffer ) );
	const document = {
		asset: { version: '2.0' }, scene: 0, scenes: [ { nodes: [ 0 ] } ],
		nodes: [ { translation: [ 4, 5, 6 ], children: [ 1 ] }, { mesh: 0, scale: [ 2, 2, 2 ] } ],
		meshes: [ { primitives: [ { attributes: { POSITION: 0, NORMAL: 0, TANGENT: 1 }, indices: 2, material: 0 } ] } ],
		materials: [ material ],
		buffers: [ { byteLength: Buffer.concat( chunks ).length } ],
		bufferViews: chunks.map( ( { length }, i ) => ( { buffer: 0, byteLength: length, byteOffset: chunks.slice( 0, i ).reduce( ( sum, { length } ) => sum + length, 0 ) } ) ),
		accessors: [ [ 'VEC3', 5126, count ], [ 'VEC4', 5126, count ], [ 'SCALAR', 5125, indices.length ] ].map( ( [ type, componentType, count ], bufferView ) => ( { type, componentType, count, bufferView } ) ),
	};
	return { document, binary: Buffer.concat( chunks ) };

}

/** The sphere with texture coordinates, with images inside the file, and with tangents if `hasTangents`. u grows to the east, v downwards. */
export function texturedSphere( rows, material, images, hasTangents = true ) {

	const { document, binary } = sphere( rows, material );
	const places = Array.from( { length: rows + 1 }, ( _, row ) => Array.from( { length: 2 * rows + 1 }, ( _, column ) => [ column / ( 2 * rows ), row / rows ] ) ).flat( 2 );
	const chunks = [ Buffer.from( new Float32Array( places ).buffer ), ...images ];
	// Every chunk starts at a multiple of four bytes.
	const padded = chunks.map( ( chunk ) => Buffer.concat( [ chunk, Buffer.alloc( - chunk.length & 3 ) ] ) );
	let at = binary.length;
	for ( const [ i, chunk ] of chunks.entries() ) {

		document.bufferViews.push( { buffer: 0, byteOffset: at, byteLength: chunk.length } );
		at += padded[ i ].length;

	}

	document.accessors.push( { type: 'VEC2', componentType: 5126, count: places.length / 2, bufferView: 3 } );
	const { attributes } = document.meshes[ 0 ].primitives[ 0 ];
	attributes.TEXCOORD_0 = 3;
	if ( ! hasTangents ) delete attributes.TANGENT;
	document.images = images.map( ( _, i ) => ( { bufferView: 4 + i } ) );
	document.textures = images.map( ( _, source ) => ( { source } ) );
	document.buffers[ 0 ].byteLength = at;
	return { document, binary: Buffer.concat( [ binary, ...padded ] ) };

}

/** The bytes of a GLB. */
export function glb( { document, binary } ) {

	const text = Buffer.from( JSON.stringify( document ) );
	const json = Buffer.concat( [ text, Buffer.alloc( - text.length & 3, 32 ) ] );
	const words = ( ...values ) => Buffer.from( new Uint32Array( values ).buffer );
	return Buffer.concat( [ words( 0x46546c67, 2, 28 + json.length + binary.length, json.length, 0x4e4f534a ), json, words( binary.length, 0x004e4942 ), binary ] );

}
