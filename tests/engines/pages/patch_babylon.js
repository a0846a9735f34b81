// Tests the effect of the package of examples/babylon on materials: pictures of two surfaces under two lights, and
// errors for invalid inputs.

import { fromTop } from '/examples/common/pixels.js';
import { lightsOf, surfaces } from '/examples/common/scene.js';
import { areaLightsPlugin, setAlphas, withClosedFormAreaLights, withoutAreaLights } from '/package/ggx_area_light.js';
import { ENGINE_LINES } from '/package/patches.js';
import balanced from '/package/shaders/normals_balanced.glsl.js';
import fast from '/package/shaders/normals_fast.glsl.js';
import { library } from './babylon.js';
import { refusal } from './refusal.js';

const width = 48, height = 36;
const lamps = lightsOf( 2 );

export async function draw() {

	globalThis.BABYLON = await library();
	const { litScene, render, tableOf } = await import( '/examples/babylon/lit_scene.js' );
	const canvas = () => Object.assign( document.createElement( 'canvas' ), { width, height } );
	const engine = new BABYLON.Engine( canvas(), false );
	const closed = ( material, text = balanced ) => withClosedFormAreaLights( material, text, BABYLON );

	const pictures = {};
	const drawn = async ( name, scene ) => pictures[ name ] = [ ...fromTop( await render( scene, width, height ), width, height ) ];
	const sceneOf = async ( patch, options, by = engine ) => {

		const scene = litScene( by, lamps, patch, surfaces.slice( 0, 2 ), options );
		await tableOf( scene );
		return scene;

	};
	/** Draws a scene with the materials of `patch`, and again after `change`. Only the second picture is kept. */
	const both = async ( name, patch, change ) => {

		const scene = await sceneOf( patch );
		await drawn( name, scene );
		await change( scene );
		await drawn( name, scene );
		scene.dispose();

	};
	const materialsOf = ( scene ) => scene.materials.filter( ( { name } ) => name === 'metal' );

	// Materials of equal scenes, one after another. Babylon could confuse their shaders.
	const ways = {
		stock: ( material ) => material,
		ours: closed,
		'another rule': ( material ) => closed( material, fast ),
		'patched again': ( material ) => closed( closed( material, fast ) ),
		clone: ( material ) => closed( material ).clone( 'clone' ),
		'clone of the clone': ( material ) => closed( material ).clone( 'clone' ).clone( 'clone' ),
		'from a file': ( material ) => BABYLON.Material.Parse( JSON.parse( JSON.stringify( closed( material ).serialize() ) ), material.getScene(), '' ),
		'simple class': ( material ) => closed( simpleOf( material ) ),
		'clone of the undone': ( material ) => withoutAreaLights( closed( material ) ).clone( 'clone' ),
	};
	for ( const [ name, patch ] of Object.entries( ways ) ) {

		const scene = await sceneOf( patch );
		await drawn( name, scene );
		scene.dispose();

	}

	const withoutBuffers = new BABYLON.Engine( canvas(), false );
	withoutBuffers.disableUniformBuffers = true;
	await drawn( 'without uniform buffers', await sceneOf( closed, {}, withoutBuffers ) );
	withoutBuffers.dispose();

	await both( 'patched after a draw', ( material ) => material, ( scene ) => materialsOf( scene ).forEach( ( material ) => closed( material ) ) );
	await both( 'undone', closed, ( scene ) => materialsOf( scene ).forEach( withoutAreaLights ) );
	const moved = await sceneOf( closed );
	const holders = moved.transformNodes.map( ( { position } ) => [ position, position.clone() ] );
	for ( const [ position ] of holders ) position.x += 1;
	await drawn( 'elsewhere', moved );
	for ( const [ position, was ] of holders ) position.copyFrom( was );
	await drawn( 'moved', moved );
	moved.dispose();

	// Babylon itself must light a light that has a picture.
	for ( const [ name, patch ] of [ [ 'stock, light with a picture', ways.stock ], [ 'light with a picture', closed ] ] ) {

		const scene = await sceneOf( patch );
		const picture = BABYLON.RawTexture.CreateRGBATexture( new Uint8Array( 4 * 16 ).fill( 200 ), 4, 4, scene, false );
		for ( const light of scene.lights ) light.emissionTexture = picture;
		await drawn( name, scene );
		scene.dispose();

	}

	// The same numbers in a left-handed scene give the mirrored picture.
	const left = await sceneOf( closed, { rightHanded: false } );
	const mirrored = await drawn( 'left-handed', left );
	pictures[ 'left-handed' ] = mirrored.map( ( _, i ) => mirrored[ 4 * ( Math.floor( i / 4 / width ) * width + width - 1 - Math.floor( i / 4 ) % width ) + i % 4 ] );
	left.dispose();

	const scene = new BABYLON.Scene( engine );
	const fresh = ( Material = BABYLON.PBRMaterial ) => new Material( 'fresh', scene );
	const old = new BABYLON.Engine( canvas(), false, { disableWebGL2Support: true } );
	const refusals = {
		standard: refusal( () => closed( fresh( BABYLON.StandardMaterial ) ) ),
		openpbr: refusal( () => closed( Object.create( BABYLON.OpenPBRMaterial.prototype ) ) ),
		nothing: refusal( () => closed( undefined ) ),
		text: refusal( () => closed( fresh(), 'void main() {}' ) ),
		'text from a file': refusal( () => new ( areaLightsPlugin( BABYLON ) )( fresh() ).parse( { normalsGlsl: 'void main() {}' } ) ),
		webgpu: refusal( () => closed( Object.create( fresh(), { shaderLanguage: { value: BABYLON.ShaderLanguage.WGSL } } ) ) ),
		'webgl 1': refusal( () => closed( new BABYLON.PBRMaterial( 'old', new BABYLON.Scene( old ) ) ) ),
		alpha: refusal( () => setAlphas( fresh(), 0, 1.5 ) ),
	};
	old.dispose();

	// Another version of Babylon has other lines. The error comes when the material is patched, or at the first frame. It names the
	// include and the version for each line.
	const store = BABYLON.ShaderStore.IncludesShadersStore;
	const late = closed( fresh() ).pluginManager.getPlugin( 'LtcforgeAreaLights' );
	const changed = ( work ) => Object.entries( ENGINE_LINES ).flatMap( ( [ include, lines ] ) => lines.map( ( line ) => {

		const text = store[ include ];
		store[ include ] = text.replace( line, '' );
		const message = refusal( work );
		store[ include ] = text;
		return String( message ).includes( `${ include } of Babylon.js ${ BABYLON.Engine.Version } must contain \`${ line }\`` ) ? message : null;

	} ) ).reduce( ( all, message ) => all && message );
	refusals.version = changed( () => closed( fresh() ) );
	refusals[ 'version at the first frame' ] = changed( () => late.getCustomCode( 'fragment' ) );
	engine.dispose();
	return { pictures, refusals };

}

/** A simpler material of Babylon with the same light as this material. */
function simpleOf( material ) {

	const simple = new BABYLON.PBRMetallicRoughnessMaterial( 'metal', material.getScene() );
	simple.baseColor = material.albedoColor;
	simple.metallic = 1;
	simple.roughness = material.roughness;
	simple.maxSimultaneousLights = material.maxSimultaneousLights;
	simple.brdf.useEnergyConservation = false;
	simple._directIntensity = material.directIntensity;
	material.anisotropy.copyTo( simple.anisotropy );
	return simple;

}
