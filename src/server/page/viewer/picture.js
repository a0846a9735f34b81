// Draws the picture of a scene frame by frame: surface, both sides, lights, and samples of the truth.

import { device } from '../webgl/device.js';
import { OCCLUDED, SHADOWED } from '../webgl/shaders.js';
import { errorsOf } from './errors.js';
import { camera, CHOICES, DIFFUSE, METALS, occludersOf, read, uniformsOf } from './scene.js';
import { shaderBall } from './shader_ball.js';

/** The least and the largest number of samples per frame, and the frame times in milliseconds that lead to more and to fewer samples. */
const [ FEWEST, MANY, FAST, SLOW ] = [ 2, 32, 25, 150 ];

/** Places of a mesh within a pixel, one per frame. */
const PLACES = 16;
const NO_LIGHT = { kind: 'diffuse', text: '', uniforms: {}, textures: [] };

/** Pixels per side of a swatch, and its samples of the truth. */
const [ SWATCH, SWATCH_SAMPLES ] = [ 64, 64 ];

/** The shift of a frame in pixels, from -0.5 to 0.5. The first frame has none [Roberts 2018]. */
const shift = ( frame, step ) => ( frame * step + 0.5 ) % 1 - 0.5;

/** A nice number that is not smaller than `value`: 1, 2 or 5 times a power of ten. */
function nice( value ) {
	const power = 10 ** Math.floor( Math.log10( Math.max( value, 1e-6 ) ) );
	return power * [ 1, 2, 5, 10 ].find( ( step ) => step * power >= value * 0.999 );
}

/** The picture on a canvas. */
export function picture( canvas ) {
	const gpu = device( canvas );
	let [ frames, samples, perFrame, calls, isMoving ] = [ 0, 0, FEWEST, 0, false ];
	/** The numbers of samples at which the errors of all pixels and of the meshes are due. */
	let due = [ 0, 8 ];
	let [ errors, scale ] = [ null, 0.2 ];
	let meshes = [];

	/** The uniforms of a material. Sheen is white. */
	function ofMaterial( { alpha_x, alpha_y, rotation, f0, diffuse = [ 0, 0, 0 ], factors }, isWhite ) {
		return { ...factors, is_white: Number( isWhite ), f0: isWhite ? METALS.white : f0, diffuse: isWhite ? [ 0, 0, 0 ] : diffuse, material: [ alpha_x, alpha_y, Math.cos( rotation ), Math.sin( rotation ) ] };
	}

	/** Draws the surface. Meshes move within a pixel. */
	function drawSurface( scene, own, view, isWhite ) {
		const { size } = view;
		if ( meshes.length ) gpu.drawMeshes( { ...view, jitter: [ 0.7548776662, 0.5698402910 ].map( ( step ) => 2 * shift( frames, step ) / size ) }, meshes.map( ( { material, ...of } ) => ( { ...of, ofMaterial: ofMaterial( material, isWhite ) } ) ) );
		else gpu.drawSurface( { ...view, ...ofMaterial( own, isWhite ), pixel_width: 2 * camera( scene ).half / size, surface: CHOICES.surface.indexOf( scene.surface ) } );
		calls += meshes.length || 1;
	}

	/** Whether the light of a surface has a diffuse part. */
	const hasDiffuse = ( scene, own ) => scene.diffuse === 'on' && ( meshes.length ? meshes : [ { material: own } ] ).some( ( { material, textures } ) => textures || material.diffuse?.some( ( channel ) => channel > 0 ) );
	return {
		/** Forgets all sums, after a change of the scene. */
		restart: () => [ frames, samples, due ] = [ 0, 0, [ 0, 8 ] ],
		/** Draws a frame of a scene. `opened` are the meshes of a file, `models` both sides, where null is the truth, `layers` the pictures on lights, and the last argument shader texts. */
		draw( scene, size, opened, models, layers, { prefilter, samplers } ) {
			const since = performance.now();
			const shown = { mesh: opened ?? [], shader_ball: [ { numbers: shaderBall(), material: { ...scene, f0: METALS[ scene.metal ], diffuse: DIFFUSE[ scene.metal ] } } ] }[ scene.surface ] ?? [];
			gpu.forget( meshes.filter( ( { numbers } ) => shown.every( ( other ) => other.numbers !== numbers ) ) );
			meshes = shown;
			if ( gpu.resize( size ) ) this.restart();
			const { eye, right, up, forward } = camera( scene );
			const { uniforms, shapes: ofLights } = uniformsOf( scene.lights );
			const isOccluded = scene.occluders !== 'none';
			const shapes = isOccluded ? ofLights | OCCLUDED : ofLights;
			const hasShadows = isOccluded && scene.shadows !== 'off';
			const ofModels = hasShadows ? ofLights | SHADOWED : ofLights;
			const numbers = { ...uniforms, ...( isOccluded && occludersOf( scene ) ), eye, size };
			const view = { ...numbers, right, up, forward };
			const [ left, other ] = models;
			const own = { ...scene, f0: METALS[ scene.metal ], diffuse: DIFFUSE[ scene.metal ] };
			const diffuse = hasDiffuse( scene, own ) && left.brdf === 'ggx';
			calls = 1;
			if ( frames === 0 ) {
				const { layers: canvases, isMoving: moves } = layers();
				isMoving = moves;
				calls += gpu.picture( canvases, prefilter );
			}
			const hasNewPlace = frames === 0 || meshes.length > 0 && samples < scene.spp;
			if ( hasNewPlace ) drawSurface( scene, own, view, left.brdf !== 'ggx' );
			if ( frames === 0 || hasNewPlace && frames < PLACES ) {
				if ( hasShadows ) gpu.shadow( left.brdf, samplers, { ...numbers, frame: frames, samples: Number( scene.shadows ) }, shapes );
				gpu.light( 'left', left, numbers, ofModels, frames );
				if ( other ) gpu.light( 'right', other, numbers, ofModels, frames );
				if ( diffuse ) gpu.light( 'diffuse', NO_LIGHT, numbers, ofModels, frames );
				gpu.glow( view, shapes, frames );
				calls += 2 + Boolean( other ) + diffuse + hasShadows;
			}
			if ( samples < scene.spp ) {
				if ( samples === 0 ) perFrame = Math.min( perFrame, scene.spp );
				gpu.sample( left.brdf, numbers, shapes, samples, perFrame );
				samples += perFrame;
				calls ++;
			}
			frames ++;
			const weights = { size, has_right: Number( Boolean( other ) ), model_weight: 1 / ( meshes.length ? Math.min( frames, PLACES ) : 1 ), truth_weight: 1 / samples };
			// Measuring takes time, so it is done each time that the number of samples has grown by a quarter, or doubled for meshes.
			const isDue = due.map( ( count ) => samples >= Math.min( count, scene.spp ) );
			due = due.map( ( count, i ) => isDue[ i ] ? samples * [ 1.25, 2 ][ i ] : count );
			if ( isDue[ 0 ] ) errors = errorsOf( gpu.tiles( weights ), Boolean( other ) );
			const ofMeshes = isDue[ 1 ] && scene.surface === 'mesh' ? meshes.map( ( _, i ) => errors && errorsOf( gpu.tiles( weights, i ), Boolean( other ), errors.light ) ) : null;
			scale = nice( errors?.difference || scale );
			gpu.display( { ...weights, exposure: scene.exposure, split: scene.split, show: CHOICES.show.indexOf( scene.show ), difference_scale: scale, has_glow: Number( scene.glow === 'on' ), has_diffuse: Number( diffuse ) } );
			const milliseconds = performance.now() - since;
			if ( milliseconds > SLOW ) perFrame = Math.max( FEWEST, perFrame / 2 );
			else if ( milliseconds < FAST ) perFrame = Math.min( MANY, perFrame * 2 );
			// The last frame ends with the last sample.
			while ( samples < scene.spp && ( scene.spp - samples ) % perFrame ) perFrame /= 2;
			return { samples, milliseconds, calls, errors, ofMeshes, scale, isDone: samples >= scene.spp && ! isMoving, isMoving };
		},
		/** Draws a sphere of a material as it looks in a dropped file: the left half by a model, the right half by the truth. Forgets all sums. */
		swatch( material, model ) {
			const scene = read( new URLSearchParams( { dropped: 'swatch' } ) );
			const { eye, right, up, forward, half } = camera( scene );
			const { uniforms, shapes } = uniformsOf( scene.lights );
			const numbers = { ...uniforms, eye, size: SWATCH };
			const hasDiffuse = model.brdf === 'ggx' && material.diffuse.some( ( channel ) => channel > 0 );
			gpu.resize( SWATCH );
			gpu.drawSurface( { ...numbers, right, up, forward, ...ofMaterial( material, model.brdf !== 'ggx' ), pixel_width: 2 * half / SWATCH, surface: 0 } );
			gpu.light( 'left', model, numbers, shapes, 0 );
			if ( hasDiffuse ) gpu.light( 'diffuse', NO_LIGHT, numbers, shapes, 0 );
			gpu.sample( model.brdf, numbers, shapes, 0, SWATCH_SAMPLES );
			gpu.display( { size: SWATCH, has_right: 0, model_weight: 1, truth_weight: 1 / SWATCH_SAMPLES, exposure: scene.exposure, split: scene.split, show: 0, difference_scale: 1, has_glow: 0, has_diffuse: Number( hasDiffuse ) } );
			this.restart();
		},
		/** The radiance of both sides and of the truth at a pixel: the means of the channels. Missing sides are null, and so is a pixel beside the surface. */
		at( x, y ) {
			const [ left, right, even, odd ] = gpu.at( x, y );
			const value = ( sum ) => sum && sum[ 3 ] > 0 ? ( sum[ 0 ] + sum[ 1 ] + sum[ 2 ] ) / 3 / sum[ 3 ] : null;
			return { left: value( left ), right: value( right ), truth: even && value( even.map( ( number, i ) => number + odd[ i ] ) ) };
		},
		isLost: gpu.isLost,
		release: gpu.release,
	};
}
