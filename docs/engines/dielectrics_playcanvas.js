// A second pair of tables for dielectrics in PlayCanvas, with WebGL 2. Checked with 2.23.3.
// Fit the second table with a recipe that has "fresnel": [{"f0": 0.04}].

import * as pc from 'playcanvas';

/** Makes a texture of each array of numbers. */
export function tableTextures( device, ...numbers ) {

	return numbers.map( ( numbers ) => {

		const texture = new pc.Texture( device, {
			width: 64, height: 64, format: pc.PIXELFORMAT_RGBA16F, mipmaps: false, minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_LINEAR,
			addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE,
		} );
		texture.lock().set( numbers.map( pc.FloatPacking.float2Half ) );
		texture.unlock();
		return texture;

	} );

}

/** Lights mesh instances with their own textures. */
export function bindOwnTables( meshInstances, textures ) {

	for ( const mesh of meshInstances ) textures.forEach( ( texture, i ) => mesh.setParameter( `areaLightsLutTex${ i + 1 }`, texture ) );

}
