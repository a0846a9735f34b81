// What draws the viewer's scene on a canvas: WebGPU where a GPU has it, else WebGL 2. Both draw the same.

import { device } from '../webgl/device.js';

/** Names of what draws, by the language of its shaders. */
export const DRAWN_BY = { glsl: 'WebGL 2', wgsl: 'WebGPU' };

/**
 * The device that a choice of the scene stands for; an error tells why there is none. `failed` is called with what goes wrong
 * with WebGPU later.
 */
export async function deviceFor( choice, canvas, failed ) {

	if ( choice === 'webgl2' ) return device( canvas );
	if ( choice === 'automatic' ) {

		const adapter = await navigator.gpu?.requestAdapter().catch( () => null );
		// Of a processor that stands for a GPU, WebGL 2 is faster.
		if ( ! adapter || ( adapter.info?.isFallbackAdapter ?? adapter.isFallbackAdapter ) ) return device( canvas );

	}

	try {

		const { gpuDevice } = await import( '../webgpu/device.js' );
		return await gpuDevice( canvas, failed );

	} catch ( error ) {

		if ( choice === 'webgpu' ) throw error;
		return device( canvas );

	}

}
