// A glTF file that is dropped on the viewer: a sphere of triangles beside the viewer's own, and files with faults.

import { withWorld } from './world.js';

/** A sphere of triangles around (4, 5, 6), of radius 2 by its node, with tangents along circles of latitude. */
function sphere( rows, material ) {

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

/** The bytes of a GLB. */
function glb( { document, binary } ) {

	const text = Buffer.from( JSON.stringify( document ) );
	const json = Buffer.concat( [ text, Buffer.alloc( - text.length & 3, 32 ) ] );
	const words = ( ...values ) => Buffer.from( new Uint32Array( values ).buffer );
	return Buffer.concat( [ words( 0x46546c67, 2, 28 + json.length + binary.length, json.length, 0x4e4f534a ), json, words( binary.length, 0x004e4942 ), binary ] );

}

await withWorld( async ( { open } ) => {

	const material = { pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: Math.sqrt( 0.2 ), baseColorFactor: [ 0.91, 0.92, 0.92, 1 ] }, extensions: { KHR_materials_anisotropy: { anisotropyStrength: Math.sqrt( 0.375 ), anisotropyRotation: 0.6 } } };
	const page = await open( 'viewer?show=model&rotation=0.6&alpha_x=0.5&alpha_y=0.2' );
	/** The bytes of the middle of the sphere. */
	const bytes = () => page.evaluate( () => {

		const [ canvas, copy ] = [ document.querySelector( '.stage canvas' ), document.createElement( 'canvas' ) ];
		Object.assign( copy, { width: canvas.width, height: canvas.height } );
		const context = copy.getContext( '2d' );
		context.drawImage( canvas, 0, 0 );
		return [ ...context.getImageData( 190, 190, 132, 132 ).data ];

	} );
	const frames = page.locator( '.page-viewer .facts' );
	await frames.waitFor();
	const own = await bytes();
	const offer = async ( name, buffer ) => {

		await page.locator( '#mesh' ).setInputFiles( { name, mimeType: 'model/gltf-binary', buffer } );
		return page.locator( '.controls [role=status] p' ).filter( { hasText: name.startsWith( 'bad' ) ? name : 'triangles' } ).textContent();

	};

	const drop = async ( name, text ) => {

		const data = await page.evaluateHandle( ( [ name, text ] ) => {

			const data = new DataTransfer();
			data.items.add( new File( [ text ], name ) );
			return data;

		}, [ name, text ] );
		await page.dispatchEvent( '.stage canvas', 'drop', { dataTransfer: data } );
		return page.locator( '.controls [role=status] p' ).filter( { hasText: name } ).textContent();

	};

	const told = await offer( 'sphere.glb', glb( sphere( 96, material ) ) );
	await page.waitForFunction( () => document.querySelector( '#view-surface' ).value === 'mesh' );
	// The frame after the next shows it.
	await page.evaluate( () => new Promise( ( done ) => requestAnimationFrame( () => requestAnimationFrame( done ) ) ) );
	const meshed = await bytes();
	const apart = Math.max( ...meshed.map( ( byte, i ) => Math.abs( byte - own[ i ] ) ) );
	const small = sphere( 2, material );
	const outside = structuredClone( small.document );
	outside.accessors[ 0 ].count = 99;
	outside.meshes[ 0 ].primitives.push( { attributes: {} } );
	const beside = structuredClone( small.document );
	beside.buffers[ 0 ].uri = 'sphere.bin';
	const faults = [
		await offer( 'bad1.glb', glb( { ...small, document: outside } ) ),
		await offer( 'bad2.glb', glb( { ...small, document: beside } ) ),
		await drop( 'bad3.glb', 'no glTF' ),
		await offer( 'bad4.glb', glb( { ...small, document: { ...small.document, nodes: [ { children: [ 0 ] } ] } } ) ),
		await offer( 'bad5.glb', glb( { ...small, document: { ...small.document, extensionsRequired: [ 'KHR_draco_mesh_compression' ] } } ) ),
	];
	return { told, bright: Math.max( ...own.filter( ( _, i ) => i % 4 < 3 ) ), apart, faults };

} );
