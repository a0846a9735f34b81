// Draws the scene by three.js as it is, by a table, by the closed form's three rules, and shows the truth beside them.
// ?width=96&height=64 sets the size of each picture in pixels, ?scale=2 how large a pixel is shown, ?lights=4 how many
// lights there are.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

import { loadTable, setAlphas, withClosedFormAreaLights, withTableAreaLights } from './ggx_area_light.js';
import { axesOf, camera as eye, lightsOf, surfaces } from './scene.js';
import balanced from './shaders/normals_balanced.glsl.js';
import fast from './shaders/normals_fast.glsl.js';
import fine from './shaders/normals_fine.glsl.js';
import tableGlsl from './shaders/table.glsl.js';

const query = new URLSearchParams( location.search );
const width = Number( query.get( 'width' ) || 288 );
const height = Number( query.get( 'height' ) || 216 );
const scale = Number( query.get( 'scale' ) || 1 );
const lamps = lightsOf( Number( query.get( 'lights' ) || 1 ) );

/** Turns an object so that its axes are those of a surface, and moves it there. */
function place( object, surface, turned = 1 ) {

	const [ x, y, z ] = axesOf( surface ).map( ( axis ) => new THREE.Vector3( ...axis ) );
	object.matrixAutoUpdate = false;
	object.matrix.makeBasis( x.multiplyScalar( turned ), y, z.multiplyScalar( turned ) ).setPosition( ...surface.centre );
	return object;

}

/** A surface's triangles. three finds the direction of the anisotropy in the tangents. */
function geometryOf( surface ) {

	const geometry = surface.radii
		? new THREE.RingGeometry( ...surface.radii, 512 )
		: new THREE.PlaneGeometry( ...surface.size );
	const { position } = geometry.attributes;
	const tangents = new Float32Array( position.count * 4 );
	for ( let i = 0; i < position.count; i ++ ) {

		const angle = surface.radii ? Math.atan2( position.getY( i ), position.getX( i ) ) : 0;
		tangents.set( [ Math.cos( angle ), Math.sin( angle ), 0, 1 ], 4 * i );

	}

	geometry.setAttribute( 'tangent', new THREE.BufferAttribute( tangents, 4 ) );
	return geometry;

}

/** The scene, its materials patched by `patch`. */
function sceneOf( patch ) {

	const scene = new THREE.Scene();
	for ( const surface of surfaces ) {

		// Of metal three takes f0 from the colour; plastic without diffuse light is metal of a dark colour.
		const material = new THREE.MeshPhysicalMaterial( { metalness: 1, color: new THREE.Color( ...surface.f0 ) } );
		setAlphas( material, ...surface.alpha );
		scene.add( place( new THREE.Mesh( geometryOf( surface ), patch( material ) ), surface ) );

	}

	for ( const lamp of lamps ) {

		const colour = new THREE.Color( ...lamp.radiance );
		// three's rectangular lights shine along -z.
		scene.add( place( new THREE.RectAreaLight( colour, 1, lamp.width, lamp.height ), lamp, - 1 ) );
		const glow = new THREE.MeshBasicMaterial( { color: colour } );
		scene.add( place( new THREE.Mesh( new THREE.PlaneGeometry( lamp.width, lamp.height ), glow ), lamp ) );

	}

	return scene;

}

/** A picture as numbers: linear radiance, four floats a pixel, from the top left. */
function render( renderer, scene ) {

	const camera = new THREE.PerspectiveCamera( eye.fov, width / height, 0.1, 100 );
	camera.position.set( ...eye.eye );
	camera.lookAt( ...eye.target );
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	renderer.setRenderTarget( target );
	renderer.render( scene, camera );
	const upward = new Float32Array( width * height * 4 );
	renderer.readRenderTargetPixels( target, 0, 0, width, height, upward );
	renderer.setRenderTarget( null );
	target.dispose();

	const pixels = new Float32Array( upward.length );
	for ( let row = 0; row < height; row ++ ) {

		pixels.set( upward.subarray( 4 * width * row, 4 * width * ( row + 1 ) ), 4 * width * ( height - 1 - row ) );

	}

	return pixels;

}

/** Shows radiance on a canvas: sRGB, white is 1. */
function show( name, pixels ) {

	const canvas = document.getElementById( name );
	Object.assign( canvas, { width, height } );
	Object.assign( canvas.style, { width: `${ width * scale }px`, height: `${ height * scale }px` } );
	const shown = new Uint8ClampedArray( pixels.length ).fill( 255 );
	for ( let i = 0; i < pixels.length; i ++ ) {

		if ( i % 4 === 3 ) continue;
		const x = Math.min( Math.max( pixels[ i ], 0 ), 1 );
		shown[ i ] = 255 * ( x <= 0.0031308 ? 12.92 * x : 1.055 * x ** ( 1 / 2.4 ) - 0.055 ) + 0.5;

	}

	canvas.getContext( '2d' ).putImageData( new ImageData( shown, width, height ), 0, 0 );

}

/** Mean absolute error of radiance over the surfaces. Pixels at edges are left out: another rule may give them to another surface. */
function meanError( pixels, truth ) {

	const surfaceAt = ( column, row ) => truth[ 4 * ( row * width + column ) + 3 ];
	let total = 0;
	let count = 0;
	for ( let row = 1; row < height - 1; row ++ ) {

		for ( let column = 1; column < width - 1; column ++ ) {

			const surface = surfaceAt( column, row );
			const around = [ [ 1, 0 ], [ - 1, 0 ], [ 0, 1 ], [ 0, - 1 ] ].map( ( [ x, y ] ) => surfaceAt( column + x, row + y ) );
			if ( surface < 0 || around.some( ( other ) => other !== surface ) ) continue;
			for ( let i = 4 * ( row * width + column ), end = i + 3; i < end; i ++ ) {

				total += Math.abs( pixels[ i ] - truth[ i ] );
				count ++;

			}

		}

	}

	return total / count;

}

async function fetched( address ) {

	const response = await fetch( address );
	if ( ! response.ok ) throw new Error( `${ address }: ${ await response.text() }` );
	return response;

}

const renderer = new THREE.WebGLRenderer();
const table = await loadTable( 'table/', new KTX2Loader().detectSupport( renderer ) );
// Stock three needs its own tables; ours and the closed form do not.
RectAreaLightUniformsLib.init();

const pictures = {
	stock: render( renderer, sceneOf( ( material ) => material ) ),
	table: render( renderer, sceneOf( ( material ) => withTableAreaLights( material, tableGlsl, table ) ) ),
	...Object.fromEntries( Object.entries( { fast, balanced, fine } ).map( ( [ rule, text ] ) =>
		[ rule, render( renderer, sceneOf( ( material ) => withClosedFormAreaLights( material, text ) ) ) ] ) ),
};
for ( const [ name, pixels ] of Object.entries( pictures ) ) show( name, pixels );

const caption = document.querySelector( '#truth + figcaption' );
try {

	caption.textContent = 'truth: being computed';
	const answer = await fetched( `truth?width=${ width }&height=${ height }&lights=${ lamps.length }` );
	const truth = new Float32Array( await answer.arrayBuffer() );
	show( 'truth', truth );
	caption.textContent = 'truth';
	const errors = {};
	for ( const [ name, pixels ] of Object.entries( pictures ) ) {

		errors[ name ] = meanError( pixels, truth );
		document.querySelector( `#${ name } + figcaption` ).append( `; mean error ${ errors[ name ].toPrecision( 2 ) }` );

	}

	// What a test reads.
	window.errors = errors;

} catch ( error ) {

	caption.textContent = `no truth: ${ error.message }`;
	window.errors = { failed: error.message };

}
