// A second pair of tables for dielectrics in three.js, with `WebGLRenderer`. Checked with 0.187.0.
// Fit the second table with a recipe that has "fresnel": [{"f0": 0.04}].

import * as THREE from 'three';

/** Lights a material with its own tables: the object that its `createLTC( THREE )` returns. */
export function bindOwnTables( material, tables ) {

	material.onBeforeCompile = ( shader ) => {

		// three assigns the common tables later. These setters ignore them.
		shader.uniforms.ltc_1 = { get value() { return tables.LTC_FLOAT_1; }, set value( _ ) {} };
		shader.uniforms.ltc_2 = { get value() { return tables.LTC_FLOAT_2; }, set value( _ ) {} };

	};

}

/** Lights a material with both pairs of tables, mixed by its metalness. `tables` are for dielectrics. */
export function mixTables( material, tables ) {

	material.onBeforeCompile = ( shader ) => {

		shader.uniforms.ltc_1_dielectric = { value: tables.LTC_FLOAT_1 };
		shader.uniforms.ltc_2_dielectric = { value: tables.LTC_FLOAT_2 };
		let chunk = THREE.ShaderChunk.lights_physical_pars_fragment;
		const replace = ( line, by ) => {

			if ( ! chunk.includes( line ) ) throw new Error( `this three.js has no ${ line }` );
			chunk = chunk.replace( line, by );

		};
		replace( 'reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );', `
			vec4 d1 = texture2D( ltc_1_dielectric, uv );
			vec4 d2 = texture2D( ltc_2_dielectric, uv );
			mat3 dInv = mat3( vec3( d1.x, 0, d1.y ), vec3( 0, 1, 0 ), vec3( d1.z, 0, d1.w ) );
			vec3 metal = material.diffuseColor * t2.x + ( material.specularF90 - material.diffuseColor ) * t2.y;
			vec3 dielectric = material.specularColor * d2.x + ( material.specularF90 - material.specularColor ) * d2.y;
			reflectedLight.directSpecular += lightColor * mix(
				dielectric * LTC_Evaluate( normal, viewDir, position, dInv, rectCoords ),
				metal * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords ), material.metalness );` );
		// Clearcoat is a dielectric.
		replace( 'texture2D( ltc_1, uvClearcoat )', 'texture2D( ltc_1_dielectric, uvClearcoat )' );
		replace( 'texture2D( ltc_2, uvClearcoat )', 'texture2D( ltc_2_dielectric, uvClearcoat )' );
		shader.fragmentShader = shader.fragmentShader.replace( '#include <lights_physical_pars_fragment>',
			`uniform sampler2D ltc_1_dielectric;\nuniform sampler2D ltc_2_dielectric;\n${ chunk }` );

	};

}
