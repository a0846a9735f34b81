// Closed forms for WebGPURenderer of three.js: for its node materials, and for MeshStandardMaterial and
// MeshPhysicalMaterial, which the renderer converts to node materials. Diffuse light does not change.

import { array, Loop, wgsl, wgslFn, glsl, glslFn, anisotropyT, alphaT, clearcoatNormalView, clearcoatRoughness, float, normalView, positionView, positionViewDirection, roughness, specularColorBlended, specularF90, vec2, vec3 } from 'three/tsl';

export { setAlphas } from './alphas.js';

/** For each model: the type of a lobe, the expression that makes it, and the two parts of the light of `corners`. */
const MODELS = {
	normals: {
		type: 'NormalsView',
		make: 'normals_view(alphas.x, alphas.y, wo)',
		parts: 'normals_rectangle(lobe, corners, false)',
	},
	formula: {
		type: 'LtcFormula',
		make: 'ltc_formula(alphas.x, alphas.y, wo, fresnel.x, fresnel.y)',
		parts: 'vec2(lobe.amplitude, lobe.fresnel) * ltc_rectangle(lobe.inverse, corners, false)',
	},
};

/**
 * For each language, the functions after the text of the closed form, for a lobe with a name. Values that are the same for all
 * lights are in a variable of the module, because three declares a function's variables before our types. `begin` sets it. It
 * returns a number, because three's functions must return a value. three's corners run counterclockwise as seen from the side
 * that emits.
 */
const WGSL = {
	kept: ( name, { type } ) => /* wgsl */ `
struct Lobe_${ name } { to_tangent_frame: mat3x3<f32>, lobe: ${ type } }
var<private> lobe_${ name }: Lobe_${ name };
`,
	begin: ( name, { make } ) => /* wgsl */ `
fn begin_${ name }(normal: vec3<f32>, view_dir: vec3<f32>, along: vec3<f32>, alphas: vec2<f32>, fresnel: vec2<f32>) -> f32 {
	let tangent = normalize(along - normal * dot(normal, along));
	let to_tangent_frame = transpose(mat3x3(tangent, cross(normal, tangent), normal));
	let seen = to_tangent_frame * view_dir;
	let wo = normalize(vec3(seen.xy, max(seen.z, 1e-3)));
	lobe_${ name } = Lobe_${ name }(to_tangent_frame, ${ make });
	return 0.0;
}`,
	gloss: ( name, { parts } ) => /* wgsl */ `
fn gloss_${ name }(f0: vec3<f32>, f90: f32, centre: vec3<f32>, half_width: vec3<f32>, half_height: vec3<f32>) -> vec3<f32> {
	let c = lobe_${ name }.to_tangent_frame * centre;
	let x = lobe_${ name }.to_tangent_frame * half_width;
	let y = lobe_${ name }.to_tangent_frame * half_height;
	let lobe = lobe_${ name }.lobe;
	let corners = array(c + x + y, c - x + y, c - x - y, c + x - y);
	let parts = ${ parts };
	return f0 * (parts.x - parts.y) + f90 * parts.y;
}`,
};
const GLSL = {
	kept: ( name, { type } ) => /* glsl */ `
struct Lobe_${ name } { mat3 to_tangent_frame; ${ type } lobe; };
Lobe_${ name } lobe_${ name };
`,
	begin: ( name, { make } ) => /* glsl */ `
float begin_${ name }(vec3 normal, vec3 view_dir, vec3 along, vec2 alphas, vec2 fresnel) {
	vec3 tangent = normalize(along - normal * dot(normal, along));
	mat3 to_tangent_frame = transpose(mat3(tangent, cross(normal, tangent), normal));
	vec3 seen = to_tangent_frame * view_dir;
	vec3 wo = normalize(vec3(seen.xy, max(seen.z, 1e-3)));
	lobe_${ name } = Lobe_${ name }(to_tangent_frame, ${ make });
	return 0.0;
}`,
	gloss: ( name, { type, parts } ) => /* glsl */ `
vec3 gloss_${ name }(vec3 f0, float f90, vec3 centre, vec3 half_width, vec3 half_height) {
	vec3 c = lobe_${ name }.to_tangent_frame * centre;
	vec3 x = lobe_${ name }.to_tangent_frame * half_width;
	vec3 y = lobe_${ name }.to_tangent_frame * half_height;
	${ type } lobe = lobe_${ name }.lobe;
	vec3[4] corners = vec3[4](c + x + y, c - x + y, c - x - y, c + x - y);
	vec2 parts = ${ parts };
	return f0 * (parts.x - parts.y) + f90 * parts.y;
}`,
};

/** The data of each patched material: its own properties with these names, before the patch. */
const patches = new WeakMap();
const OWN = [ 'setupLightingModel', 'customProgramCacheKey', 'clone' ];

/**
 * Lights a material's gloss and clearcoat by three's rectangular lights, in closed form.
 *
 * @param {import('three').MeshStandardMaterial | import('three/webgpu').MeshStandardNodeMaterial} material - The material, which
 * is patched in place.
 * @param {{ wgsl: string, glsl?: string }} texts - The output of `ltcforge shader` for `--model normals` or `--model ltc-formula`
 * in WGSL, and in GLSL ES for WebGPURenderer's fallback on WebGL 2.
 * @returns {Object} The material.
 */
export function withClosedFormAreaLights( material, texts ) {

	if ( ! material || ! ( material.isMeshStandardMaterial || material.isMeshStandardNodeMaterial ) ) {

		throw new TypeError( `${ material && material.type || material } has no GGX lobe: MeshStandardMaterial, MeshPhysicalMaterial and their node materials have one` );

	}

	const name = String( texts?.wgsl ).includes( 'fn ltc_formula(' ) ? 'ltc_formula' : 'normals_rectangle';
	const model = name === 'ltc_formula' ? 'ltc-formula' : 'normals';
	if ( ! texts || ! String( texts.wgsl ).includes( `fn ${ name }(` ) ) throw new TypeError( 'texts.wgsl must be the output of `ltcforge shader --language wgsl`, with `--model normals` or `--model ltc-formula`' );
	if ( texts.glsl !== undefined && ! String( texts.glsl ).includes( `${ name === 'ltc_formula' ? 'LtcFormula' : 'vec2' } ${ name }(` ) ) throw new TypeError( `texts.glsl must be the output of \`ltcforge shader --model ${ model } --language glsl-es\`` );
	withoutAreaLights( material );
	const own = Object.fromEntries( OWN.filter( ( name ) => Object.hasOwn( material, name ) ).map( ( name ) => [ name, material[ name ] ] ) );
	patches.set( material, own );
	const before = ( name, object ) => own[ name ] || Object.getPrototypeOf( object )[ name ];

	// WebGPURenderer copies this property to the node material that it makes, whose class has the method that is called.
	Object.defineProperty( material, 'setupLightingModel', { configurable: true, enumerable: true, writable: true, value( builder ) {

		return lit( before( 'setupLightingModel', this ).call( this, builder ), texts );

	} } );
	Object.defineProperty( material, 'customProgramCacheKey', { configurable: true, writable: true, value() {

		return `${ texts.wgsl }\n${ before( 'customProgramCacheKey', this ).call( this ) }`;

	} } );
	Object.defineProperty( material, 'clone', { configurable: true, writable: true, value() {

		return withClosedFormAreaLights( before( 'clone', this ).call( this ), texts );

	} } );
	material.needsUpdate = true;
	return material;

}

/**
 * Removes the patch from a material. An unpatched material does not change.
 *
 * @returns {Object} The material. It is compiled again at its next use.
 */
export function withoutAreaLights( material ) {

	const own = patches.get( material );
	if ( ! own ) return material;
	patches.delete( material );
	for ( const name of OWN ) delete material[ name ];
	Object.assign( material, own );
	material.needsUpdate = true;
	return material;

}

/** A physical lighting model that lights gloss and clearcoat with our functions. */
function lit( model, texts ) {

	if ( typeof model.directRectArea !== 'function' || typeof model.start !== 'function' ) throw new Error( 'this version of three.js has another lighting model; this patch is for r187' );
	const stock = { start: model.start, directRectArea: model.directRectArea };
	const gloss = {};

	model.start = function ( builder ) {

		const isWebGPU = builder.renderer.backend.isWebGPUBackend === true;
		if ( ! isWebGPU && ! texts.glsl ) throw new Error( 'WebGPURenderer uses WebGL 2 here, which needs texts.glsl' );
		const [ code, fn, own ] = isWebGPU ? [ wgsl, wgslFn, WGSL ] : [ glsl, glslFn, GLSL ];
		const text = code( isWebGPU ? texts.wgsl : texts.glsl );
		const form = MODELS[ texts.wgsl.includes( 'fn ltc_formula(' ) ? 'formula' : 'normals' ];

		// This runs once a fragment, before the lights.
		const begin = ( name, normal, along, alphas, f0, f90 ) => {

			const kept = code( own.kept( name, form ), [ text ] );
			fn( own.begin( name, form ), [ kept ] )( normal, positionViewDirection, along, alphas, vec2( f0, f90 ) ).toVar();
			gloss[ name ] = fn( own.gloss( name, form ), [ kept ] );

		};
		const anyTangent = ( normal ) => normal.x.abs().lessThan( 0.9 ).select( vec3( 1, 0, 0 ), vec3( 0, 1, 0 ) );
		const alpha = roughness.pow2();
		const base = [ specularColorBlended.dot( vec3( 1 / 3 ) ), specularF90 ];
		if ( this.anisotropy ) begin( 'base', normalView, anisotropyT, vec2( alphaT.max( alpha ), alpha ), ...base );
		else begin( 'base', normalView, anyTangent( normalView ), vec2( alpha, alpha ), ...base );
		if ( this.clearcoat ) begin( 'coat', clearcoatNormalView, anyTangent( clearcoatNormalView ), vec2( clearcoatRoughness.pow2() ), 0.04, 1 );
		// This calls the lights, which are only collected. three writes the code of each light one after another. Here a loop runs
		// over several lights, so drivers compile it once. One light compiles faster without a loop.
		const areas = [];
		this.directRectArea = ( data ) => areas.push( data );
		stock.start.call( this, builder );
		if ( areas.length < 2 ) return areas.forEach( ( data ) => light.call( this, data, builder ) );
		// three sets these to zero where they occur first, which must be before the loop.
		for ( const sum of [ 'directDiffuse', 'directSpecular' ] ) areas[ 0 ].reflectedLight[ sum ].toStack();
		const arrays = [ 'lightColor', 'lightPosition', 'halfWidth', 'halfHeight' ].map( ( name ) => [ name, array( areas.map( ( data ) => vec3( data[ name ] ) ) ).toVar() ] );
		Loop( areas.length, ( { i } ) => {

			const its = Object.fromEntries( arrays.map( ( [ name, values ] ) => [ name, values.element( i ) ] ) );
			light.call( this, { ...areas[ 0 ], ...its }, builder );

		} );

	};

	/** Adds an area light. */
	function light( data, builder ) {

		const { lightColor, lightPosition, halfWidth, halfHeight, reflectedLight } = data;
		const centre = lightPosition.sub( positionView );
		const seen = ( name, f0, f90 ) => lightColor.mul( gloss[ name ]( f0, f90, centre, halfWidth, halfHeight ) );
		reflectedLight.directSpecular.addAssign( seen( 'base', specularColorBlended, specularF90 ) );
		const { clearcoat } = this;
		if ( clearcoat ) this.clearcoatSpecularDirect.addAssign( seen( 'coat', vec3( 0.04 ), float( 1 ) ) );

		// three's method adds diffuse light and gloss. The gloss is discarded.
		this.clearcoat = false;
		const diffuse = { ...reflectedLight, directSpecular: { addAssign() {} } };
		stock.directRectArea.call( this, { ...data, reflectedLight: diffuse }, builder );
		this.clearcoat = clearcoat;

	}

	return model;

}
