// Pictures on lights in WebGPU: the passes of `ltcforge shader --as prefilter`, each as often as a picture changes.

import { bound, numbers, read } from './bind.js';

/** What a pass writes at `texel`, by its name. `size` is that of the picture. */
const PASSES = {
	halved: 'prefilter_halved(texel, prefilter_size(pass_of.size, pass_of.level - 1u), prefilter_size(pass_of.size, pass_of.level))',
	row: 'prefilter_row(texel.y, pass_of.size.x)',
	mean: 'prefilter_mean(pass_of.size.y)',
	level: 'prefilter_level(texel, pass_of.size, pass_of.level)',
};

const passShader = ( text, covers, pass ) => `${ text }${ covers }
struct Pass {
	size: vec2<u32>,
	level: u32,
}
@group(1) @binding(0) var<uniform> pass_of: Pass;
@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
	let texel = vec2<u32>(position.xy);
	return vec4(${ PASSES[ pass ] }, 1.0);
}`;

/**
 * Textures of so many pictures of a size: `shown` are the pictures, `pyramids` their levels; both are arrays with a layer for
 * each. `draw` runs a program, as device.js has it; `text` is the service's.
 */
export function gpuPictures( device, draw, covers, text, [ width, height ], layers ) {

	const count = 1 + Math.floor( Math.log2( Math.max( width, height ) ) );
	const sides = ( level ) => [ Math.max( width >> level, 1 ), Math.max( height >> level, 1 ) ];
	const owned = [];

	function texture( format, size, usage, mipLevelCount = 1 ) {

		const made = device.createTexture( { format, size, mipLevelCount, usage: GPUTextureUsage.TEXTURE_BINDING | usage } );
		owned.push( made );
		return made;

	}

	const drawn = ( size ) => texture( 'rgba16float', size, GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC );
	// Canvases are copied to textures that could be drawn to.
	const copied = GPUTextureUsage.COPY_DST | GPUTextureUsage.RENDER_ATTACHMENT;
	const picture = texture( 'rgba8unorm-srgb', [ width, height ], copied );
	const chain = [ picture, ...Array.from( { length: Math.max( count - 2, 0 ) }, ( _, i ) => drawn( sides( i + 1 ) ) ) ];
	const rows = drawn( [ 1, height ] );
	const levels = Array.from( { length: count }, ( _, level ) => drawn( sides( level ) ) );
	const shown = texture( 'rgba8unorm-srgb', [ width, height, layers ], copied );
	const pyramids = texture( 'rgba16float', [ width, height, layers ], GPUTextureUsage.COPY_DST, count );

	function pass( name, to, level, source, above = source ) {

		const size = numbers( device, new Uint32Array( [ width, height, level, 0 ] ) );
		draw( passShader( text, covers, name ), [ to ], [ [ read( source ), read( above ) ], [ size ] ], { formats: [ 'rgba16float' ] } );
		size.resource.buffer.destroy();

	}

	return {
		shown, pyramids, layers, size: [ width, height ],
		/** What the texts of models ask of the first level. */
		base: Math.log2( Math.sqrt( width * height ) ) - 1,
		/** Prefilters the pixels of a canvas of this size as a layer; tells by how many calls. */
		update( canvas, layer ) {

			device.queue.copyExternalImageToTexture( { source: canvas }, { texture: picture }, [ width, height ] );
			device.queue.copyExternalImageToTexture( { source: canvas }, { texture: shown, origin: [ 0, 0, layer ] }, [ width, height ] );
			const last = count - 1;
			for ( let level = 1; level < last; level ++ ) pass( 'halved', chain[ level ], level, chain[ level - 1 ] );
			pass( 'row', rows, 0, picture );
			pass( 'mean', levels[ last ], last, rows );
			for ( let level = last - 1; level >= 0; level -- ) pass( 'level', levels[ level ], level, chain[ level ], levels[ level + 1 ] );
			const encoder = device.createCommandEncoder();
			levels.forEach( ( texture, mipLevel ) => encoder.copyTextureToTexture( { texture }, { texture: pyramids, mipLevel, origin: [ 0, 0, layer ] }, sides( mipLevel ) ) );
			device.queue.submit( [ encoder.finish() ] );
			return Math.max( count - 2, 0 ) + 1 + count;

		},
		release() {

			for ( const texture of owned ) texture.destroy();

		},
	};

}
