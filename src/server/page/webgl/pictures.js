// Pictures on lights in WebGL 2: the passes of `ltcforge shader --as prefilter`, each as often as a picture changes.

/** What a pass writes at `texel`, by its name. `size` is that of the picture. */
const PASSES = {
	halved: 'prefilter_halved( texel, prefilter_size( size, level - 1u ), prefilter_size( size, level ) )',
	row: 'prefilter_row( texel.y, size.x )',
	mean: 'prefilter_mean( size.y )',
	level: 'prefilter_level( texel, size, level )',
};

const passShader = ( text, pass ) => `#version 300 es
${ text }
uniform int width, height, at_level;
out vec4 colour;
void main() {
	uvec2 texel = uvec2( gl_FragCoord.xy ), size = uvec2( width, height );
	uint level = uint( at_level );
	colour = vec4( ${ PASSES[ pass ] }, 1.0 );
}`;

/**
 * Textures of so many pictures of a size: `shown` are the pictures, `pyramids` their levels; both are arrays with a layer for
 * each. `program` compiles a fragment shader, `run` draws it; `text` is the service's.
 */
export function glPictures( gl, program, run, text, [ width, height ], layers ) {

	const count = 1 + Math.floor( Math.log2( Math.max( width, height ) ) );
	const sides = ( level ) => [ Math.max( width >> level, 1 ), Math.max( height >> level, 1 ) ];
	const passes = Object.fromEntries( Object.keys( PASSES ).map( ( pass ) => [ pass, program( gl, passShader( text, pass ) ) ] ) );
	const owned = [];

	function texture( target, levels, format, sides, filters ) {

		const made = gl.createTexture();
		owned.push( made );
		gl.bindTexture( target, made );
		gl[ sides.length === 3 ? 'texStorage3D' : 'texStorage2D' ]( target, levels, format, ...sides );
		[ gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER ].forEach( ( filter, i ) => gl.texParameteri( target, filter, filters[ i ] ) );
		for ( const wrap of [ gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T ] ) gl.texParameteri( target, wrap, gl.CLAMP_TO_EDGE );
		return made;

	}

	const nearest = [ gl.NEAREST, gl.NEAREST ];
	const framebuffers = [];

	/** A texture that a pass draws to. */
	function drawn( sides ) {

		const made = texture( gl.TEXTURE_2D, 1, gl.RGBA16F, sides, nearest );
		const framebuffer = gl.createFramebuffer();
		framebuffers.push( framebuffer );
		gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
		gl.framebufferTexture2D( gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, made, 0 );
		return { texture: made, framebuffer, sides };

	}

	// Level 0 of the chain is the picture.
	const picture = { texture: texture( gl.TEXTURE_2D, 1, gl.SRGB8_ALPHA8, [ width, height ], nearest ) };
	const chain = [ picture, ...Array.from( { length: Math.max( count - 2, 0 ) }, ( _, i ) => drawn( sides( i + 1 ) ) ) ];
	const rows = drawn( [ 1, height ] );
	const levels = Array.from( { length: count }, ( _, level ) => drawn( sides( level ) ) );
	const shown = texture( gl.TEXTURE_2D_ARRAY, 1, gl.SRGB8_ALPHA8, [ width, height, layers ], nearest );
	const pyramids = texture( gl.TEXTURE_2D_ARRAY, count, gl.RGBA16F, [ width, height, layers ], [ gl.LINEAR_MIPMAP_LINEAR, gl.LINEAR ] );

	function pass( name, to, level, source, above = source ) {

		gl.viewport( 0, 0, ...to.sides );
		run( passes[ name ], to, { width, height, at_level: level }, [ { name: 'prefilter_source', texture: source.texture }, { name: 'prefilter_above', texture: above.texture } ] );

	}

	return {
		shown, pyramids, layers, size: [ width, height ],
		/** What the texts of models ask of the first level. */
		base: Math.log2( Math.sqrt( width * height ) ) - 1,
		/** Prefilters the pixels of a canvas of this size as a layer; tells by how many calls. */
		update( canvas, layer ) {

			gl.bindTexture( gl.TEXTURE_2D, picture.texture );
			gl.texSubImage2D( gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, canvas );
			gl.bindTexture( gl.TEXTURE_2D_ARRAY, shown );
			gl.texSubImage3D( gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, width, height, 1, gl.RGBA, gl.UNSIGNED_BYTE, canvas );
			const last = count - 1;
			for ( let level = 1; level < last; level ++ ) pass( 'halved', chain[ level ], level, chain[ level - 1 ] );
			pass( 'row', rows, 0, picture );
			pass( 'mean', levels[ last ], last, rows );
			for ( let level = last - 1; level >= 0; level -- ) pass( 'level', levels[ level ], level, chain[ level ], levels[ level + 1 ] );
			gl.activeTexture( gl.TEXTURE0 );
			gl.bindTexture( gl.TEXTURE_2D_ARRAY, pyramids );
			levels.forEach( ( { framebuffer, sides }, level ) => {

				gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
				gl.copyTexSubImage3D( gl.TEXTURE_2D_ARRAY, level, 0, 0, layer, 0, 0, ...sides );

			} );
			gl.viewport( 0, 0, gl.canvas.width, gl.canvas.height );
			// Halvings, rows, their mean and the other levels.
			return Math.max( count - 2, 0 ) + 1 + count;

		},
		release() {

			for ( const texture of owned ) gl.deleteTexture( texture );
			for ( const framebuffer of framebuffers ) gl.deleteFramebuffer( framebuffer );
			for ( const { made } of Object.values( passes ) ) gl.deleteProgram( made );

		},
	};

}
