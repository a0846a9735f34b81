// Tests glTF files in the viewer: a sphere of triangles compared with the viewer's own sphere, and files with errors.

import { glb, sphere } from './glb.js';
import { withWorld } from './world.js';

await withWorld( async ( { open } ) => {

	const material = { pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: Math.sqrt( 0.2 ), baseColorFactor: [ 0.91, 0.92, 0.92, 1 ] }, extensions: { KHR_materials_anisotropy: { anisotropyStrength: Math.sqrt( 0.375 ), anisotropyRotation: 0.6 } } };
	const page = await open( 'viewer?size=512&glow=off&diffuse=off&spp=2&show=model&rotation=0.6&alpha_x=0.5&alpha_y=0.2' );
	/** The bytes in the middle of the sphere. */
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

	const note = await offer( 'sphere.glb', glb( sphere( 96, material ) ) );
	await page.waitForFunction( () => document.querySelector( '#view-surface' ).value === 'mesh' );
	// The mesh appears in the second frame.
	await page.evaluate( () => new Promise( ( done ) => requestAnimationFrame( () => requestAnimationFrame( done ) ) ) );
	const meshed = await bytes();
	const apart = Math.max( ...meshed.map( ( byte, i ) => Math.abs( byte - own[ i ] ) ) );
	// The service renders the same sphere on the CPU.
	const ofCpu = await page.evaluate( async () => {

		const parameters = new URLSearchParams( { scene: 'sphere', model: 'normals', alpha_x: 0.5, alpha_y: 0.2, rotation: 0.6, size: 512, camera_distance: 9, camera_elevation: 0.2, field_of_view: 0.5, light: 'rectangle', light_centre: '-1.3,1.4,1.2', light_half_size: '0.7,0.45' } );
		const image = await createImageBitmap( await ( await fetch( `v1/preview?${ parameters }` ) ).blob() );
		const canvas = Object.assign( document.createElement( 'canvas' ), { width: 512, height: 512 } );
		canvas.getContext( '2d' ).drawImage( image, 0, 0 );
		return [ ...canvas.getContext( '2d' ).getImageData( 190, 190, 132, 132 ).data ];

	} );
	const fromCpu = Math.max( ...meshed.map( ( byte, i ) => Math.abs( byte - ofCpu[ i ] ) ) );
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
	return { note, bright: Math.max( ...own.filter( ( _, i ) => i % 4 < 3 ) ), apart, from_cpu: fromCpu, faults };

} );
