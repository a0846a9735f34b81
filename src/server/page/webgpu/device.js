// WebGPU: the same as webgl/device.js draws by WebGL 2, of the same scenes, models and pictures.

import { bound, filtered, numbers, read, sampled } from './bind.js';
import { modelShader } from './models.js';
import { imaged } from './images.js';
import { gpuPictures } from './pictures.js';
import { referenceShader } from './reference.js';
import { packed } from './scene.js';
import { COVERS, DISPLAY_SHADER, meshShader, SURFACE_SHADER } from './surface.js';

const SEEN = 4;
/** Bytes a pixel of what a surface writes: four textures of four 32-bit numbers. */
const SEEN_BYTES = 64;
/** The order of members of `ltc_table` in the texts; the first two are whole numbers. */
const TABLE = [ 'nodes', 'reading', 'start', 'spacing', 'per_step', 'texel', 'roughness', 'cosines', 'azimuths' ];
const CORNERS = { arrayStride: 40, attributes: [ [ 'float32x3', 0 ], [ 'float32x3', 12 ], [ 'float32x4', 24 ] ].map( ( [ format, offset ], shaderLocation ) => ( { format, offset, shaderLocation } ) ) };
/** The place of a corner in textures, in a buffer of its own. */
const PLACES = { arrayStride: 8, attributes: [ { format: 'float32x2', offset: 0, shaderLocation: 3 } ] };

/** What is bound of a model: the table's uniforms and textures as its text has them, or those of engines. */
function textures( device, { kind, uniforms, textures } ) {

	const made = textures.map( ( { width, height, depth, numbers, halves } ) => {

		const texture = device.createTexture( { format: halves ? 'rgba16float' : 'rgba32float', dimension: halves ? '2d' : '3d', size: [ width, height, depth || 1 ], usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST } );
		device.queue.writeTexture( { texture }, halves || numbers, { bytesPerRow: width * ( halves ? 8 : 16 ), rowsPerImage: height }, [ width, height, depth || 1 ] );
		return halves ? filtered( texture ) : read( texture, '3d' );

	} );
	if ( kind === 'normals' ) return [];
	if ( kind === 'engines' ) return [ ...made, sampled( device, 'filtering' ) ];
	const bytes = new ArrayBuffer( 16 * TABLE.length );
	TABLE.forEach( ( member, i ) => new ( i < 2 ? Uint32Array : Float32Array )( bytes, 16 * i, 4 ).set( uniforms[ `ltc_table.${ member }` ] ) );
	return [ numbers( device, bytes ), ...made, sampled( device, 'non-filtering' ) ];

}

/** What draws scenes on a canvas, or an error that tells why there is no WebGPU. `failed` is called with what goes wrong later. */
export async function gpuDevice( canvas, failed ) {

	const adapter = await navigator.gpu?.requestAdapter();
	if ( ! adapter ) throw new Error( 'this browser has no WebGPU' );
	if ( adapter.limits.maxColorAttachmentBytesPerSample < SEEN_BYTES ) throw new Error( `this graphics card draws ${ adapter.limits.maxColorAttachmentBytesPerSample } bytes a pixel at once; ${ SEEN_BYTES } are needed` );
	const device = await adapter.requestDevice( { requiredLimits: { maxColorAttachmentBytesPerSample: SEEN_BYTES } } );
	device.addEventListener( 'uncapturederror', ( event ) => {

		event.preventDefault();
		failed( event.error.message );

	} );
	let isLost = false;
	device.lost.then( ( { reason, message } ) => {

		isLost = true;
		if ( reason !== 'destroyed' ) failed( message || 'the device was lost' );

	} );
	const context = canvas.getContext( 'webgpu' );
	const format = navigator.gpu.getPreferredCanvasFormat();
	context.configure( { device, format, alphaMode: 'opaque' } );
	const size = [ canvas.width, canvas.height ];
	const target = ( format ) => device.createTexture( { format, size, usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.RENDER_ATTACHMENT } );
	const seen = Array.from( { length: SEEN }, () => target( 'rgba32float' ) );
	const depth = target( 'depth24plus' ).createView();
	const [ left, right, ...sums ] = Array.from( { length: 4 }, () => target( 'rgba32float' ) );
	const pipelines = new Map();
	const models = new Map();
	const vertices = new Map();
	const images = new Map();
	let pictures = null;

	function buffered( numbers ) {

		const buffer = device.createBuffer( { size: numbers.byteLength, usage: GPUBufferUsage.VERTEX | GPUBufferUsage.COPY_DST } );
		device.queue.writeBuffer( buffer, 0, numbers );
		return buffer;

	}

	/** The pipeline of a program, which is compiled when it is first asked for. */
	function pipeline( code, groups, { formats, mesh } ) {

		if ( ! pipelines.has( code ) ) {

			const module = device.createShaderModule( { code } );
			pipelines.set( code, device.createRenderPipeline( {
				layout: device.createPipelineLayout( { bindGroupLayouts: groups.map( ( { layout } ) => layout ) } ),
				vertex: { module, entryPoint: mesh ? 'corner' : 'covers', buffers: mesh ? [ CORNERS, PLACES ].slice( 0, mesh.buffers.length ) : [] },
				fragment: { module, entryPoint: 'main', targets: formats.map( ( format ) => ( { format } ) ) },
				...( mesh && { depthStencil: { format: 'depth24plus', depthWriteEnabled: true, depthCompare: 'less' } } ),
			} ) );

		}

		return pipelines.get( code );

	}

	/** Runs a program over textures or single levels of them, or over triangles of a mesh that are added to what is there. */
	function draw( code, to, items, { formats, mesh, clears = true } ) {

		const groups = items.map( ( group ) => bound( device, group ) );
		const encoder = device.createCommandEncoder();
		const load = clears ? 'clear' : 'load';
		const pass = encoder.beginRenderPass( {
			colorAttachments: to.map( ( texture ) => ( { view: texture instanceof GPUTextureView ? texture : texture.createView(), loadOp: load, storeOp: 'store' } ) ),
			...( mesh && { depthStencilAttachment: { view: depth, depthClearValue: 1, depthLoadOp: load, depthStoreOp: 'store' } } ),
		} );
		pass.setPipeline( pipeline( code, groups, { formats, mesh } ) );
		groups.forEach( ( { group }, i ) => pass.setBindGroup( i, group ) );
		mesh?.buffers.forEach( ( buffer, i ) => pass.setVertexBuffer( i, buffer ) );
		pass.draw( mesh ? mesh.corners : 3 );
		pass.end();
		device.queue.submit( [ encoder.finish() ] );

	}

	/** The same with the numbers of a scene, which are bound first in group 1. */
	function run( code, to, ofModel, values, items, how = { formats: to.map( () => 'rgba32float' ) } ) {

		const scene = numbers( device, packed( values ) );
		draw( code, to, [ ofModel, [ scene, ...items ] ], how );
		scene.resource.buffer.destroy();

	}

	const pixel = seen.map( ( texture ) => read( texture ) );

	return {
		language: 'wgsl',
		see( uniforms ) {

			run( SURFACE_SHADER, seen, [], uniforms, [] );

		},
		seeMeshes( uniforms, meshes ) {

			meshes.forEach( ( { numbers, uv, textures: ofMesh, ofMaterial }, i ) => {

				if ( ! vertices.has( numbers ) ) vertices.set( numbers, { buffers: [ numbers, uv ].filter( Boolean ).map( buffered ), corners: numbers.length / 10 } );
				const bound = Object.values( ofMesh || {} ).flatMap( ( image ) => {

					if ( ! images.has( image ) ) images.set( image, imaged( device, draw, image ) );
					return images.get( image );

				} );
				run( meshShader( Boolean( ofMesh ) ), seen, [], { ...uniforms, ...ofMaterial }, bound, { formats: seen.map( () => 'rgba32float' ), mesh: vertices.get( numbers ), clears: i === 0 } );

			} );

		},
		picture( layers, text ) {

			const size = layers.length ? [ layers[ 0 ].width, layers[ 0 ].height ] : [];
			if ( pictures && ( pictures.layers !== layers.length || String( pictures.size ) !== String( size ) ) ) {

				pictures.release();
				pictures = null;

			}

			if ( ! layers.length ) return 0;
			pictures ||= gpuPictures( device, draw, COVERS, text, size, layers.length );
			return layers.reduce( ( calls, canvas, layer ) => calls + pictures.update( canvas, layer ), 0 );

		},
		light( side, model, uniforms, shapes ) {

			if ( ! models.has( model.textures ) ) models.set( model.textures, textures( device, model ) );
			const ofLights = pictures ? [ filtered( pictures.pyramids, '2d-array' ), ...( model.kind === 'engines' ? [] : [ sampled( device, 'filtering' ) ] ) ] : [];
			const code = modelShader( model.kind, model.text, shapes );
			run( code, [ side === 'left' ? left : right ], [ ...models.get( model.textures ), ...ofLights ], { ...uniforms, ...( pictures && { picture_base: pictures.base } ) }, pixel );

		},
		sample( brdf, uniforms, shapes, first, samples ) {

			run( referenceShader( brdf, shapes ), [ sums[ 1 ] ], [], { ...uniforms, first, samples }, [ ...pixel, read( sums[ 0 ] ), pictures ? read( pictures.shown, '2d-array' ) : undefined ] );
			sums.reverse();

		},
		display( uniforms, samples ) {

			const other = samples === null ? right : sums[ 0 ];
			run( DISPLAY_SHADER, [ context.getCurrentTexture() ], [], { ...uniforms, left_weight: 1, right_weight: 1 / Math.max( samples ?? 1, 1 ) }, [ pixel[ 0 ], read( left ), read( other ) ], { formats: [ format ] } );

		},
		/** Waits until all is drawn, so that the time of a frame is that of its drawing. */
		done: () => device.queue.onSubmittedWorkDone(),
		isLost: () => isLost,
		release() {

			device.destroy();

		},
	};

}
