// Makes the four textures. THREE is the namespace of the three.js that renders. With WebGLRenderer:
//     import * as THREE from 'three';
//     import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';
//     RectAreaLightUniformsLib.init();
//     Object.assign( THREE.UniformsLib, createLTC( THREE ) );
// With WebGPURenderer:
//     import * as THREE from 'three/webgpu';
//     THREE.RectAreaLightNode.setLTC( createLTC( THREE ) );
export function createLTC( THREE ) {

	const floats = floatsOf( bytesOf( NUMBERS ) );
	const halfs = halfsOf( floats, bytesOf( FARTHER ) );
	const texture = ( data, type ) => {

		const made = new THREE.DataTexture( data, SIZE, SIZE, THREE.RGBAFormat, type );
		made.wrapS = made.wrapT = THREE.ClampToEdgeWrapping;
		made.magFilter = made.minFilter = THREE.LinearFilter;
		made.generateMipmaps = false;
		made.needsUpdate = true;
		return made;

	};

	const middle = floats.length / 2;
	return {
		LTC_FLOAT_1: texture( floats.slice( 0, middle ), THREE.FloatType ),
		LTC_FLOAT_2: texture( floats.slice( middle ), THREE.FloatType ),
		LTC_HALF_1: texture( halfs.slice( 0, middle ), THREE.HalfFloatType ),
		LTC_HALF_2: texture( halfs.slice( middle ), THREE.HalfFloatType ),
	};

}

function bytesOf( base64 ) {

	return Uint8Array.from( atob( base64 ), ( character ) => character.charCodeAt( 0 ) );

}

// The lowest bytes of all numbers come first and the highest last, each for one channel after another. Text in this order
// compresses well.
function floatsOf( sorted ) {

	const bytes = new Uint8Array( sorted.length );
	const texels = SIZE * SIZE;
	sorted.forEach( ( value, i ) => {

		const place = Math.floor( i / texels );
		const [ byte, texture, channel ] = [ place >> 3, place >> 2 & 1, place & 3 ];
		bytes[ 4 * ( 4 * ( texture * texels + i % texels ) + channel ) + byte ] = value;

	} );
	return new Float32Array( bytes.buffer );

}

// Each number becomes one of its two neighbouring halfs, selected so that lobes move least. A bit selects the half farther
// from zero.
function halfsOf( floats, farther ) {

	return Uint16Array.from( new Uint32Array( floats.buffer ), ( word, i ) => {

		const magnitude = word & 0x7fffffff;
		const exponent = magnitude >>> 23;
		let nearer = 0;
		if ( exponent > 112 ) nearer = Math.min( ( magnitude >>> 13 ) - ( 112 << 10 ), 0x7bff );
		else if ( exponent > 102 ) nearer = ( 0x800000 | magnitude & 0x7fffff ) >>> ( 126 - exponent );
		return ( word >>> 16 & 0x8000 ) + nearer + ( farther[ i >> 3 ] >> ( i & 7 ) & 1 );

	} );

}
