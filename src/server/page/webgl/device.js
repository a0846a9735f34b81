// Draws a scene with WebGL 2: the surface at each pixel, its light from the models, samples of the reference, and the final image.
//
// Light is summed over frames, because a mesh moves by a part of a pixel in each frame, so that its edges are smooth.

import { program, release, target, texture } from './context.js';
import { pictures } from './pictures.js';
import { displayShader, errorsShader, glowShader, meshShader, meshVertex, modelShader, picturesOf, referenceShader, shadowShader, surfaceShader } from './shaders.js';

/** Names of the textures that store the surface at each pixel. */
const SURFACE_TEXTURES = [ 'surface_position', 'surface_tangent', 'surface_normal', 'surface_f0' ];

/** A texture of a model: a volume, which the shader interpolates, or an image of half floats, which the sampler interpolates. */
function ofModel( gl, { name, width, height, depth, numbers, halves } ) {
	const type = depth ? gl.TEXTURE_3D : gl.TEXTURE_2D;
	const format = [ gl.RGBA, halves ? gl.HALF_FLOAT : gl.FLOAT, halves ?? numbers ];
	const fill = () => depth ? gl.texImage3D( type, 0, halves ? gl.RGBA16F : gl.RGBA32F, width, height, depth, 0, ...format ) : gl.texImage2D( type, 0, gl.RGBA16F, width, height, 0, ...format );
	return { name, type, texture: texture( gl, type, fill, depth ? gl.NEAREST : gl.LINEAR ) };
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
	const buffers = [ [ numbers, 40, [ [ 3, 0 ], [ 3, 12 ], [ 4, 24 ] ] ], ...( uv ? [ [ uv, 0, [ [ 2, 0 ] ] ] ] : [] ) ];
	let place = 0;
	const made = buffers.map( ( [ values, stride, attributes ] ) => {
		const buffer = gl.createBuffer();
		gl.bindBuffer( gl.ARRAY_BUFFER, buffer );
		gl.bufferData( gl.ARRAY_BUFFER, values, gl.STATIC_DRAW );
		for ( const [ width, offset ] of attributes ) {
			gl.enableVertexAttribArray( place );
			gl.vertexAttribPointer( place ++, width, gl.FLOAT, false, stride, offset );
		}
		return buffer;
	} );
	return { array, release() {
		gl.deleteVertexArray( array );
		made.forEach( ( buffer ) => gl.deleteBuffer( buffer ) );
	} };
}

/** Pixels per side of a tile, as in `glsl/errors.glsl`. */
const TILE = 4;

/** Draws scenes on a canvas. The models come from `viewer/models.js`. */
export function device( canvas ) {
	const gl = canvas.getContext( 'webgl2', { alpha: false, antialias: false, preserveDrawingBuffer: true } );
	if ( ! gl ) throw new Error( 'the viewer needs WebGL 2, which this browser does not have' );
	if ( ! gl.getExtension( 'EXT_color_buffer_float' ) ) throw new Error( 'the viewer needs the WebGL extension EXT_color_buffer_float, which this browser or its graphics driver does not have' );
	const known = new Map();
	/** Pixels per side, the targets of the surface and of the tiles, and a pair of targets for each sum: the last of a pair is the newest. */
	let [ size, surfaceTarget, tiles, depth, pairs ] = [ 0, null, null, null, new Map() ];

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
	const surface = () => SURFACE_TEXTURES.map( ( name, i ) => ( { name, texture: surfaceTarget.textures[ i ] } ) );
	const layered = ( name, texture ) => shown ? [ { name, type: gl.TEXTURE_2D_ARRAY, texture: shown[ texture ] } ] : [];
	/** The visible parts of the lights, for specular and for diffuse reflection. */
	let visible = null;
	const newest = ( side ) => pairs.get( side )?.at( - 1 ).textures ?? [ surfaceTarget.textures[ 0 ], surfaceTarget.textures[ 0 ] ];

	/** Adds to a sum. `names` are the samplers of the sum so far. The first frame, with `count` 0, replaces the sum. */
	function add( side, shader, count, values, names, bound ) {
		if ( ! pairs.has( side ) ) pairs.set( side, [] );
		const pair = pairs.get( side );
		const make = () => target( gl, names.map( () => gl.RGBA32F ), size, size );
		if ( pair.length < ( count ? 2 : 1 ) ) pair.unshift( make() );
		if ( count ) pair.reverse();
		// A program must not read the texture that it writes, even if it ignores the values.
		const before = count ? pair[ 0 ].textures : surfaceTarget.textures;
		run( shader, pair.at( - 1 ), values, [ ...bound, ...names.map( ( name, i ) => ( { name, texture: before[ i ] } ) ) ] );
	}
	const sides = () => [ ...surface(), { name: 'left_sum', texture: newest( 'left' )[ 0 ] }, { name: 'right_sum', texture: newest( 'right' )[ 0 ] }, { name: 'even_sum', texture: newest( 'truth' )[ 0 ] }, { name: 'odd_sum', texture: newest( 'truth' )[ 1 ] },
		{ name: 'glow_sum', texture: newest( 'glow' )[ 0 ] }, { name: 'diffuse_sum', texture: newest( 'diffuse' )[ 0 ] } ];

	/** The numbers of an attachment of a target. */
	function read( { framebuffer }, attachment, x, y, width, height ) {
		const numbers = new Float32Array( 4 * width * height );
		gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
		gl.readBuffer( gl.COLOR_ATTACHMENT0 + attachment );
		gl.readPixels( x, y, width, height, gl.RGBA, gl.FLOAT, numbers );
		return numbers;
	}
	return {
		/** Sets the number of pixels per side. Returns whether it has changed, so that all sums are lost. */
		resize( pixels ) {
			if ( pixels === size ) return false;
			size = canvas.width = canvas.height = pixels;
			for ( const one of [ surfaceTarget, tiles, visible, ...[ ...pairs.values() ].flat() ] ) release( gl, one );
			visible = null;
			gl.deleteRenderbuffer( depth );
			pairs = new Map();
			tiles = target( gl, [ gl.RGBA32F, gl.RGBA32F ], Math.ceil( size / TILE ), Math.ceil( size / TILE ) );
			surfaceTarget = target( gl, SURFACE_TEXTURES.map( () => gl.RGBA32F ), size, size );
			depth = gl.createRenderbuffer();
			gl.bindRenderbuffer( gl.RENDERBUFFER, depth );
			gl.renderbufferStorage( gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, size, size );
			gl.framebufferRenderbuffer( gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth );
			return true;
		},
		/** Draws the surface of the sphere or the floor. */
		drawSurface: ( uniforms ) => run( once( 'surface', () => program( gl, surfaceShader() ) ), surfaceTarget, uniforms, [] ),
		/** Draws meshes. Each mesh has ten numbers per corner, the uniforms of its material, and optionally textures. */
		drawMeshes( uniforms, meshes ) {
			gl.bindFramebuffer( gl.FRAMEBUFFER, surfaceTarget.framebuffer );
			SURFACE_TEXTURES.forEach( ( _, i ) => gl.clearBufferfv( gl.COLOR, i, [ 0, 0, 0, 0 ] ) );
			gl.clear( gl.DEPTH_BUFFER_BIT );
			gl.enable( gl.DEPTH_TEST );
			for ( const [ number, { numbers, uv, textures, ofMaterial } ] of meshes.entries() ) {
				const shader = once( `mesh ${ Boolean( textures ) }`, () => program( gl, meshShader( Boolean( textures ) ), meshVertex() ) );
				const bound = Object.entries( textures || {} ).map( ( [ name, image ] ) => ( { name, texture: once( image, () => ofMesh( gl, image ) ) } ) );
				gl.bindVertexArray( once( numbers, () => corners( gl, numbers, uv ) ).array );
				run( shader, surfaceTarget, { ...uniforms, ...ofMaterial, number }, bound, numbers.length / 10 );
			}
			gl.disable( gl.DEPTH_TEST );
			gl.bindVertexArray( null );
		},
		/** Deletes the buffers and textures of meshes that are no longer shown. */
		forget( meshes ) {
			for ( const { numbers, textures } of meshes ) {
				known.get( numbers )?.release();
				known.delete( numbers );
				for ( const image of Object.values( textures || {} ) ) {
					gl.deleteTexture( known.get( image ) ?? null );
					known.delete( image );
				}
			}
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
		/** Adds the light of a model to the side `left` or `right`, or diffuse light to `diffuse`. `shapes` has a bit for each shape of the lights. */
		light( side, model, uniforms, shapes, count ) {
			const textures = once( model.textures, () => model.textures.map( ( one ) => ofModel( gl, one ) ) );
			const shader = once( `${ model.kind } ${ shapes } ${ model.text }`, () => program( gl, modelShader( model.kind, model.text, shapes ) ) );
			add( side, shader, count, { ...uniforms, ...model.uniforms, picture_base: shown?.base ?? 0, sum_count: count }, [ 'sum_before' ], [ ...surface(), ...textures, ...layered( picturesOf( model.kind ), 'pyramids' ), ...( visible ? [ { name: 'light_visible', texture: visible.textures[ Number( side === 'diffuse' ) ] } ] : [] ) ] );
		},
		/** Samples the visible part of each light. `text` are the service's samplers. */
		shadow( brdf, text, uniforms, shapes ) {
			visible ??= target( gl, [ gl.RGBA32F, gl.RGBA32F ], size, size );
			run( once( `shadow ${ brdf } ${ shapes }`, () => program( gl, shadowShader( brdf, text, shapes ) ) ), visible, uniforms, surface() );
		},
		/** Adds the lights as the camera sees them. */
		glow( uniforms, shapes, count ) {
			const shader = once( `glow ${ shapes }`, () => program( gl, glowShader( shapes ) ) );
			add( 'glow', shader, count, { ...uniforms, sum_count: count }, [ 'sum_before' ], [ ...surface(), ...layered( 'light_pictures', 'shown' ) ] );
		},
		/** Adds an even number of samples of the reference. `first` is the number of samples so far. */
		sample( brdf, uniforms, shapes, first, samples ) {
			const shader = once( `${ brdf } ${ shapes }`, () => program( gl, referenceShader( brdf, shapes ) ) );
			add( 'truth', shader, first, { ...uniforms, first, samples }, [ 'even_before', 'odd_before' ], [ ...surface(), ...layered( 'light_pictures', 'shown' ) ] );
		},
		/** Shows both sides. */
		display( uniforms ) {
			run( once( 'display', () => program( gl, displayShader() ) ), { framebuffer: null, width: size, height: size }, uniforms, sides() );
			// Reading a pixel waits for the GPU, so that the frame time is correct.
			gl.readPixels( 0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array( 4 ) );
		},
		/** Sums over tiles for `viewer/errors.js`: of all pixels, or of those of a mesh by its number. */
		tiles( uniforms, number = - 1 ) {
			run( once( 'errors', () => program( gl, errorsShader() ) ), tiles, { ...uniforms, number }, sides() );
			const [ sums, truths ] = [ 0, 1 ].map( ( i ) => read( tiles, i, 0, 0, tiles.width, tiles.width ) );
			return { width: tiles.width, sums, truths };
		},
		/** The sums at a pixel: the left side, the right side, and both halves of the truth. Missing sums are null. */
		at( x, y ) {
			return [ [ 'left', 0 ], [ 'right', 0 ], [ 'truth', 0 ], [ 'truth', 1 ] ].map( ( [ side, i ] ) => pairs.has( side ) ? read( pairs.get( side ).at( - 1 ), i, x, y, 1, 1 ) : null );
		},
		isLost: () => gl.isContextLost(),
		release: () => gl.getExtension( 'WEBGL_lose_context' )?.loseContext(),
	};
}
