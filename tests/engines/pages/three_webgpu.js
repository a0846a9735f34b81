// three.js by WebGPURenderer, which falls back on WebGL 2 where there is no WebGPU. The rest is as in three.js.

import * as THREE from 'three/webgpu';
import { metalness, mix, texture } from 'three/tsl';
import { RectAreaLightTexturesLib } from 'three/addons/lights/RectAreaLightTexturesLib.js';

import { height, light, pictures, redFromTop, table, width } from '/world.js';

/** As in three.js. */
export async function draw( tables, dielectric, isMixed ) {

	const load = async ( folder ) => ( await import( `${ folder }/ltc.js` ) ).createLTC( THREE );
	THREE.RectAreaLightNode.setLTC( tables ? await load( tables ) : RectAreaLightTexturesLib.init() );
	const renderer = new THREE.WebGPURenderer( { canvas: document.createElement( 'canvas' ) } );
	await renderer.init();
	const isWebGPU = renderer.backend.isWebGPUBackend === true;

	const plastic = new THREE.MeshStandardMaterial( { color: 0x000000 } );
	const metal = new THREE.MeshStandardMaterial( { metalness: 1 } );
	if ( dielectric ) ( isMixed ? mixTables : bindOwnTables )( isMixed ? metal : plastic, await load( dielectric ) );

	const scene = new THREE.Scene();
	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 2 * table.halfX, 2 * table.halfZ ), metal );
	floor.rotation.x = - Math.PI / 2;
	const lamp = new THREE.RectAreaLight( 0xffffff, 1, light.width, light.height );
	// It shines along -z.
	const [ x, y, z ] = light.axes.map( ( axis ) => new THREE.Vector3( ...axis ) );
	lamp.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	lamp.position.set( ...light.centre );
	scene.add( floor, lamp );

	const target = new THREE.RenderTarget( width, height, { type: THREE.FloatType } );
	const drawn = [];
	for ( const { f0, roughness, view } of pictures ) {

		// three's plastic has an f0 of 0.04.
		const isPlastic = f0 === 0.04;
		floor.material = isPlastic && ! isMixed ? plastic : metal;
		metal.color.setScalar( isPlastic ? 0 : f0 );
		metal.metalness = isPlastic ? 0 : 1;
		floor.material.roughness = roughness;
		const camera = new THREE.PerspectiveCamera( view.fov, width / height, 0.1, 100 );
		camera.position.set( ...view.eye );
		camera.lookAt( ...view.target );
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const read = new Float32Array( ( await renderer.readRenderTargetPixelsAsync( target, 0, 0, width, height ) ).buffer );
		// WebGPU begins at the top, and its rows are multiples of 256 bytes.
		const stride = isWebGPU ? Math.ceil( 16 * width / 256 ) * 64 : 4 * width;
		drawn.push( isWebGPU ? Array.from( { length: width * height }, ( _, i ) => read[ Math.floor( i / width ) * stride + 4 * ( i % width ) ] ) : redFromTop( read ) );

	}

	renderer.dispose();
	return drawn;

}

/** Lights a material by tables of its own; the same function stands in docs/engines.md. */
function bindOwnTables( material, tables ) {

	lightBy( material, tables, ( model, stock, data, own ) => stock( { ...data, ...own } ) );

}

/** Adds tables for dielectrics to a material and mixes both by its metalness; the same function stands in docs/engines.md. */
function mixTables( material, tables ) {

	lightBy( material, tables, ( model, stock, data, own ) => {

		// three adds to these: gloss is caught both times; diffuse light and clearcoat, a dielectric, are added once.
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

/** Has `light` called in place of three's lighting of a material by a rectangle; the same function stands in docs/engines.md. */
function lightBy( material, tables, light ) {

	material.setupLightingModel = function ( builder ) {

		const model = Object.getPrototypeOf( this ).setupLightingModel.call( this, builder );
		const { directRectArea } = model;
		const bits = builder.isAvailable( 'float32Filterable' ) ? 'FLOAT' : 'HALF';
		const own = { ltc_1: texture( tables[ `LTC_${ bits }_1` ] ), ltc_2: texture( tables[ `LTC_${ bits }_2` ] ) };
		model.directRectArea = ( data, builder ) => light( model, ( data ) => directRectArea.call( model, data, builder ), data, own );
		return model;

	};
	// Else three takes the shader of a material that looks the same.
	material.customProgramCacheKey = function () {

		return `${ Object.getPrototypeOf( this ).customProgramCacheKey.call( this ) } ${ light } ${ tables.LTC_FLOAT_1.uuid }`;

	};

}
