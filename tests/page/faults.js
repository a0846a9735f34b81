// Errors in a recipe appear next to their fields while the user types, and disappear when they are corrected.

import { withWorld } from './world.js';

await withWorld( async ( { service, open } ) => {

	// The link contains errors. One of them has no field.
	const recipe = { preset: 'draft', colour: "it's red", fit: { samples: 3 } };
	const page = await open( `new?${ new URLSearchParams( { recipe: JSON.stringify( recipe ) } ) }` );
	const fault = ( field ) => page.locator( `#field-${ field }-fault` );
	await fault( 'fit-samples' ).filter( { hasText: 'from 32 to 65536' } ).waitFor();
	await page.getByText( '/colour: unknown field' ).waitFor();
	// A shell reads the recipe in this line as one word.
	const line = await page.getByRole( 'region', { name: 'curl command' } ).textContent();
	if ( ! line.includes( `"colour":"it'\\''s red"` ) ) throw new Error( line );
	const samples = page.locator( '#field-fit-samples' );
	const shown = { samples: await samples.inputValue(), invalid: await samples.getAttribute( 'aria-invalid' ), directions: await page.locator( '#field-fit-directions' ).inputValue() };
	const isRefused = await page.getByRole( 'button', { name: 'Submit' } ).isDisabled();
	await page.getByRole( 'button', { name: 'Back to the preset' } ).click();
	await page.locator( 'aside dd', { hasText: '%' } ).waitFor();
	const left = await page.locator( '.fault' ).allTextContents();

	// Two fields that exclude each other, and an invalid value: each error is next to its field.
	await page.locator( '#field-brdf' ).selectOption( 'charlie' );
	await page.locator( '#field-layout' ).selectOption( 'reflected' );
	await page.locator( '#field-fit-steps' ).fill( '0' );
	await fault( 'layout' ).filter( { hasText: 'reflected' } ).waitFor();
	await fault( 'fit-steps' ).filter( { hasText: '0 is not' } ).waitFor();
	await page.locator( '#field-layout' ).selectOption( 'kt2022' );
	await page.locator( '#field-fit-steps' ).fill( '5' );
	await page.locator( 'aside dd', { hasText: '%' } ).waitFor();

	// Only layout `materials` shows the list of roughnesses. The list determines the nodes of alpha and ratio.
	const entered = async () => JSON.parse( await page.getByRole( 'textbox', { name: 'Recipe as JSON' } ).inputValue() );
	const list = page.locator( '#field-materials' );
	const isHidden = await list.isHidden();
	await page.locator( '#field-resolution-alpha' ).fill( '5' );
	await page.locator( '#field-brdf' ).selectOption( 'ggx' );
	await page.locator( '#field-layout' ).selectOption( 'materials' );
	await fault( 'materials' ).filter( { hasText: 'needs its materials' } ).waitFor();
	await list.fill( '0.4 / 0.1, 0.09, grey' );
	const item = await fault( 'materials' ).filter( { hasText: 'materials/2/alpha: ' } ).textContent();
	await list.fill( '0.4 / 0.1, 0.09, 0.3 × 0.5' );
	await page.locator( 'aside dd', { hasText: '%' } ).waitFor();
	const { materials, resolution } = await entered();
	await page.reload();
	await page.waitForFunction( () => document.querySelector( '#field-materials' )?.value );
	const roughnesses = { isHidden, item, materials, resolution: resolution ?? null, text: await list.inputValue() };
	await list.fill( '' );
	await fault( 'materials' ).filter( { hasText: 'needs its materials' } ).waitFor();

	// The JSON can contain fields that the form does not have. The form shows all other fields.
	const text = page.getByRole( 'textbox', { name: 'Recipe as JSON' } );
	const pasted = { preset: 'draft', nodes: { alpha: [ 0.04, 0.09, 0.25 ], ratio: [ 1 ] }, resolution: { theta: 5 }, range: { phi: [ 0, 0 ] }, fit: { solver: 'nelder_mead', metric: 'l3', shear: 'z', start: 'independent' } };
	await text.fill( JSON.stringify( pasted ) );
	await page.locator( 'aside dd', { hasText: /^15$/ } ).waitFor();
	const fields = [ await page.locator( '#field-fit-solver' ).inputValue(), await page.getByLabel( 'draft' ).isChecked() ];
	await text.fill( '{ "preset": ' );
	const malformed = [ await page.locator( '#document-fault' ).textContent(), await page.getByRole( 'button', { name: 'Submit' } ).isDisabled() ];
	await text.fill( JSON.stringify( { ...pasted, fit: { shear: 'y', steps: 0 } } ) );
	await page.getByText( '/fit/shear: ' ).waitFor();
	await fault( 'fit-steps' ).filter( { hasText: '0 is not' } ).waitFor();
	await text.fill( JSON.stringify( pasted ) );
	await page.locator( 'aside dd', { hasText: /^15$/ } ).waitFor();
	// An input changes only its own field in the JSON.
	await page.locator( '#field-fit-steps' ).fill( '40' );
	const written = await entered();
	const isTaken = JSON.stringify( { ...pasted, fit: { ...pasted.fit, steps: 40 } } ) === JSON.stringify( written );
	const { items } = await service.call( '/v1/jobs' );
	return { json: { fields, malformed, isTaken }, shown, isRefused, left: left.join( '' ), jobs: items.length, roughnesses };

} );
