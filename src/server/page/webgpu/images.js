// Images of materials in WebGPU, with their smaller levels.

import { filtered, sampled } from './bind.js';
import { COVERS } from './surface.js';

/** Ways to go on beyond an image, by their numbers in glTF. */
const WRAPS = { 10497: 'repeat', 33071: 'clamp-to-edge', 33648: 'mirror-repeat' };

/** What makes a level from the one above; each format needs a program of its own. */
const halved = ( format ) => `${ COVERS }
// to ${ format }
@group(0) @binding(0) var above: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;
@fragment
fn main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
	let size = max(textureDimensions(above) / 2, vec2(1u));
	return textureSampleLevel(above, linear, at.xy / vec2<f32>(size), 0.0);
}`;

/** An image, or one pixel, as a texture and its sampler. `draw` runs a program, as device.js has it. */
export function imaged( device, draw, { image, pixel, isColour, wrap } ) {

	const format = isColour ? 'rgba8unorm-srgb' : 'rgba8unorm';
	const size = image ? [ image.width, image.height ] : [ 1, 1 ];
	const mipLevelCount = 1 + Math.floor( Math.log2( Math.max( ...size ) ) );
	const texture = device.createTexture( { format, size, mipLevelCount, usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST | GPUTextureUsage.RENDER_ATTACHMENT } );
	if ( image ) device.queue.copyExternalImageToTexture( { source: image }, { texture }, size );
	else device.queue.writeTexture( { texture }, pixel, {}, size );
	const level = ( baseMipLevel ) => ( { baseMipLevel, mipLevelCount: 1 } );
	for ( let i = 1; i < mipLevelCount; i ++ ) draw( halved( format ), [ texture.createView( level( i ) ) ], [ [ filtered( texture, '2d', level( i - 1 ) ), sampled( device, 'filtering' ) ] ], { formats: [ format ] } );
	return [ filtered( texture ), sampled( device, 'filtering', wrap.map( ( way ) => WRAPS[ way ] ) ) ];

}
