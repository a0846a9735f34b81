// Writes the shaders of an example with `ltcforge`. Run `npm run build` in the example's folder; `npm start` and `npm pack` do it.

import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { basename } from 'node:path';

import { program } from './serve.js';

/** The closed form, with each of its rules. */
const rules = ( language ) => [ 'fast', 'balanced', 'fine' ].map( ( rule ) => [ `normals_${ rule }`, language, '--model', 'normals', '--rule', rule ] );

/** For each example: file, language, and the other arguments of `ltcforge shader`. */
const SHADERS = {
	babylon: rules( 'glsl' ),
	playcanvas: rules( 'glsl' ),
	three: [
		...rules( 'glsl' ),
		...rules( 'wgsl' ),
		...[ 'glsl', 'wgsl' ].map( ( language ) => [ 'ltc_formula', language, '--model', 'ltc-formula', '--lights', 'rectangles' ] ),
		[ 'table', 'glsl', '--layout', 'reflected', '--lights', 'polygons' ],
		[ 'normals_textured', 'glsl', '--model', 'normals', '--textured', '4' ],
		[ 'prefilter', 'glsl', '--as', 'prefilter' ],
		[ 'samplers', 'glsl', '--as', 'samplers' ],
	],
};

mkdirSync( 'shaders', { recursive: true } );
for ( const [ name, language, ...words ] of SHADERS[ basename( process.cwd() ) ] ) {

	const languages = { glsl: 'glsl-es', wgsl: 'wgsl' };
	const to = [ '--language', languages[ language ], '-o', `shaders/${ name }.${ language }.js` ];
	execFileSync( program(), [ 'shader', '--es-module', ...words, ...to ], { stdio: [ 'ignore', 'ignore', 'inherit' ] } );

}
