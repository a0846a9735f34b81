// Pictures of the scene of examples/three under a light with a picture, as linear radiance from the top left.

import * as THREE from 'three';
import { fromTop } from '/common/pixels.js';
import { camera as eye, lightsOf } from '/common/scene.js';
import { LightPictures, withClosedFormAreaLights, withPictureAreaLights } from '/three/ggx_area_light.js';
import { litScene } from '/three/lit_scene.js';
import { drawScreen, height as texelsDown, width as texelsAlong } from '/three/screen.js';
import balanced from '/three/shaders/normals_balanced.glsl.js';
import textured from '/three/shaders/normals_textured.glsl.js';
import prefilter from '/three/shaders/prefilter.glsl.js';
import { refusal } from './refusal.js';

/** The contents of the light: the example's drawing and the second of the video, by name. */
const SHOWN = { colour: [ 'colour', 0 ], picture: [ 'picture', 0 ], start: [ 'video', 0 ], later: [ 'video', 1.2 ] };

/** A video of a canvas, as a texture that has its first frame. */
async function playing( canvas ) {

	const video = Object.assign( document.createElement( 'video' ), { srcObject: canvas.captureStream(), muted: true } );
	const frame = new Promise( ( done ) => video.requestVideoFrameCallback( done ) );
	await video.play();
	await frame;
	const texture = new THREE.VideoTexture( video );
	texture.colorSpace = THREE.SRGBColorSpace;
	texture.needsUpdate = true;
	return texture;

}

/** Textures that show a canvas upright in three.js, by kind. */
async function kindsOf( canvas, renderer ) {

	const { width, height } = canvas;
	const { data } = canvas.getContext( '2d' ).getImageData( 0, 0, width, height );
	const fromBottom = new Uint8Array( fromTop( data, width, height ) );
	const drawn = new THREE.CanvasTexture( canvas );
	const bitmap = new THREE.Texture( await createImageBitmap( canvas, { imageOrientation: 'flipY' } ) );
	const kinds = {
		'canvas from the top': Object.assign( new THREE.CanvasTexture( canvas ), { flipY: false } ),
		bitmap,
		data: new THREE.DataTexture( fromBottom, width, height ),
		'data from the top': Object.assign( new THREE.DataTexture( new Uint8Array( data ), width, height ), { flipY: true } ),
	};
	for ( const texture of [ drawn, ...Object.values( kinds ) ] ) Object.assign( texture, { colorSpace: THREE.SRGBColorSpace, needsUpdate: true } );

	// A screen in the scene: the canvas on a plane that fills the target.
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.HalfFloatType } );
	renderer.setRenderTarget( target );
	renderer.render( new THREE.Mesh( new THREE.PlaneGeometry( 2, 2 ), new THREE.MeshBasicMaterial( { map: drawn } ) ), new THREE.OrthographicCamera( - 1, 1, 1, - 1, - 1, 1 ) );
	const copy = Object.assign( new THREE.FramebufferTexture( width, height ), { type: THREE.HalfFloatType } );
	renderer.copyFramebufferToTexture( copy );
	renderer.setRenderTarget( null );
	return { ...kinds, 'render target': target.texture, framebuffer: copy };

}

export async function draw( width, height ) {

	const renderer = new THREE.WebGLRenderer( { canvas: document.createElement( 'canvas' ) } );
	const camera = new THREE.PerspectiveCamera( eye.fov, width / height, 0.1, 100 );
	camera.position.set( ...eye.eye );
	camera.lookAt( ...eye.target );
	const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
	const render = ( scene ) => {

		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const pixels = new Float32Array( width * height * 4 );
		renderer.readRenderTargetPixels( target, 0, 0, width, height, pixels );
		return Array.from( fromTop( pixels, width, height ) );

	};

	const canvas = Object.assign( document.createElement( 'canvas' ), { width: texelsAlong, height: texelsDown } );
	const texture = new THREE.CanvasTexture( canvas );
	texture.colorSpace = THREE.SRGBColorSpace;
	const pictures = new LightPictures( prefilter, texelsAlong, texelsDown );
	const patched = ( material ) => withPictureAreaLights( material, textured, pictures );
	const scene = litScene( lightsOf( 1 ), patched );
	const drawn = {};
	const pngs = {};
	for ( const [ name, shown ] of Object.entries( SHOWN ) ) {

		drawScreen( canvas.getContext( '2d' ), ...shown );
		texture.needsUpdate = true;
		pictures.update( renderer, texture );
		drawn[ name ] = render( scene );
		pngs[ name ] = canvas.toDataURL( 'image/png' );

	}

	drawScreen( canvas.getContext( '2d' ), ...SHOWN.picture );
	const kinds = {};
	for ( const [ kind, shown ] of Object.entries( await kindsOf( canvas, renderer ) ) ) {

		pictures.update( renderer, shown );
		kinds[ kind ] = render( scene );

	}

	const filled = ( colour, layers, layer ) => {

		canvas.getContext( '2d' ).fillStyle = colour;
		canvas.getContext( '2d' ).fillRect( 0, 0, texelsAlong, texelsDown );
		texture.needsUpdate = true;
		layers.update( renderer, texture, layer );

	};
	const plain = ( lamps ) => render( litScene( lamps, ( material ) => withClosedFormAreaLights( material, balanced ) ) );
	filled( '#ffffff', pictures );
	drawn.plain = plain( lightsOf( 1 ) );
	drawn.white = render( scene );
	// The first of two lights is black. The second has no picture, or a white picture.
	filled( '#000000', pictures );
	drawn.second = render( litScene( lightsOf( 2 ), patched ) );
	const both = new LightPictures( prefilter, texelsAlong, texelsDown, 2 );
	filled( '#000000', both, 0 );
	filled( '#ffffff', both, 1 );
	drawn.layer = render( litScene( lightsOf( 2 ), ( material ) => withPictureAreaLights( material, textured, both ) ) );
	both.dispose();
	drawn.plainSecond = plain( lightsOf( 2 ).slice( 1 ) );

	drawScreen( canvas.getContext( '2d' ), ...SHOWN.picture );
	const video = await playing( canvas );
	pictures.update( renderer, video );
	drawn.stream = render( scene );

	const metal = () => new THREE.MeshPhysicalMaterial( { metalness: 1 } );
	const refusals = {
		text: refusal( () => withPictureAreaLights( metal(), balanced, pictures ) ),
		pictures: refusal( () => withPictureAreaLights( metal(), textured, {} ) ),
		prefilter: refusal( () => new LightPictures( textured, 4, 4 ) ),
		size: refusal( () => new LightPictures( prefilter, 0, 4.5 ) ),
		layer: refusal( () => pictures.update( renderer, texture, 1 ) ),
		texture: refusal( () => pictures.update( renderer, canvas ) ),
	};
	pictures.dispose();
	return { drawn, kinds, pngs, refusals };

}
