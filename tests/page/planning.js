// Tests the forecast of a recipe, weights of materials, and recipes from scenes.

import { glb, sphere } from './glb.js';
import { withWorld } from './world.js';

await withWorld( async ( { open, complaints } ) => {

	const page = await open( 'new' );
	const recipe = async () => JSON.parse( await page.getByRole( 'textbox', { name: 'Recipe as JSON' } ).inputValue() );
	const size = ( text ) => page.locator( '.facts div', { hasText: 'Size' } ).filter( { hasText: text } ).waitFor();
	await size( '166 kB' );
	await page.locator( '#field-precision' ).selectOption( 'f16' );
	await size( '83 kB' );

	// The form shows the weights of materials and keeps them.
	const fresnel = [ { f0: 1 }, { f0: 0.04, weight: 4 } ];
	await page.evaluate( ( recipe ) => location.hash = `#/new?${ new URLSearchParams( { recipe } ) }`, JSON.stringify( { preset: 'draft', fresnel } ) );
	const list = page.getByLabel( 'F0 of the materials' );
	await page.waitForFunction( () => document.querySelector( '.materials [type=text]' )?.value.includes( '×' ) );
	const shown = await list.inputValue();
	await list.fill( '1, 0.04 x 8, 0.5' );
	const weighed = ( await recipe() ).fresnel;
	await list.fill( '1, 0.04 × grey' );
	const fault = await page.locator( '#field-fresnel-fault' ).filter( { hasText: /./ } ).textContent();

	// Plan for a list of materials, with a budget, and for a scene.
	const scene = page.locator( '#scene' );
	const materials = { materials: [ { name: 'brushed', alpha_x: 0.3, alpha_y: 0.09 } ] };
	await scene.setInputFiles( { name: 'list.json', mimeType: 'application/json', buffer: Buffer.from( JSON.stringify( materials ) ) } );
	await page.locator( '.drop button', { hasText: 'ggx' } ).waitFor();
	const planned = await recipe();
	await Promise.all( [ page.waitForResponse( ( response ) => response.url().endsWith( '/v1/plans?bytes=20000' ) && response.ok() ), page.locator( '#budget' ).selectOption( 'bytes' ) ] );
	await scene.setInputFiles( { name: 'sphere.glb', mimeType: 'model/gltf-binary', buffer: glb( sphere( 8, { pbrMetallicRoughness: { roughnessFactor: 0.5 } } ) ) } );
	await page.locator( '.drop button', { hasText: 'ggx' } ).waitFor();
	await page.locator( '.drop p', { hasText: 'sphere.glb' } ).waitFor();
	const round = await recipe();
	await scene.setInputFiles( { name: 'broken.glb', mimeType: 'model/gltf-binary', buffer: Buffer.from( 'glTF' ) } );
	const refused = await page.locator( '.drop .notice' ).first().textContent();

	// Starts from a use.
	await page.locator( '#start' ).selectOption( { label: 'glTF sheen' } );
	await page.waitForFunction( () => document.querySelector( '#field-brdf' ).value === 'charlie_neubelt' );
	// The browser reports every response with an error status.
	const others = complaints.splice( 0 ).filter( ( text ) => ! text.includes( 'status of 422' ) );
	return { others, shown, weighed, fault, planned, round, refused };

} );
