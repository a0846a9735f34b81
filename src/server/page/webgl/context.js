// Creates programs, textures and framebuffers of WebGL 2.

/** Draws one triangle that covers the image. */
const VERTEX = `#version 300 es
void main() {
	gl_Position = vec4( gl_VertexID == 1 ? 3.0 : - 1.0, gl_VertexID == 2 ? 3.0 : - 1.0, 0.0, 1.0 );
}`;

/** Compiles a program. Returns it with a setter for each uniform. Names of arrays have no `[0]`. */
export function program( gl, fragment, vertex = VERTEX ) {
	const made = gl.createProgram();
	for ( const [ type, text ] of [ [ gl.VERTEX_SHADER, vertex ], [ gl.FRAGMENT_SHADER, fragment ] ] ) {
		const shader = gl.createShader( type );
		gl.shaderSource( shader, text );
		gl.compileShader( shader );
		if ( ! gl.getShaderParameter( shader, gl.COMPILE_STATUS ) ) throw new Error( gl.getShaderInfoLog( shader ) || 'the WebGL context was lost' );
		gl.attachShader( made, shader );
	}
	gl.linkProgram( made );
	if ( ! gl.getProgramParameter( made, gl.LINK_STATUS ) ) throw new Error( gl.getProgramInfoLog( made ) || 'the WebGL context was lost' );
	// Other types are integers or samplers.
	const setters = { [ gl.FLOAT ]: 'uniform1fv', [ gl.FLOAT_VEC2 ]: 'uniform2fv', [ gl.FLOAT_VEC3 ]: 'uniform3fv', [ gl.FLOAT_VEC4 ]: 'uniform4fv', [ gl.UNSIGNED_INT_VEC4 ]: 'uniform4uiv' };
	const uniforms = new Map();
	for ( let i = 0; i < gl.getProgramParameter( made, gl.ACTIVE_UNIFORMS ); i ++ ) {
		const { name, type } = gl.getActiveUniform( made, i );
		const [ at, setter ] = [ gl.getUniformLocation( made, name ), setters[ type ] || 'uniform1iv' ];
		uniforms.set( name.replace( '[0]', '' ), ( value ) => gl[ setter ]( at, [ value ].flat( 2 ) ) );
	}
	return { made, uniforms };
}

/** Creates a texture. `fill` allocates it while it is bound. */
export function texture( gl, target, fill, min = gl.NEAREST, mag = min, wrap = [ gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE ] ) {
	const made = gl.createTexture();
	gl.bindTexture( target, made );
	fill();
	gl.texParameteri( target, gl.TEXTURE_MIN_FILTER, min );
	gl.texParameteri( target, gl.TEXTURE_MAG_FILTER, mag );
	gl.texParameteri( target, gl.TEXTURE_WRAP_S, wrap[ 0 ] );
	gl.texParameteri( target, gl.TEXTURE_WRAP_T, wrap[ 1 ] );
	return made;
}

/** Creates a framebuffer with a texture for each format. */
export function target( gl, formats, width, height ) {
	const framebuffer = gl.createFramebuffer();
	gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
	const textures = formats.map( ( format, i ) => {
		const made = texture( gl, gl.TEXTURE_2D, () => gl.texStorage2D( gl.TEXTURE_2D, 1, format, width, height ) );
		gl.framebufferTexture2D( gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, made, 0 );
		return made;
	} );
	gl.drawBuffers( formats.map( ( _, i ) => gl.COLOR_ATTACHMENT0 + i ) );
	return { framebuffer, textures, width, height };
}

/** Deletes a target. */
export function release( gl, made ) {
	if ( ! made ) return;
	gl.deleteFramebuffer( made.framebuffer );
	made.textures.forEach( ( one ) => gl.deleteTexture( one ) );
}
