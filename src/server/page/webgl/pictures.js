// Prefilters pictures on lights with the passes of `ltcforge shader --as prefilter`, each time a picture changes.

import { program, release, target, texture } from './context.js';

/** The expression of each pass for the colour at `texel`. `size` is the size of the picture. */
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
 * The textures for `layers` pictures of the same size. `shown` contains the pictures, and `pyramids` contains their prefiltered
 * levels. Both are arrays with a layer per picture. `run` draws a program. `text` is the shader text of the service.
 */
export function pictures( gl, run, text, width, height, layers ) {
	const last = Math.floor( Math.log2( Math.max( width, height ) ) );
	const levelTarget = ( level ) => target( gl, [ gl.RGBA16F ], Math.max( width >> level, 1 ), Math.max( height >> level, 1 ) );
	const passes = Object.fromEntries( Object.keys( PASSES ).map( ( pass ) => [ pass, program( gl, passShader( text, pass ) ) ] ) );
	const array = ( levels, format, ...filters ) => texture( gl, gl.TEXTURE_2D_ARRAY, () => gl.texStorage3D( gl.TEXTURE_2D_ARRAY, levels, format, width, height, layers ), ...filters );
	const picture = texture( gl, gl.TEXTURE_2D, () => gl.texStorage2D( gl.TEXTURE_2D, 1, gl.SRGB8_ALPHA8, width, height ) );
	// Level 0 is the picture itself.
	const chain = Array.from( { length: Math.max( last - 1, 0 ) }, ( _, i ) => levelTarget( i + 1 ) );
	const levels = Array.from( { length: last + 1 }, ( _, level ) => levelTarget( level ) );
	const rows = target( gl, [ gl.RGBA16F ], 1, height );
	const shown = array( 1, gl.SRGB8_ALPHA8 );
	const pyramids = array( last + 1, gl.RGBA16F, gl.LINEAR_MIPMAP_LINEAR, gl.LINEAR );
	const halved = ( level ) => level ? chain[ level - 1 ].textures[ 0 ] : picture;

	function pass( name, to, level, source, above = source ) {
		run( passes[ name ], to, { width, height, at_level: level }, [ { name: 'prefilter_source', texture: source }, { name: 'prefilter_above', texture: above } ] );
	}
	return {
		shown, pyramids,
		/** The argument `base` of the models' shaders: log2 of the geometric mean of both sides, minus 1. */
		base: Math.log2( Math.sqrt( width * height ) ) - 1,
		/** Prefilters a canvas of the pictures' size into a layer. Returns the number of draw calls. */
		update( canvas, layer ) {
			gl.bindTexture( gl.TEXTURE_2D, picture );
			gl.texSubImage2D( gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, canvas );
			gl.bindTexture( gl.TEXTURE_2D_ARRAY, shown );
			gl.texSubImage3D( gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, width, height, 1, gl.RGBA, gl.UNSIGNED_BYTE, canvas );
			chain.forEach( ( to, i ) => pass( 'halved', to, i + 1, halved( i ) ) );
			pass( 'row', rows, 0, picture );
			pass( 'mean', levels[ last ], last, rows.textures[ 0 ] );
			for ( let level = last - 1; level >= 0; level -- ) pass( 'level', levels[ level ], level, halved( level ), levels[ level + 1 ].textures[ 0 ] );
			gl.bindTexture( gl.TEXTURE_2D_ARRAY, pyramids );
			levels.forEach( ( { framebuffer, width, height }, level ) => {
				gl.bindFramebuffer( gl.FRAMEBUFFER, framebuffer );
				gl.copyTexSubImage3D( gl.TEXTURE_2D_ARRAY, level, 0, 0, layer, 0, 0, width, height );
			} );
			return chain.length + levels.length + 1;
		},
		release() {
			for ( const one of [ ...chain, ...levels, rows ] ) release( gl, one );
			for ( const made of [ picture, shown, pyramids ] ) gl.deleteTexture( made );
			for ( const { made } of Object.values( passes ) ) gl.deleteProgram( made );
		},
	};
}
