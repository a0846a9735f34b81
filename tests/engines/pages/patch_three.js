// Tests the effect of the patch of examples/three on materials: pictures of white metal under clearcoat, and errors for
// invalid inputs.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { loadTable, setAlphas, withClosedFormAreaLights, withoutAreaLights, withTableAreaLights } from '/example/ggx_area_light.js';
import balanced from '/example/shaders/normals_balanced.glsl.js';
import fast from '/example/shaders/normals_fast.glsl.js';
import tableGlsl from '/example/shaders/table.glsl.js';
import { refusal } from './refusal.js';
import { coated, height, light, redFromTop, table as floorOf, views, width } from '/world.js';

/** A hook that makes a material `by` times as bright. All hooks have the same source text. */
const brighter = ( by ) => ( shader ) => {

	shader.fragmentShader = shader.fragmentShader.replace( '#include <opaque_fragment>', `outgoingLight *= ${ by.toFixed( 1 ) };\n#include <opaque_fragment>` );

};

export async function draw() {

	RectAreaLightUniformsLib.init();
	const renderer = new THREE.WebGLRenderer( { canvas: document.createElement( 'canvas' ) } );
	const stored = await loadTable( '/example/table/', new KTX2Loader().detectSupport( renderer ) );
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	const camera = new THREE.PerspectiveCamera( views[ 1 ].fov, width / height, 0.1, 100 );
	camera.position.set( ...views[ 1 ].eye );
	camera.lookAt( ...views[ 1 ].target );
	const scene = new THREE.Scene();
	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 2 * floorOf.halfX, 2 * floorOf.halfZ ) );
	floor.rotation.x = - Math.PI / 2;
	const lamp = new THREE.RectAreaLight( 0xffffff, 1, light.width, light.height );
	const [ x, y, z ] = light.axes.map( ( axis ) => new THREE.Vector3( ...axis ) );
	lamp.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	lamp.position.set( ...light.centre );
	scene.add( floor, lamp );

	const pictures = {};
	const drawn = ( name, material ) => {

		floor.material = material;
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const pixels = new Float32Array( 4 * width * height );
		renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
		pictures[ name ] = redFromTop( pixels );

	};
	const fresh = () => new THREE.MeshPhysicalMaterial( { metalness: 1, roughness: coated.roughness, clearcoat: 1, clearcoatRoughness: coated.clearcoatRoughness } );

	drawn( 'stock', fresh() );
	const ours = withClosedFormAreaLights( fresh(), balanced );
	drawn( 'ours', ours );
	drawn( 'clone', ours.clone() );
	drawn( 'clone of the clone', ours.clone().clone() );
	drawn( 'another rule', withClosedFormAreaLights( fresh(), fast ) );
	drawn( 'by a table', withTableAreaLights( fresh(), tableGlsl, stored ) );
	drawn( 'patched again', withClosedFormAreaLights( withTableAreaLights( fresh(), tableGlsl, stored ), balanced ) );

	// Hooks of the user: set before the patch, set after it, and set after it with a call to the previous hook.
	const before = fresh();
	before.onBeforeCompile = brighter( 2 );
	before.customProgramCacheKey = () => 'twice';
	drawn( 'twice, hook before', withClosedFormAreaLights( before, balanced ) );
	const after = withClosedFormAreaLights( fresh(), balanced );
	drawn( 'without a hook', after );
	after.onBeforeCompile = brighter( 2 );
	after.customProgramCacheKey = () => 'twice';
	after.needsUpdate = true;
	drawn( 'twice, hook after', after );
	const chained = after.onBeforeCompile;
	const key = after.customProgramCacheKey;
	after.onBeforeCompile = function ( shader, ...others ) {

		chained.call( this, shader, ...others );
		brighter( 2 )( shader );

	};
	after.customProgramCacheKey = () => `${ key.call( after ) } and twice`;
	after.needsUpdate = true;
	drawn( 'four times', after );
	// If the user sets no key, hooks are distinguished by their source text, as in three.js.
	const keys = [ ( shader ) => shader.one = 1, ( shader ) => shader.two = 2 ].map( ( hook ) => {

		const material = withClosedFormAreaLights( fresh(), balanced );
		material.onBeforeCompile = hook;
		return material.customProgramCacheKey();

	} );

	const undone = withoutAreaLights( ours );
	drawn( 'undone', undone );
	const ownHook = brighter( 2 );
	before.onBeforeCompile = ownHook;
	withoutAreaLights( before );
	const leavesHooks = before.onBeforeCompile === ownHook && before.customProgramCacheKey() === 'twice' && ! Object.hasOwn( undone, 'clone' );

	const expanded = withClosedFormAreaLights( fresh(), balanced );
	expanded.onBeforeCompile = ( shader ) => shader.fragmentShader = shader.fragmentShader.replace( '#include <lights_fragment_begin>', '' );
	const chunk = THREE.ShaderChunk.lights_fragment_begin;
	const refusals = {
		basic: refusal( () => withClosedFormAreaLights( new THREE.MeshBasicMaterial(), balanced ) ),
		nothing: refusal( () => withClosedFormAreaLights( undefined, balanced ) ),
		node: refusal( () => withClosedFormAreaLights( { isNodeMaterial: true, type: 'MeshPhysicalNodeMaterial' }, balanced ) ),
		text: refusal( () => withClosedFormAreaLights( fresh(), 'void main() {}' ) ),
		'text of the other': refusal( () => withTableAreaLights( fresh(), balanced, stored ) ),
		table: refusal( () => withTableAreaLights( fresh(), tableGlsl, {} ) ),
		'chunk removed by a hook': refusal( () => expanded.onBeforeCompile( { uniforms: {}, fragmentShader: '#include <lights_physical_pars_fragment>\n#include <lights_fragment_begin>' } ) ),
		alpha: refusal( () => setAlphas( fresh(), 0, 1.5 ) ),
		anisotropy: refusal( () => setAlphas( new THREE.MeshStandardMaterial(), 0.1, 0.2 ) ),
	};
	THREE.ShaderChunk.lights_fragment_begin = chunk.replace( 'rectAreaLights[ i ]', 'rectAreaLights[ 0 ]' );
	refusals.version = refusal( () => withClosedFormAreaLights( fresh(), balanced ) );
	THREE.ShaderChunk.lights_fragment_begin = chunk;
	stored.dispose();
	return { pictures, refusals, keysDiffer: keys[ 0 ] !== keys[ 1 ], leavesHooks };

}
