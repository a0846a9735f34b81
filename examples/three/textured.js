// A light with a picture or a video over brushed metal. It is prefiltered when it changes. ?width=960&height=640 sets the size.

import * as THREE from 'three';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';

import { lightsOf } from '../common/scene.js';
import { LightPictures, withPictureAreaLights } from './ggx_area_light.js';
import { litScene } from './lit_scene.js';
import { drawScreen, height, width } from './screen.js';
import prefilter from './shaders/prefilter.glsl.js';
import textured from './shaders/normals_textured.glsl.js';

RectAreaLightUniformsLib.init();
const renderer = new THREE.WebGLRenderer( { antialias: true } );
const query = new URLSearchParams( location.search );
const sides = [ [ 'width', 960 ], [ 'height', 640 ] ].map( ( [ name, usual ] ) => Number( query.get( name ) || usual ) );
renderer.setSize( ...sides );
document.querySelector( 'main' ).append( renderer.domElement );
// The camera is lower than in the comparison, so that the light is visible.
const camera = new THREE.PerspectiveCamera( 42, sides[ 0 ] / sides[ 1 ], 0.1, 100 );
camera.position.set( 0, 1.5, 3.6 );
camera.lookAt( 0, 0.35, - 0.6 );

const canvas = Object.assign( document.createElement( 'canvas' ), { width, height } );
const drawn = new THREE.CanvasTexture( canvas );
drawn.colorSpace = THREE.SRGBColorSpace;
const pictures = new LightPictures( prefilter, width, height );
const scene = litScene( lightsOf( 1 ), ( material ) => withPictureAreaLights( material, textured, pictures ), { picture: drawn } );
const lamp = scene.children.find( ( { material } ) => material && material.isMeshBasicMaterial ).material;

const show = document.querySelector( '#show' );
const file = document.querySelector( '#file' );
const message = document.querySelector( '#message' );
/** The shown file, and whether the light must be prefiltered. */
let opened = null;
let isNew = true;

/** Shows a texture instead of the current one. */
function showTexture( texture ) {

	if ( opened ) {

		if ( opened.isVideoTexture ) opened.image.pause();
		opened.dispose();

	}

	opened = texture;
	lamp.map = texture || drawn;
	lamp.needsUpdate = true;
	isNew = true;

}

/** The texture of a picture file or a video file. */
async function textureOf( address, isVideo ) {

	if ( ! isVideo ) return new THREE.TextureLoader().loadAsync( address );
	const video = Object.assign( document.createElement( 'video' ), { src: address, loop: true, muted: true, playsInline: true } );
	await video.play();
	return new THREE.VideoTexture( video );

}

show.addEventListener( 'change', () => {

	file.value = '';
	showTexture( null );

} );
file.addEventListener( 'change', async () => {

	const [ chosen ] = file.files;
	if ( ! chosen ) return;
	try {

		const texture = await textureOf( URL.createObjectURL( chosen ), chosen.type.startsWith( 'video/' ) );
		texture.colorSpace = THREE.SRGBColorSpace;
		showTexture( texture );
		message.value = '';

	} catch {

		message.value = `${ chosen.name } is not a picture or video that this browser can show`;

	}

} );

renderer.setAnimationLoop( ( time ) => {

	if ( ! opened && ( isNew || show.value === 'video' ) ) {

		drawScreen( canvas.getContext( '2d' ), show.value, time / 1000 );
		drawn.needsUpdate = true;

	}

	if ( isNew || ( opened ? opened.isVideoTexture : show.value === 'video' ) ) pictures.update( renderer, opened || drawn );
	isNew = false;
	renderer.render( scene, camera );

} );
