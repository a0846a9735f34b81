// A second pair of tables for dielectrics in three.js, with `WebGPURenderer`. Checked with 0.187.0.
// Fit the second table with a recipe that has "fresnel": [{"f0": 0.04}].

import { metalness, mix, texture } from 'three/tsl';

/** Lights a material with its own tables: the object that its `createLTC( THREE )` returns. */
export function bindOwnTables( material, tables ) {

	lightBy( material, tables, ( model, stock, data, own ) => stock( { ...data, ...own } ) );

}

/** Lights a material with both pairs of tables, mixed by its metalness. `tables` are for dielectrics. */
export function mixTables( material, tables ) {

	lightBy( material, tables, ( model, stock, data, own ) => {

		// three adds light to `reflectedLight`. Specular light is caught in both calls. Diffuse light and clearcoat,
		// which is a dielectric, are added in the first call alone.
		const { directSpecular, directDiffuse } = data.reflectedLight;
		const { clearcoat } = model;
		let dielectric, metal;
		stock( { ...data, ...own, reflectedLight: { directDiffuse, directSpecular: { addAssign: ( gloss ) => dielectric = gloss } } } );
		model.clearcoat = false;
		stock( { ...data, reflectedLight: { directDiffuse: { addAssign() {} }, directSpecular: { addAssign: ( gloss ) => metal = gloss } } } );
		model.clearcoat = clearcoat;
		directSpecular.addAssign( mix( dielectric, metal, metalness ) );

	} );

}

/** Replaces the function with which three lights a material by a rectangle. `light` may call the original. */
function lightBy( material, tables, light ) {

	material.setupLightingModel = function ( builder ) {

		const model = Object.getPrototypeOf( this ).setupLightingModel.call( this, builder );
		const { directRectArea } = model;
		const bits = builder.isAvailable( 'float32Filterable' ) ? 'FLOAT' : 'HALF';
		const own = { ltc_1: texture( tables[ `LTC_${ bits }_1` ] ), ltc_2: texture( tables[ `LTC_${ bits }_2` ] ) };
		model.directRectArea = ( data, builder ) => light( model, ( data ) => directRectArea.call( model, data, builder ), data, own );
		return model;

	};
	// Otherwise three reuses the shader of a similar material.
	material.customProgramCacheKey = function () {

		return `${ Object.getPrototypeOf( this ).customProgramCacheKey.call( this ) } ${ light } ${ tables.LTC_FLOAT_1.uuid }`;

	};

}
