// Draws a scene with WebGL 2: the surface at each pixel, its light from the models, samples of the reference, and the final image.

import { program, target, texture } from './context.js';
import { modelShader, picturesOf } from './models.js';
import { pictures } from './pictures.js';
import { referenceShader } from './reference.js';
import { DISPLAY_SHADER, MESH_VERTEX, meshShader, SURFACE_SHADER } from './surface.js';

/** Names of the textures that store the surface at each pixel. */
const SURFACE_TEXTURES = [ 'surface_position', 'surface_tangent', 'surface_normal', 'surface_f0' ];

/** A texture of a model: a volume of 32-bit floats, which the shader interpolates, or an image of half floats, which the sampler interpolates. */
function ofModel( gl, { name, width, height, depth, numbers, halves } ) {
	const type = halves ? gl.TEXTURE_2D : gl.TEXTURE_3D;
	const fill = () => halves ? gl.texImage2D( type, 0, gl.RGBA16F, width, height, 0, gl.RGBA, gl.HALF_FLOAT, halves )
		: gl.texImage3D( type, 0, gl.RGBA32F, width, height, depth, 0, gl.RGBA, gl.FLOAT, numbers );
	return { name, type, texture: texture( gl, type, fill, halves ? gl.LINEAR : gl.NEAREST ) };
}

/** A texture of a mesh: an image with mipmaps, or one pixel. */
function ofMesh( gl, { image, pixel, isColour, wrap } ) {
	const format = isColour ? gl.SRGB8_ALPHA8 : gl.RGBA8;
	return texture( gl, gl.TEXTURE_2D, () => {
		if ( image ) gl.texImage2D( gl.TEXTURE_2D, 0, format, gl.RGBA, gl.UNSIGNED_BYTE, image );
		else gl.texImage2D( gl.TEXTURE_2D, 0, format, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixel );
		gl.generateMipmap( gl.TEXTURE_2D );
	}, gl.LINEAR_MIPMAP_LINEAR, gl.LINEAR, wrap );
}

/** The vertex array of a mesh: position, normal, tangent with its sign, and texture coordinates if it has textures. */
function corners( gl, numbers, uv ) {
	const array = gl.createVertexArray();
	gl.bindVertexArray( array );
	const attribute = ( i, width, stride, offset ) => {
		gl.enableVertexAttribArray( i );
		gl.vertexAttribPointer( i, width, gl.FLOAT, false, stride, offset );
	};

	const buffer = ( values ) => {
		gl.bindBuffer( gl.ARRAY_BUFFER, gl.createBuffer() );
		gl.bufferData( gl.ARRAY_BUFFER, values, gl.STATIC_DRAW );
	};

	buffer( numbers );
	[ [ 3, 0 ], [ 3, 12 ], [ 4, 24 ] ].forEach( ( [ width, offset ], i ) => attribute( i, width, 40, offset ) );
	if ( uv ) buffer( uv );
	if ( uv ) attribute( 3, 2, 0, 0 );
	return array;
}

/** Draws scenes on a canvas. The models come from `viewer/models.js`. */
export function device( canvas ) {
	const gl = canvas.getContext( 'webgl2', { alpha: false, antialias: false, preserveDrawingBuffer: true } );
	if ( ! gl ) throw new Error( 'the viewer needs WebGL 2, which this browser does not have' );
	if ( ! gl.getExtension( 'EXT_color_buffer_float' ) ) throw new Error( 'the viewer needs the WebGL extension EXT_color_buffer_float, which this browser or its graphics driver does not have' );
	const { width, height } = canvas;
	const screen = { framebuffer: null, width, height };
	const surfaceTarget = target( gl, SURFACE_TEXTURES.map( () => gl.RGBA32F ), width, height );
	const depth = gl.createRenderbuffer();
	gl.bindRenderbuffer( gl.RENDERBUFFER, depth );
	gl.renderbufferStorage( gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height );
	gl.framebufferRenderbuffer( gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth );
	const [ left, right, ...sums ] = Array.from( { length: 4 }, () => target( gl, [ gl.RGBA32F ], width, height ) );
	const known = new Map();

	/** Returns the program, texture or mesh for a key. The first call creates it. */
	function once( key, make ) {
		if ( ! known.has( key ) ) known.set( key, make( key ) );
		return known.get( key );
	}

	/** Runs a program on the whole image, or on triangles with `count` corners in total. */
	function run( { made, uniforms }, to, values, bound, count = 3 ) {
		gl.useProgram( made );
		gl.bindFramebuffer( gl.FRAMEBUFFER, to.framebuffer );
		gl.viewport( 0, 0, to.width, to.height );
		bound.forEach( ( { name, type = gl.TEXTURE_2D, texture }, i ) => {
			gl.activeTexture( gl.TEXTURE0 + i );
			gl.bindTexture( type, texture );
			uniforms.get( name )?.( i );
		} );
		for ( const [ name, value ] of Object.entries( values ) ) uniforms.get( name )?.( value );
		gl.drawArrays( gl.TRIANGLES, 0, count );
	}

	/** The pictures on lights, or null if there are no pictures. */
	let shown = null;
	const surface = SURFACE_TEXTURES.map( ( name, i ) => ( { name, texture: surfaceTarget.textures[ i ] } ) );
	const layered = ( name, texture ) => shown ? [ { name, type: gl.TEXTURE_2D_ARRAY, texture: shown[ texture ] } ] : [];

	return {
		/** Draws the surface of the sphere or the floor. */
		drawSurface: ( uniforms ) => run( once( 'surface', () => program( gl, SURFACE_SHADER ) ), surfaceTarget, uniforms, [] ),
		/** Draws meshes. Each mesh has ten numbers per corner, the uniforms of its material, and optionally textures. */
		drawMeshes( uniforms, meshes ) {
			gl.bindFramebuffer( gl.FRAMEBUFFER, surfaceTarget.framebuffer );
			SURFACE_TEXTURES.forEach( ( _, i ) => gl.clearBufferfv( gl.COLOR, i, [ 0, 0, 0, 0 ] ) );
			gl.clear( gl.DEPTH_BUFFER_BIT );
			gl.enable( gl.DEPTH_TEST );
			for ( const { numbers, uv, textures, ofMaterial } of meshes ) {
				const shader = once( `mesh ${ Boolean( textures ) }`, () => program( gl, meshShader( Boolean( textures ) ), MESH_VERTEX ) );
				const bound = Object.entries( textures || {} ).map( ( [ name, image ] ) => ( { name, texture: once( image, () => ofMesh( gl, image ) ) } ) );
				gl.bindVertexArray( once( numbers, () => corners( gl, numbers, uv ) ) );
				run( shader, surfaceTarget, { ...uniforms, ...ofMaterial }, bound, numbers.length / 10 );
			}

			gl.disable( gl.DEPTH_TEST );
			gl.bindVertexArray( null );
		},
		/** Prefilters pictures on lights with a shader text of the service. The pictures are canvases of the same size. Returns the number of draw calls. */
		picture( layers, text ) {
			const [ { width, height } = {} ] = layers;
			const key = `${ width } ${ height } ${ layers.length }`;
			if ( shown && shown.key !== key ) {
				shown.release();
				shown = null;
			}

			if ( layers.length ) shown ??= { key, ...pictures( gl, run, text, width, height, layers.length ) };
			return layers.reduce( ( calls, canvas, layer ) => calls + shown.update( canvas, layer ), 0 );
		},
		/** Computes the light of a model for the left or the right side. `shapes` has a bit for each shape of the lights. */
		light( side, model, uniforms, shapes ) {
			const textures = once( model.textures, () => model.textures.map( ( one ) => ofModel( gl, one ) ) );
			const shader = once( `${ model.kind } ${ shapes } ${ model.text }`, () => program( gl, modelShader( model.kind, model.text, shapes ) ) );
			run( shader, side === 'left' ? left : right, { ...uniforms, ...model.uniforms, picture_base: shown?.base ?? 0 }, [ ...surface, ...textures, ...layered( picturesOf( model.kind ), 'pyramids' ) ] );
		},
		/** Adds samples of the reference to the sum. `first` is the number of samples so far. */
		sample( brdf, uniforms, shapes, first, samples ) {
			const shader = once( `${ brdf } ${ shapes }`, () => program( gl, referenceShader( brdf, shapes ) ) );
			run( shader, sums[ 1 ], { ...uniforms, first, samples }, [ ...surface, { name: 'reference_sum', texture: sums[ 0 ].textures[ 0 ] }, ...layered( 'light_pictures', 'shown' ) ] );
			sums.reverse();
		},
		/** Shows both sides. The right side is a model if `samples` is null, otherwise the reference with this number of samples. */
		display( uniforms, samples ) {
			const other = samples === null ? right : sums[ 0 ];
			const sides = [ { name: 'left_radiance', texture: left.textures[ 0 ] }, { name: 'right_radiance', texture: other.textures[ 0 ] } ];
			run( once( 'display', () => program( gl, DISPLAY_SHADER ) ), screen, { ...uniforms, right_weight: 1 / Math.max( samples ?? 1, 1 ) }, [ ...surface, ...sides ] );
			// Reading a pixel waits for the GPU, so that the frame time is correct.
			gl.readPixels( 0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array( 4 ) );
		},
		isLost: () => gl.isContextLost(),
		release: () => gl.getExtension( 'WEBGL_lose_context' )?.loseContext(),
	};
}
