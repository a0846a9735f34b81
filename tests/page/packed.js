// Drops a scene and saves its files for every engine.

import { readFile } from 'node:fs/promises';

import { glb, sphere } from './glb.js';
import { unzipped } from './unzipped.js';
import { withWorld } from './world.js';

await withWorld( async ( { open } ) => {

	const page = await open( 'viewer?size=128&spp=16', { viewport: { width: 900, height: 650 } } );
	const ball = sphere( 24, { name: 'red plastic', pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 0.4, baseColorFactor: [ 0.5, 0.1, 0.05, 1 ] } } );
	await page.locator( '#mesh' ).setInputFiles( { name: 'ball.glb', mimeType: 'model/gltf-binary', buffer: Buffer.from( glb( ball ) ) } );
	await page.waitForFunction( () => document.querySelector( '.scene p' )?.textContent );
	const archives = {};
	for ( const engine of await page.locator( '#view-engine option' ).evaluateAll( ( options ) => options.map( ( { value } ) => value ) ) ) {

		await page.locator( '#view-engine' ).selectOption( engine );
		const saved = page.waitForEvent( 'download' );
		await page.locator( '.scene .primary' ).click();
		const files = unzipped( await readFile( await ( await saved ).path() ) );
		archives[ engine ] = { names: Object.keys( files ), readme: files[ 'README.md' ], layout: JSON.parse( files[ 'recipe.json' ] ).layout };

	}

	return { archives };

} );
