// Textures, buffers and samplers of WebGPU as they are bound, each with what its layout says of it.

const FRAGMENT = 2;

/** A texture that is read by texels alone. */
export const read = ( texture, dimension = '2d' ) => ( { resource: texture.createView( { dimension } ), texture: { sampleType: 'unfilterable-float', viewDimension: dimension } } );

/** A texture that a sampler interpolates, or the levels of it that are told. */
export const filtered = ( texture, dimension = '2d', levels = {} ) => ( { resource: texture.createView( { dimension, ...levels } ), texture: { sampleType: 'float', viewDimension: dimension } } );

/** A sampler: `filtering`, linear between texels and levels, or `non-filtering`; and how a texture goes on beyond its sides. */
export function sampled( device, type, [ addressModeU, addressModeV ] = [] ) {

	const filter = type === 'filtering' ? 'linear' : 'nearest';
	return { resource: device.createSampler( { minFilter: filter, magFilter: filter, mipmapFilter: filter, addressModeU, addressModeV } ), sampler: { type } };

}

/** A buffer of numbers that all stages read. */
export function numbers( device, bytes ) {

	const buffer = device.createBuffer( { size: bytes.byteLength, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST } );
	device.queue.writeBuffer( buffer, 0, bytes );
	return { resource: { buffer }, buffer: { type: 'uniform' } };

}

/** A group of these, by their bindings, and its layout; what is undefined has no binding. */
export function bound( device, items ) {

	const entries = items.flatMap( ( item, binding ) => item ? [ { binding, ...item } ] : [] );
	const layout = device.createBindGroupLayout( { entries: entries.map( ( { binding, resource, ...kind } ) => ( { binding, visibility: kind.buffer ? FRAGMENT | 1 : FRAGMENT, ...kind } ) ) } );
	return { layout, group: device.createBindGroup( { layout, entries: entries.map( ( { binding, resource } ) => ( { binding, resource } ) ) } ) };

}
