// Compares the viewer's pixels with previews that the service renders on the CPU.

import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { LTCFORGE, withWorld } from './world.js';

const KT2022 = fileURLToPath( new URL( '../../src/server/page/published/kt2022.npy', import.meta.url ) );

/** Pixels per side of the viewer's image. */
const SIZE = 512;

/** Thirty pixels that lie on the sphere, and on the floor below the horizon. */
const PLACES = Array.from( { length: 30 }, ( _, i ) => {

	const [ angle, radius ] = [ 2.4 * i, 100 * Math.sqrt( ( i + 0.5 ) / 30 ) ];
	return [ Math.round( SIZE / 2 + radius * Math.cos( angle ) ), Math.round( SIZE / 2 + radius * Math.sin( angle ) ) ];

} );

/** Pixels where an edge of light `cut` meets the floor. With positions of 16 bits, they would differ by up to 170. */
const CUT = [ [ 374, 272 ], [ 369, 258 ], [ 365, 247 ], [ 361, 236 ], [ 377, 282 ], [ 378, 283 ] ];

/** The parameters of a preview for a scene of the viewer with its first light. */
function preview( { surface, table = '', metal, light_shape, light_x = - 1.3, light_y = 1.4, light_z = 1.2, light_yaw = 0, light_pitch = 0, light_roll = 0, light_sides, light_width = 0.7, light_height = 0.45, ...scene } ) {

	const light = { light: light_shape || 'rectangle', light_centre: `${ light_x },${ light_y },${ light_z }`, light_rotation: `${ light_yaw },${ light_pitch },${ light_roll }`, light_two_sided: light_sides === 'both', light_half_size: `${ light_width },${ light_height }` };
	const camera = { camera_distance: 9, camera_elevation: 0.2, field_of_view: 0.5 };
	const f0 = metal ? { f0: { plastic: '0.04,0.04,0.04', white: '1,1,1' }[ metal ] } : {};
	return new URLSearchParams( { scene: surface === 'floor' ? 'brushed_floor' : 'sphere', ...light, ...camera, ...( [ '', 'ltc-formula' ].includes( table ) ? { model: table || 'normals' } : { table } ), ...f0, alpha_x: 0.5, alpha_y: 0.1, size: SIZE, ...scene } );

}

/** The radiance of a byte of an image. `shownAs` is the inverse. */
const linear = ( byte ) => {

	const v = byte / 255;
	return - Math.log( Math.max( 1e-3, 1 - ( v <= 0.04045 ? v / 12.92 : ( ( v + 0.055 ) / 1.055 ) ** 2.4 ) ) );

};

const shownAs = ( radiance ) => {

	const y = 1 - Math.exp( - radiance );
	return 255 * ( y <= 0.0031308 ? 12.92 * y : 1.055 * y ** ( 1 / 2.4 ) - 0.055 );

};

await withWorld( async ( { service, open } ) => {

	const reflected = await service.fit( { preset: 'draft' } );
	const round = await service.fit( { preset: 'draft', layout: 'ltc2017' } );
	const twoLobes = await service.fit( { preset: 'draft', fresnel: 'two_lobes' } );
	const blended = await service.fit( { preset: 'draft', fresnel: 'blended_lobes' } );
	const sheen = await service.fit( { preset: 'draft', brdf: 'charlie' } );
	const scenes = {
		normals: { rotation: 0.6, exposure: 2 },
		floor: { surface: 'floor', alpha_x: 0.2, alpha_y: 0.4 },
		reflected: { table: reflected, rotation: 0.6, camera_azimuth: 0.4 },
		round: { table: round, alpha_x: 0.3, alpha_y: 0.3 },
		plastic: { table: twoLobes, metal: 'plastic', alpha_x: 0.3, alpha_y: 0.2, exposure: 8 },
		blended: { table: blended, metal: 'plastic', alpha_x: 0.3, alpha_y: 0.2, exposure: 8 },
		sheen: { table: sheen, metal: 'white', alpha_x: 0.4, alpha_y: 0.4, exposure: 4 },
		disk: { table: reflected, light_shape: 'disk' },
		sphere: { table: reflected, light_shape: 'sphere', light_width: 0.4 },
		tube: { table: reflected, light_shape: 'tube', light_height: 0.1 },
		line: { table: reflected, light_shape: 'line', light_height: 0.05, exposure: 4 },
		hexagon: { table: reflected, light_shape: 'hexagon' },
		formula: { table: 'ltc-formula', metal: 'plastic', alpha_x: 0.3, alpha_y: 0.2, exposure: 8 },
		tube_by_formula: { table: 'ltc-formula', light_shape: 'tube', light_height: 0.1, rotation: 0.6 },
		disk_by_normals: { light_shape: 'disk' },
		tube_by_normals: { light_shape: 'tube', light_height: 0.1 },
		// The light cuts the floor. In the picture, its edge on the floor runs through some of CUT.
		cut: { surface: 'floor', light_x: 1, light_y: 0.1, light_z: 0, light_height: 0.6, camera_elevation: 0.3 },
		turned: { table: reflected, light_yaw: 0.4, light_pitch: 0.5, light_roll: - 0.3 },
		turned_away: { light_yaw: 3.0, light_roll: 0.5, light_sides: 'both' },
		both_sides_of_a_disk: { table: 'ltc-formula', light_shape: 'disk', light_yaw: 2.8, light_sides: 'both' },
		line_by_normals: { light_shape: 'line', light_height: 0.05, exposure: 4 },
	};
	const page = await open( 'tables' );
	// Pixels at some places: from the viewer's image, from a picture of the service by its path, or from a file by its
	// bytes.
	const pixels = ( from, places ) => page.evaluate( async ( { from, places } ) => {

		const canvas = document.createElement( 'canvas' );
		const image = from ? await createImageBitmap( Array.isArray( from ) ? new Blob( [ new Uint8Array( from ) ] ) : await ( await fetch( from ) ).blob() ) : document.querySelector( '.stage canvas' );
		Object.assign( canvas, { width: image.width, height: image.height } );
		const context = canvas.getContext( '2d' );
		context.drawImage( image, 0, 0 );
		return places.map( ( [ x, y ] ) => [ ...context.getImageData( x, y, 1, 1 ).data ].slice( 0, 3 ) );

	}, { from, places } );
	const apart = ( one, other ) => Math.max( ...one.flat().map( ( value, i ) => Math.abs( value - other.flat()[ i ] ) ) );
	const shown = async ( scene ) => {

		await page.evaluate( ( hash ) => location.hash = hash, `#/viewer?${ new URLSearchParams( { size: SIZE, glow: 'off', diffuse: 'off', spp: 2, ...scene } ) }` );
		// The figures appear once the image is drawn.
		await page.locator( '.page-viewer .facts' ).waitFor();

	};

	/** Waits until the reference has at least `samples` samples. */
	const sampled = ( samples ) => page.waitForFunction( ( samples ) => Number( document.querySelector( '.stage canvas' ).dataset.samples ) >= samples, samples );

	const off = {};
	const bright = {};
	for ( const [ name, scene ] of Object.entries( scenes ) ) {

		await shown( { ...scene, show: 'model' } );
		const places = name === 'cut' ? [ ...PLACES, ...CUT ] : PLACES;
		const [ ours, theirs ] = [ await pixels( null, places ), await pixels( `v1/preview?${ preview( scene ) }`, places ) ];
		off[ name ] = apart( ours, theirs );
		bright[ name ] = Math.max( ...theirs.flat() );

	}

	// Compares the published table of KT et al. with `ltcforge preview` of its file.
	for ( const [ name, scene ] of Object.entries( { kt2022: { rotation: 0.3 }, kt2022_sharp: { alpha_x: 0.1, alpha_y: 0.02, exposure: 2 } } ) ) {

		await shown( { table: 'kt2022', show: 'model', ...scene } );
		const options = [ ...preview( { table: 'kt2022', ...scene } ) ].filter( ( [ name ] ) => name !== 'table' ).flatMap( ( [ name, value ] ) => [ `--${ name.replaceAll( '_', '-' ) }`, value ] );
		const folder = mkdtempSync( join( tmpdir(), 'ltcforge-' ) );
		const { stderr, status } = spawnSync( LTCFORGE, [ 'preview', KT2022, '--ggx-terms', '--adapter', 'cpu', ...options, '-o', 'kt2022.png' ], { cwd: folder, encoding: 'utf8' } );
		if ( status !== 0 ) throw new Error( stderr );
		const bytes = [ ...readFileSync( join( folder, 'kt2022.png' ) ) ];
		rmSync( folder, { recursive: true } );
		const [ ours, theirs ] = [ await pixels( null, PLACES ), await pixels( bytes, PLACES ) ];
		off[ name ] = apart( ours, theirs );
		bright[ name ] = Math.max( ...theirs.flat() );

	}

	// Two lights are as bright as the sum of each alone.
	const [ first, second ] = [ { light_shape: 'disk' }, { light_x: 1.5, light_y: 1.2, light_z: 1, light_shape: 'tube', light_height: 0.1 } ];
	await shown( { table: reflected, show: 'model', lights: 2, ...first, ...Object.fromEntries( Object.entries( second ).map( ( [ name, value ] ) => [ name.replace( 'light', 'light2' ), value ] ) ) } );
	const both = await pixels( null, PLACES );
	const alone = [ await pixels( `v1/preview?${ preview( { table: reflected, ...first } ) }`, PLACES ), await pixels( `v1/preview?${ preview( { table: reflected, light_shape: 'tube', light_height: 0.1, light_centre: '1.5,1.2,1' } ) }`, PLACES ) ];
	off.two_lights = apart( both, alone[ 0 ].map( ( pixel, i ) => pixel.map( ( byte, c ) => shownAs( linear( byte ) + linear( alone[ 1 ][ i ][ c ] ) ) ) ) );
	bright.two_lights = Math.max( ...both.flat() );

	// Compares references over a grid.
	const grid = Array.from( { length: 400 }, ( _, i ) => [ 20 + 24 * ( i % 20 ), 20 + 24 * Math.floor( i / 20 ) ] );
	const sum = ( pixels ) => pixels.flat().reduce( ( a, b ) => a + b, 0 );
	const reference = {};
	for ( const [ name, scene, spp ] of [ [ 'rectangle', { rotation: 0.3 }, 1024 ], [ 'disk', { light_shape: 'disk' }, 128 ], [ 'tube', { light_shape: 'tube', light_height: 0.1 }, 128 ], [ 'sheen', { table: sheen, metal: 'white', alpha_x: 0.4, alpha_y: 0.4, exposure: 4 }, 128 ] ] ) {

		await shown( { show: 'reference', ...scene, spp } );
		await sampled( spp );
		reference[ name ] = sum( await pixels( null, grid ) ) / sum( await pixels( `v1/preview?${ preview( { ...scene, mode: 'reference', spp } ) }`, grid ) ) - 1;

	}

	// A table for engines is accurate for an isotropic surface, but not for an anisotropic surface.
	const engines = {};
	for ( const [ name, scene ] of [ [ 'round', { alpha_y: 0.4 } ], [ 'sphere', { alpha_y: 0.4, light_shape: 'sphere' } ], [ 'brushed', { alpha_y: 0.1 } ] ] ) {

		await shown( { table: 'engines', show: 'model', alpha_x: 0.4, ...scene } );
		const [ ours, theirs ] = [ await pixels( null, grid ), await pixels( `v1/preview?${ preview( { table: reflected, alpha_x: 0.4, ...scene } ) }`, grid ) ];
		engines[ name ] = ours.flat().reduce( ( off, byte, i ) => off + Math.abs( byte - theirs.flat()[ i ] ), 0 ) / ours.flat().length;

	}

	// With the same model on both sides, there is no difference.
	await shown( { table: reflected, against: reflected, show: 'difference' } );
	const same = Math.max( ...( await pixels( null, PLACES ) ).map( ( pixel ) => Math.max( ...pixel ) - Math.min( ...pixel ) ) );
	// A link can name `normals` for the right side. It must not be in the list of tables.
	await shown( { table: reflected, against: 'normals' } );
	const [ beside, tables ] = [ await page.locator( '#against option:checked' ).innerText(), await page.locator( '#model option' ).allInnerTexts() ];
	await shown( { table: sheen, against: reflected } );
	const two = await page.locator( '.page-viewer' ).innerText();
	return { off, bright, reference, engines, same, beside, tables, isExplained: /Two scattering models: charlie on the left, ggx/.test( two ) };


}, [ '--adapter', 'cpu' ] );
