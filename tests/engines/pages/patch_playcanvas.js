// Tests the effect of the package of examples/playcanvas on materials: pictures of two surfaces under two lights, and
// errors for invalid inputs.

import * as pc from 'playcanvas';
import { fromTop } from '/examples/common/pixels.js';
import { lightsOf, surfaces } from '/examples/common/scene.js';
import { application, litScene, render } from '/examples/playcanvas/lit_scene.js';
import { setAlphas, withClosedFormAreaLights, withoutAreaLights } from '/package/ggx_area_light.js';
import balanced from '/package/shaders/normals_balanced.glsl.js';
import fast from '/package/shaders/normals_fast.glsl.js';
import { refusal } from './refusal.js';

const width = 48, height = 36;
const lamps = lightsOf( 2 );
const TABLE = 'https://raw.githubusercontent.com/playcanvas/engine/main/examples/assets/json/area-light-luts.json';

export async function draw() {

	const table = await ( await fetch( TABLE ) ).json();
	const lit = ( isClustered ) => {

		const app = application( isClustered );
		app.setAreaLightLuts( table.LTC_MAT_1, table.LTC_MAT_2 );
		return app;

	};
	let app = lit( true );

	const pictures = {};
	const drawn = async ( name, scene ) => pictures[ name ] = [ ...fromTop( await render( app, scene, width, height ), width, height ) ];
	const shown = surfaces.slice( 0, 2 );
	const closed = ( material, text = balanced ) => withClosedFormAreaLights( material, text, app.graphicsDevice );
	const changed = ( material, properties ) => {

		Object.assign( material, properties ).update();
		return material;

	};
	const coated = { diffuse: pc.Color.BLACK, clearCoat: 1, clearCoatGloss: 0.6 };
	const round = { diffuse: pc.Color.WHITE, gloss: 0.6, anisotropyIntensity: 0 };

	const ways = {
		stock: ( material ) => material,
		ours: closed,
		'another rule': ( material ) => closed( material, fast ),
		'patched again': ( material ) => closed( closed( material, fast ) ),
		clone: ( material ) => closed( material ).clone(),
		'clone of the clone': ( material ) => closed( material ).clone().clone(),
		'patch taken off': ( material ) => withoutAreaLights( closed( material ) ),
		'clone of the undone': ( material ) => withoutAreaLights( closed( material ) ).clone(),
		'undone clone': ( material ) => withoutAreaLights( closed( material ).clone() ),
		black: ( material ) => closed( changed( material, { diffuse: pc.Color.BLACK } ) ),
		'coat on black': ( material ) => closed( changed( material, coated ) ),
		'white metal': ( material ) => closed( changed( material, round ) ),
	};
	const drawWays = async ( those, more = '' ) => {

		for ( const [ name, patch ] of Object.entries( those ) ) {

			const scene = litScene( app, lamps, patch, shown );
			await drawn( `${ name }${ more }`, scene );
			scene.destroy();

		}

	};
	await drawWays( ways );

	const materialsOf = ( scene ) => shown.map( ( _, i ) => scene.children[ i ].render.meshInstances[ 0 ].material );
	const later = litScene( app, lamps, ways.stock, shown );
	await drawn( 'before the patch', later );
	materialsOf( later ).forEach( ( material ) => closed( material ) );
	await drawn( 'patched after a draw', later );
	materialsOf( later ).forEach( withoutAreaLights );
	await drawn( 'undone', later );
	later.destroy();

	const moved = litScene( app, lamps, closed, shown );
	const lights = moved.find( ( { name } ) => name === 'light' );
	lights.forEach( ( light ) => light.translate( 1, 0, 0 ) );
	await drawn( 'elsewhere', moved );
	lights.forEach( ( light, i ) => light.setPosition( ...lamps[ i ].centre ) );
	await drawn( 'moved', moved );
	moved.destroy();

	// PlayCanvas itself must light other shapes, also together with rectangles.
	for ( const [ name, patch ] of [ [ 'stock, disk', ways.stock ], [ 'disk', closed ] ] ) {

		const scene = litScene( app, lamps, patch, shown );
		scene.find( ( { name } ) => name === 'light' ).forEach( ( { light } ) => light.shape = pc.LIGHTSHAPE_DISK );
		await drawn( name, scene );
		scene.destroy();

	}

	// Only one application can exist at a time.
	app.destroy();
	app = lit( false );
	await drawWays( ways, ', unclustered' );
	// A coat with reflectance one adds the light of white metal. Lamps and the sky are the same in all pictures.
	const coats = [ '', ', unclustered' ].map( ( more ) => {

		const [ bare, under ] = [ pictures[ `black${ more }` ], pictures[ `coat on black${ more }` ] ];
		const white = pictures[ `white metal${ more }` ];
		return Math.max( ...white.map( ( value, i ) => value === bare[ i ] ? 0 : Math.abs( under[ i ] - bare[ i ] - value ) ) );

	} );

	const fresh = () => new pc.StandardMaterial();
	const own = fresh();
	own.getShaderChunks().set( 'ltcPS', '// the user\'s' );
	const refusals = {
		shader: refusal( () => closed( new pc.ShaderMaterial() ) ),
		nothing: refusal( () => closed( undefined ) ),
		text: refusal( () => closed( fresh(), 'void main() {}' ) ),
		device: refusal( () => withClosedFormAreaLights( fresh(), balanced ) ),
		webgpu: refusal( () => withClosedFormAreaLights( fresh(), balanced, { isWebGPU: true, isWebGL2: false } ) ),
		chunk: refusal( () => closed( own ) ),
		alpha: refusal( () => setAlphas( fresh(), 0, 1.5 ) ),
	};
	const chunks = pc.ShaderChunks.get( app.graphicsDevice, pc.SHADERLANGUAGE_GLSL );
	const clustered = chunks.get( 'clusteredLightPS' );
	chunks.set( 'clusteredLightPS', clustered.replace( 'getRectLightSpecular(worldNormal', 'getRectLightSpecular(normal' ) );
	const untouched = fresh();
	refusals.version = refusal( () => closed( untouched ) );
	chunks.set( 'clusteredLightPS', clustered );
	const leavesRefused = untouched.getShaderChunks().size === 0;
	const leavesOwn = withoutAreaLights( own ).getShaderChunks().get( 'ltcPS' ) === '// the user\'s';
	return { pictures, refusals, coats, leavesRefused, leavesOwn };

}
