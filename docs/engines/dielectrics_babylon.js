// A second pair of tables for dielectrics in Babylon.js, with WebGL 2. Checked with 9.34.0 and 9.35.0.
// Fit the second table with a recipe that has "fresnel": [{"f0": 0.04}].

/** Loads an `areaLightsLTC.bin` as two textures. */
export async function loadTables( address, scene ) {

	const halves = new Uint16Array( await BABYLON.Tools.LoadFileAsync( address ) );
	return [ 0, 4 ].map( ( first ) => BABYLON.RawTexture.CreateRGBATexture(
		Uint16Array.from( { length: halves.length / 2 }, ( _, i ) => halves[ 8 * ( i >> 2 ) + first + i % 4 ] ), 64, 64, scene,
		false, false, BABYLON.Texture.LINEAR_LINEAR, BABYLON.Constants.TEXTURETYPE_HALF_FLOAT ) );

}

/** Lights a material with its own textures. */
export function bindOwnTables( material, textures ) {

	// Babylon has bound the tables of the scene before, with each light.
	material.onBindObservable.add( () => textures.forEach( ( texture, i ) =>
		material.getEffect().setTexture( `areaLightsLTC${ i + 1 }Sampler`, texture ) ) );

}
