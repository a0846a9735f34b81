// WebGL 2: what a pixel shows, the light of models there, the sum of the reference's samples, and the picture of them.

import { modelShader, picturesOf } from './models.js';
import { glPictures } from './pictures.js';
import { referenceShader } from './reference.js';
import { DISPLAY_SHADER, MESH_VERTEX, meshShader, SURFACE_SHADER, VERTEX } from './surface.js';

/** Textures of a pixel, as the programs that read them call them. */
const SEEN = [ 'seen_place', 'seen_tangent', 'seen_normal', 'seen_f0' ];

/** A program with what sets its uniforms, by their names without `[0]`. */
function program( gl, fragment, vertex = VERTEX ) {

	const made = gl.createProgram();
	for ( const [ type, text ] of [ [ gl.VERTEX_SHADER, vertex ], [ gl.FRAGMENT_SHADER, fragment ] ] ) {

		const shader = gl.createShader( type );
		gl.shaderSource( shader, text );
		gl.compileShader( shader );
		if ( ! gl.getShaderParameter( shader, gl.COMPILE_STATUS ) ) throw new Error( gl.getShaderInfoLog( shader ) || 'the context was lost' );
		gl.attachShader( made, shader );

	}

	gl.linkProgram( made );
	if ( ! gl.getProgramParameter( made, gl.LINK_STATUS ) ) throw new Error( gl.getProgramInfoLog( made ) || 'the context was lost' );
	const setters = { [ gl.FLOAT ]: 'uniform1fv', [ gl.FLOAT_VEC3 ]: 'uniform3fv', [ gl.FLOAT_VEC4 ]: 'uniform4fv', [ gl.INT ]: 'uniform1iv', [ gl.UNSIGNED_INT_VEC4 ]: 'uniform4uiv' };
	const uniforms = new Map();
	for ( let i = 0; i < gl.getProgramParameter( made, gl.ACTIVE_UNIFORMS ); i ++ ) {

		const { name, type } = gl.getActiveUniform( made, i );
		// What has no setter here is a sampler.
		uniforms.set( name.replace( '[0]', '' ), { at: gl.getUniformLocation( made, name ), setter: setters[ type ] || 'uniform1iv' } );

	}

	return { made, uniforms };

}

/** A texture of a model: of a table a volume of 32-bit numbers that the shader interpolates, of engines' one that the sampler does. */
function uploaded( gl, { name, width, height, depth, numbers, halves } ) {

	const [ target, filter, texture ] = [ halves ? gl.TEXTURE_2D : gl.TEXTURE_3D, halves ? gl.LINEAR : gl.NEAREST, gl.createTexture() ];
	gl.bindTexture( target, texture );
	if ( halves ) gl.texImage2D( target, 0, gl.RGBA16F, width, height, 0, gl.RGBA, gl.HALF_FLOAT, halves );
	else gl.texImage3D( target, 0, gl.RGBA32F, width, height, depth, 0, gl.RGBA, gl.FLOAT, numbers );
	for ( const parameter of [ gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER ] ) gl.texParameteri( target, parameter, filter );
	for ( const parameter of [ gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T ] ) gl.texParameteri( target, parameter, gl.CLAMP_TO_EDGE );
	return { name, target, texture };

}

/** An image on the graphics card with its smaller levels, or one pixel. */
function imaged( gl, { image, pixel, isColour, wrap } ) {

	const [ texture, format ] = [ gl.createTexture(), isColour ? gl.SRGB8_ALPHA8 : gl.RGBA8 ];
	gl.bindTexture( gl.TEXTURE_2D, texture );
	if ( image ) gl.texImage2D( gl.TEXTURE_2D, 0, format, gl.RGBA, gl.UNSIGNED_BYTE, image );
	else gl.texImage2D( gl.TEXTURE_2D, 0, format, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixel );
	gl.generateMipmap( gl.TEXTURE_2D );
	[ gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T ].forEach( ( parameter, i ) => gl.texParameteri( gl.TEXTURE_2D, parameter, wrap[ i ] ) );
	gl.texParameteri( gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR );
	return texture;

}

/** The corners of a mesh on the graphics card: place, normal, tangent with its side, and the place in textures where there are some. */
function buffered( gl, numbers, uv ) {

	const array = gl.createVertexArray();
	gl.bindVertexArray( array );
	gl.bindBuffer( gl.ARRAY_BUFFER, gl.createBuffer() );
	gl.bufferData( gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW );
	[ [ 3, 0 ], [ 3, 12 ], [ 4, 24 ] ].forEach( ( [ width, offset ], i ) => {

		gl.enableVertexAttribArray( i );
		gl.vertexAttribPointer( i, width, gl.FLOAT, false, 40, offset );

	} );
	if ( uv ) {

		gl.bindBuffer( gl.ARRAY_BUFFER, gl.createBuffer() );
		gl.bufferData( gl.ARRAY_BUFFER, uv, gl.STATIC_DRAW );
		gl.enableVertexAttribArray( 3 );
		gl.vertexAttribPointer( 3, 2, gl.FLOAT, false, 0, 0 );

	}

	return array;

}

/** What draws scenes on a canvas. Models are those of `viewer/models.js`. */
export function device( canvas ) {

	const gl = canvas.getContext( 'webgl2', { alpha: false, antialias: false, preserveDrawingBuffer: true } );
	if ( ! gl ) throw new Error( 'this browser has no WebGL 2' );
	if ( ! gl.getExtension( 'EXT_color_buffer_float' ) ) throw new Error( 'this graphics card does not draw 32-bit numbers' );

	/** Textures to draw to, and the framebuffer that has them. */
	function target( formats ) {

		const framebuffer = gl.createFramebuffer();
		gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
		const textures = formats.map( ( format, i ) => {

			const texture = gl.createTexture();
			gl.bindTexture( gl.TEXTURE_2D, texture );
			gl.texStorage2D( gl.TEXTURE_2D, 1, format, canvas.width, canvas.height );
			for ( const filter of [ gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER ] ) gl.texParameteri( gl.TEXTURE_2D, filter, gl.NEAREST );
			gl.framebufferTexture2D( gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0 );
			return texture;

		} );
		gl.drawBuffers( formats.map( ( _, i ) => gl.COLOR_ATTACHMENT0 + i ) );
		return { framebuffer, textures };

	}

	const seen = target( SEEN.map( () => gl.RGBA32F ) );
	const depth = gl.createRenderbuffer();
	gl.bindRenderbuffer( gl.RENDERBUFFER, depth );
	gl.renderbufferStorage( gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, canvas.width, canvas.height );
	gl.framebufferRenderbuffer( gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth );
	const [ left, right, ...sums ] = Array.from( { length: 4 }, () => target( [ gl.RGBA32F ] ) );
	const [ surface, display ] = [ program( gl, SURFACE_SHADER ), program( gl, DISPLAY_SHADER ) ];
	const programs = new Map();
	const textures = new Map();
	/** The vertices of a mesh, and those of no mesh. */
	const vertices = new Map();
	const none = gl.createVertexArray();
	gl.bindVertexArray( none );
	gl.viewport( 0, 0, canvas.width, canvas.height );

	/** A program that is compiled when it is first asked for. */
	function known( key, make, vertex ) {

		if ( ! programs.has( key ) ) programs.set( key, program( gl, make(), vertex ) );
		return programs.get( key );

	}

	/** Runs a program over the picture, or over the triangles of so many corners. */
	function run( { made, uniforms }, to, values, bound, corners = 3 ) {

		gl.useProgram( made );
		gl.bindFramebuffer( gl.FRAMEBUFFER, to && to.framebuffer );
		const set = ( name, value ) => {

			const found = uniforms.get( name );
			if ( found ) gl[ found.setter ]( found.at, [ value ].flat( 2 ) );

		};

		bound.forEach( ( { name, target = gl.TEXTURE_2D, texture }, i ) => {

			gl.activeTexture( gl.TEXTURE0 + i );
			gl.bindTexture( target, texture );
			set( name, i );

		} );
		for ( const [ name, value ] of Object.entries( values ) ) set( name, value );
		gl.drawArrays( gl.TRIANGLES, 0, corners );

	}

	/** The pictures on lights, where there are any. */
	let pictures = null;
	const array = ( name, texture ) => ( { name, target: gl.TEXTURE_2D_ARRAY, texture } );
	const pixel = () => SEEN.map( ( name, i ) => ( { name, texture: seen.textures[ i ] } ) );

	return {
		/** Of the texts that it takes. */
		language: 'glsl',
		/** Finds what each pixel shows of a sphere or floor. */
		see( uniforms ) {

			run( surface, seen, uniforms, [] );

		},
		/** Finds what each pixel shows of meshes, each with its numbers of ten a corner, the uniforms of its material, and maybe textures. */
		seeMeshes( uniforms, meshes ) {

			gl.bindFramebuffer( gl.FRAMEBUFFER, seen.framebuffer );
			SEEN.forEach( ( _, i ) => gl.clearBufferfv( gl.COLOR, i, [ 0, 0, 0, 0 ] ) );
			gl.clear( gl.DEPTH_BUFFER_BIT );
			gl.enable( gl.DEPTH_TEST );
			for ( const { numbers, uv, textures: images, ofMaterial } of meshes ) {

				const shader = known( images ? 'textured mesh' : 'mesh', () => meshShader( Boolean( images ) ), MESH_VERTEX );
				const bound = Object.entries( images || {} ).map( ( [ name, image ] ) => {

					if ( ! textures.has( image ) ) textures.set( image, imaged( gl, image ) );
					return { name, texture: textures.get( image ) };

				} );
				if ( ! vertices.has( numbers ) ) vertices.set( numbers, buffered( gl, numbers, uv ) );
				gl.bindVertexArray( vertices.get( numbers ) );
				run( shader, seen, { ...uniforms, ...ofMaterial }, bound, numbers.length / 10 );

			}

			gl.disable( gl.DEPTH_TEST );
			gl.bindVertexArray( none );

		},
		/** Prefilters pictures on lights, canvases of one size, by the service's text; tells by how many calls. */
		picture( layers, text ) {

			const size = layers.length ? [ layers[ 0 ].width, layers[ 0 ].height ] : [];
			if ( pictures && ( pictures.layers !== layers.length || String( pictures.size ) !== String( size ) ) ) {

				pictures.release();
				pictures = null;

			}

			if ( ! layers.length ) return 0;
			pictures ||= glPictures( gl, program, run, text, size, layers.length );
			return layers.reduce( ( calls, canvas, layer ) => calls + pictures.update( canvas, layer ), 0 );

		},
		/** Lights it by a model, on the left or the right side; `shapes` has a bit for each shape of the lights. */
		light( side, model, uniforms, shapes ) {

			if ( ! textures.has( model.textures ) ) textures.set( model.textures, model.textures.map( ( texture ) => uploaded( gl, texture ) ) );
			const ofLights = pictures ? [ array( picturesOf( model.kind ), pictures.pyramids ) ] : [];
			const shader = known( `${ model.kind } ${ shapes } ${ model.text }`, () => modelShader( model.kind, model.text, shapes ) );
			run( shader, side === 'left' ? left : right, { ...uniforms, ...model.uniforms, ...( pictures && { picture_base: pictures.base } ) }, [ ...pixel(), ...textures.get( model.textures ), ...ofLights ] );

		},
		/** Adds samples of a scattering model to the sum, of which `first` is the number before. */
		sample( brdf, uniforms, shapes, first, samples ) {

			run( known( `${ brdf } ${ shapes }`, () => referenceShader( brdf, shapes ) ), sums[ 1 ], { ...uniforms, first, samples }, [ ...pixel(), { name: 'reference_sum', texture: sums[ 0 ].textures[ 0 ] }, ...( pictures ? [ array( 'light_pictures', pictures.shown ) ] : [] ) ] );
			sums.reverse();

		},
		/** Shows both sides; the right one is a model's, or the reference of so many samples. */
		display( uniforms, samples ) {

			const other = samples === null ? right : sums[ 0 ];
			run( display, null, { ...uniforms, left_weight: 1, right_weight: 1 / Math.max( samples ?? 1, 1 ) }, [ ...pixel(), { name: 'left_radiance', texture: left.textures[ 0 ] }, { name: 'right_radiance', texture: other.textures[ 0 ] } ] );

		},
		/** Waits until all is drawn, so that the time of a frame is that of its drawing. */
		done() {

			gl.readPixels( 0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array( 4 ) );

		},
		/** Whether the context is lost, so that nothing is drawn until it is restored. */
		isLost: () => gl.isContextLost(),
		release() {

			gl.getExtension( 'WEBGL_lose_context' )?.loseContext();

		},
	};

}
