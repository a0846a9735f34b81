// Builds three.js from its sources twice, with its own DFG table and with the file of `ltcforge export --for three` in its
// place, and draws metal under a white sky. Prints one JSON document.
//
//   node dfg.js --ltcforge PROGRAM --chromium PROGRAM --file DFGLUTData.js

import { readFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serve } from '../../examples/common/serve.js';
import { openPage, withBrowser } from './browser.js';

const { values } = parseArgs( { options: {
	ltcforge: { type: 'string' }, chromium: { type: 'string' }, file: { type: 'string' },
} } );
const TABLE = 'renderers/shaders/DFGLUTData.js';
const sources = fileURLToPath( new URL( 'node_modules/three/src', import.meta.url ) );
const server = await serve( { '/stock/': sources, '/ours/': sources }, {
	'/page.html': async () => '<!doctype html><link rel="icon" href="data:,">',
	[ `/ours/${ TABLE }` ]: () => readFile( values.file ),
} );

/** Runs in the page: the texture of three.js in `folder`, and the radiance of metal at some roughnesses and cosines. */
async function drawn( folder, table ) {

	const THREE = await import( `/${ folder }/Three.js` );
	const { getDFGLUT } = await import( `/${ folder }/${ table }` );
	const F0 = 0.5;
	const renderer = new THREE.WebGLRenderer();
	const target = new THREE.WebGLRenderTarget( 1, 1, { type: THREE.FloatType } );
	const scene = new THREE.Scene();
	scene.environment = new THREE.DataTexture( new Float32Array( 256 * 128 * 4 ).fill( 1 ), 256, 128, THREE.RGBAFormat, THREE.FloatType );
	scene.environment.mapping = THREE.EquirectangularReflectionMapping;
	scene.environment.needsUpdate = true;
	const material = new THREE.MeshStandardMaterial( { color: new THREE.Color( F0, F0, F0 ), metalness: 1 } );
	const plane = new THREE.Mesh( new THREE.PlaneGeometry( 100, 100 ), material );
	scene.add( plane );
	const camera = new THREE.OrthographicCamera( - 0.01, 0.01, 0.01, - 0.01, 1, 200 );
	camera.position.z = 100;

	const { data, width, height } = getDFGLUT().image;
	const texel = ( x, y, channel ) => THREE.DataUtils.fromHalfFloat( data[ 2 * ( y * width + x ) + channel ] );
	const clamped = ( x, size ) => Math.min( Math.max( x * size - 0.5, 0 ), size - 1.0001 );
	const read = ( roughness, cosine ) => [ 0, 1 ].map( ( channel ) => {

		const [ u, v ] = [ clamped( roughness, width ), clamped( cosine, height ) ];
		const [ x, y ] = [ Math.floor( u ), Math.floor( v ) ];
		const row = ( y ) => texel( x, y, channel ) * ( x + 1 - u ) + texel( x + 1, y, channel ) * ( u - x );
		return row( y ) * ( y + 1 - v ) + row( y + 1 ) * ( v - y );

	} );

	const pictures = [];
	for ( const roughness of [ 0.15, 0.4, 0.9 ] ) for ( const cosine of [ 0.08, 0.5, 0.95 ] ) {

		material.roughness = roughness;
		plane.rotation.x = Math.acos( cosine );
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );
		const pixel = new Float32Array( 4 );
		renderer.readRenderTargetPixels( target, 0, 0, 1, 1, pixel );
		// The formula of three.js' shader, with the texture read as the linear filter reads it.
		const [ scale, bias ] = read( roughness, cosine );
		const [ single, lost, average ] = [ F0 * scale + bias, 1 - scale - bias, F0 + ( 1 - F0 ) / 21 ];
		pictures.push( { roughness, cosine, radiance: pixel[ 0 ], expected: single + single * average / ( 1 - lost * average ) * lost } );

	}

	const { name, format, type, minFilter, magFilter, wrapS, wrapT, generateMipmaps, flipY, colorSpace, isDataTexture } = getDFGLUT();
	return {
		texture: { name, format, type, minFilter, magFilter, wrapS, wrapT, generateMipmaps, flipY, colorSpace, isDataTexture, width, height },
		numbers: Array.from( data, THREE.DataUtils.fromHalfFloat ), pictures,
	};

}

try {

	const report = await withBrowser( values.chromium, async ( browser ) => {

		const report = { faults: [] };
		const page = await openPage( browser, 'dfg', `http://127.0.0.1:${ server.address().port }/page.html`, report.faults );
		for ( const folder of [ 'stock', 'ours' ] ) {

			report[ folder ] = await page.evaluate( `( ${ drawn } )( '${ folder }', '${ TABLE }' )` );

		}

		return report;

	} );
	console.log( JSON.stringify( report ) );

} finally {

	server.close();

}
