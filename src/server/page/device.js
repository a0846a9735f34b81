// WebGL 2: programs, textures of a table, and the sum of the reference's samples.

import { address, call } from './api.js';
import { displayShader, REFERENCE_SHADER, VERTEX } from './shading.js';

function program( gl, fragment ) {

	const made = gl.createProgram();
	for ( const [ type, text ] of [ [ gl.VERTEX_SHADER, VERTEX ], [ gl.FRAGMENT_SHADER, fragment ] ] ) {

		const shader = gl.createShader( type );
		gl.shaderSource( shader, text );
		gl.compileShader( shader );
		if ( ! gl.getShaderParameter( shader, gl.COMPILE_STATUS ) ) throw new Error( gl.getShaderInfoLog( shader ) || 'the context was lost' );
		gl.attachShader( made, shader );

	}

	gl.linkProgram( made );
	if ( ! gl.getProgramParameter( made, gl.LINK_STATUS ) ) throw new Error( gl.getProgramInfoLog( made ) || 'the context was lost' );
	return made;

}

async function text( path ) {

	const response = await fetch( address( path ) );
	if ( ! response.ok ) throw new Error( `${ path }: the answer was ${ response.status }` );
	return response.text();

}

/** The texels of a KTX2 file of 32-bit numbers without levels: their bytes and the extents. */
function texels( buffer ) {

	const view = new DataView( buffer );
	const word = ( at ) => view.getUint32( at, true );
	// The header is that of section 3 of the KTX 2.0 specification; format 109 is R32G32B32A32_SFLOAT.
	if ( word( 12 ) !== 109 || word( 44 ) !== 0 ) throw new Error( 'the texture is not of 32-bit numbers' );
	const [ width, height, depth ] = [ word( 20 ), word( 24 ), Math.max( word( 28 ), 1 ) ];
	return { width, height, depth, numbers: new Float32Array( buffer.slice( word( 80 ), word( 80 ) + 16 * width * height * depth ) ) };

}

/** The textures and uniforms of a table, as `ltcforge export --for wgpu` makes them. */
async function tableOf( gl, digest ) {

	const at = `/v1/tables/${ digest }/exports/wgpu`;
	const { ltc_table: uniforms, textures: files } = await call( `${ at }/ltc.json` );
	const textures = await Promise.all( files.map( async ( file ) => {

		const { width, height, depth, numbers } = texels( await ( await fetch( address( `${ at }/${ file }` ) ) ).arrayBuffer() );
		const texture = gl.createTexture();
		gl.bindTexture( gl.TEXTURE_3D, texture );
		gl.texImage3D( gl.TEXTURE_3D, 0, gl.RGBA32F, width, height, depth, 0, gl.RGBA, gl.FLOAT, numbers );
		for ( const filter of [ gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER ] ) gl.texParameteri( gl.TEXTURE_3D, filter, gl.NEAREST );
		return { name: file.replace( '.ktx2', '' ), texture };

	} ) );
	return { uniforms, textures };

}

/** What draws a scene on a canvas by a model of light; `table` and its layout, or neither for model normals. */
export async function device( canvas, table, layout ) {

	const gl = canvas.getContext( 'webgl2', { alpha: false, antialias: false, preserveDrawingBuffer: true } );
	if ( ! gl ) throw new Error( 'this browser has no WebGL 2' );
	if ( ! gl.getExtension( 'EXT_color_buffer_float' ) ) throw new Error( 'this graphics card does not draw 32-bit numbers' );
	const source = await text( table ? `/page/ltc-${ layout }.glsl` : '/page/normals.glsl' );
	const [ display, reference ] = [ program( gl, displayShader( source, Boolean( table ) ) ), program( gl, REFERENCE_SHADER ) ];
	const bound = table ? await tableOf( gl, table ) : { uniforms: {}, textures: [] };
	const sums = [ 0, 1 ].map( () => {

		const [ texture, target ] = [ gl.createTexture(), gl.createFramebuffer() ];
		gl.bindTexture( gl.TEXTURE_2D, texture );
		gl.texStorage2D( gl.TEXTURE_2D, 1, gl.RGBA32F, canvas.width, canvas.height );
		for ( const filter of [ gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER ] ) gl.texParameteri( gl.TEXTURE_2D, filter, gl.NEAREST );
		gl.bindFramebuffer( gl.FRAMEBUFFER, target );
		gl.framebufferTexture2D( gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0 );
		return { texture, target };

	} );
	gl.bindVertexArray( gl.createVertexArray() );
	gl.viewport( 0, 0, canvas.width, canvas.height );

	/** Runs a program over the picture. Whole numbers are told from others by the uniforms' own types. */
	function run( made, target, uniforms ) {

		gl.useProgram( made );
		gl.bindFramebuffer( gl.FRAMEBUFFER, target );
		gl.activeTexture( gl.TEXTURE0 );
		gl.bindTexture( gl.TEXTURE_2D, sums[ 0 ].texture );
		bound.textures.forEach( ( { name, texture }, i ) => {

			gl.activeTexture( gl.TEXTURE1 + i );
			gl.bindTexture( gl.TEXTURE_3D, texture );
			gl.uniform1i( gl.getUniformLocation( made, name ), 1 + i );

		} );
		for ( const [ member, value ] of Object.entries( bound.uniforms ) ) set( `ltc_table.${ member }`, value );
		for ( const [ name, value ] of Object.entries( uniforms ) ) set( name, value );
		function set( name, value ) {

			const at = gl.getUniformLocation( made, name );
			if ( ! at ) return;
			const numbers = [ value ].flat( 2 );
			if ( name.endsWith( '.nodes' ) || name.endsWith( '.reading' ) ) gl.uniform4uiv( at, numbers );
			else if ( [ 'size', 'surface', 'show', 'samples', 'first' ].includes( name ) ) gl.uniform1i( at, numbers[ 0 ] );
			else if ( numbers.length === 1 ) gl.uniform1f( at, numbers[ 0 ] );
			else if ( numbers.length === 4 ) gl.uniform4fv( at, numbers );
			else gl.uniform3fv( at, numbers );

		}

		gl.drawArrays( gl.TRIANGLES, 0, 3 );

	}

	return {
		/** Adds samples to the sum, of which `first` is the number before. */
		sample( uniforms, first, samples ) {

			run( reference, sums[ 1 ].target, { ...uniforms, first, samples } );
			sums.reverse();

		},
		/** Draws the scene with the reference of so many samples. */
		draw( uniforms, samples ) {

			run( display, null, { ...uniforms, samples } );
			// So that the time of a frame is that of its drawing.
			gl.readPixels( 0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array( 4 ) );

		},
		release() {

			gl.getExtension( 'WEBGL_lose_context' )?.loseContext();

		},
	};

}
