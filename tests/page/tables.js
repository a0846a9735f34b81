// Searches, sorts, labels, compares and varies tables. Reads the error maps of a table with pointer and keyboard. Then a
// lookup table.

import { SMALL, withWorld } from './world.js';

await withWorld( async ( { service, open } ) => {

	// Without tables, the page shows a sphere and a button that fits a table. The first request for a picture is refused.
	const first = await open( 'nowhere' );
	await first.evaluate( () => {

		const { fetch } = window;
		let refused = false;
		window.fetch = ( path, ...rest ) => refused || ! String( path ).includes( '/v1/preview' ) ? fetch( path, ...rest ) : ( refused = true, Promise.resolve( new Response( '', { status: 503, headers: { 'retry-after': '1' } } ) ) );
		location.hash = '#/tables';

	} );
	await first.locator( '.empty img[src]' ).waitFor();
	const empty = await first.getByRole( 'button', { name: 'Fit the standard table' } ).isEnabled();
	const written = await first.evaluate( async () => {

		const { bytes, span } = await import( './page/elements/format.js' );
		return [ bytes( 9_960 ), bytes( 999_999 ), bytes( 1_500_000 ), span( 59.7 ), span( 119.7 ), span( 3599.9 ), span( 86_399 ) ];

	} );
	const digest = await service.fit( { preset: 'draft' } );
	// The open page shows the new table without a reload.
	await first.locator( `a[href="#/tables/${ digest }"]` ).waitFor();
	const [ coarse, half ] = [ await service.fit( SMALL ), await service.fit( { ...SMALL, precision: 'f16' } ) ];
	const manifests = {};
	for ( const name of [ digest, coarse, half ] ) manifests[ name ] = await service.call( `/v1/tables/${ name }/manifest` );
	const FIGURES = { 'Lobe error': ( { report } ) => report.between.width.mean, 'Light error': ( { report } ) => report.between.light.mean, Size: ( { bytes } ) => bytes };
	const list = await open( 'tables' );
	const shown = () => list.locator( '.list tbody th a' ).evaluateAll( ( links ) => links.map( ( { hash } ) => hash.replace( '#/tables/', '' ) ) );
	await list.waitForFunction( () => document.querySelectorAll( '.list tbody tr' ).length === 3 && ! document.querySelector( '.list tbody' ).textContent.includes( '…' ) );
	// The newest table is first. A click on a column sorts by it, and another click reverses the order.
	const newest = await shown();
	const sorted = {};
	for ( const [ name, figure ] of Object.entries( FIGURES ) ) {

		const heading = list.getByRole( 'columnheader', { name } );
		const states = [];
		for ( let click = 0; click < 2; click ++ ) {

			await heading.getByRole( 'button' ).click();
			states.push( { order: await heading.getAttribute( 'aria-sort' ), figures: ( await shown() ).map( ( name ) => figure( manifests[ name ] ) ) } );

		}

		sorted[ name ] = states;

	}

	// The recipe or the digest must contain every word.
	const found = {};
	for ( const words of [ 'F16', 'ggx f16', digest.slice( 10, 22 ), 'f16 kt2022', '' ] ) {

		await list.getByRole( 'searchbox' ).fill( words );
		found[ words.replace( digest.slice( 10, 22 ), 'digest' ) ] = [ ( await shown() ).map( ( name ) => [ digest, coarse, half ].indexOf( name ) ).sort(), await list.locator( '.bar [role=status]' ).textContent() ];

	}

	// Compares three tables. The best value of each figure is marked.
	for ( const name of [ digest, coarse, half ] ) await list.getByLabel( `Compare ${ name.slice( 7, 17 ) }` ).check();
	await list.getByRole( 'link', { name: 'Compare 3' } ).click();
	await list.locator( '.best' ).first().waitFor();
	const best = await list.locator( '.compare tbody tr' ).evaluateAll( ( rows ) => Object.fromEntries( rows.map( ( { cells: [ name, ...cells ] } ) => [ name.textContent, cells.map( ( cell ) => cell.classList.contains( 'best' ) && cell.textContent.startsWith( 'best: ' ) ) ] ) ) );
	const least = ( figure ) => [ digest, coarse, half ].map( ( name, _, names ) => figure( manifests[ name ] ) === Math.min( ...names.map( ( other ) => figure( manifests[ other ] ) ) ) );
	const winners = Object.entries( { 'Lobe error, mean': FIGURES[ 'Lobe error' ], 'Light error, mean': FIGURES[ 'Light error' ], Size: FIGURES.Size, Entries: ( { entries } ) => entries } ).map( ( [ name, figure ] ) => [ name, best[ name ], least( figure ) ] );

	// A variation starts from the complete recipe.
	await list.evaluate( ( hash ) => location.hash = hash, `#/tables/${ half }` );
	await list.getByRole( 'link', { name: 'Fit a variation' } ).click();
	await list.getByRole( 'button', { name: 'Open the table' } ).waitFor();
	const { fitter, ...recipe } = manifests[ half ].recipe;
	const varied = { isWhole: await list.getByRole( 'textbox', { name: 'Recipe as JSON' } ).inputValue().then( ( text ) => JSON.stringify( JSON.parse( text ) ) === JSON.stringify( recipe ) ), precision: await list.locator( '#field-precision' ).inputValue(), samples: await list.locator( '#field-fit-samples' ).inputValue() };
	await list.locator( '#field-fit-samples' ).fill( '96' );
	await list.getByRole( 'button', { name: 'Submit' } ).waitFor();

	const errors = await service.call( `/v1/tables/${ digest }/plots/error.json?ratio=0.25&phi=0.7` );
	const page = await open( `tables/${ digest }` );
	const map = page.locator( '.map' ).first();
	const output = page.locator( '.cell-errors' );
	await output.filter( { hasText: 'lobe error' } ).waitFor();
	/** The expected text for a cell. */
	const wanted = ( column, row ) => `view angle ${ Math.round( errors.theta[ column ] * 180 / Math.PI ) }°, azimuth 40°: lobe error ${ ( 100 * errors.width[ row ][ column ] ).toFixed( 1 ) } % of the lobe’s width, light error ${ ( 100 * errors.light[ row ][ column ] ).toFixed( 2 ) } % of the lobe’s energy`;
	await map.scrollIntoViewIfNeeded();
	const { x, y, width, height } = await map.boundingBox();
	// The cell in column 30 and in row 5 from below.
	await page.mouse.move( x + width * 30.5 / 40, y + height * ( 1 - 5.5 / 40 ) );
	const hovered = [ await output.textContent(), wanted( 30, 5 ) ];
	await map.focus();
	await page.keyboard.press( 'ArrowUp' );
	await page.keyboard.press( 'ArrowLeft' );
	const keyed = [ await output.textContent(), wanted( 29, 6 ) ];
	// The brightest cell has the largest error, and the darkest cell has the smallest.
	const bytes = await page.locator( '.map canvas' ).first().evaluate( ( canvas ) => [ ...canvas.getContext( '2d' ).getImageData( 0, 0, 40, 40 ).data ] );
	const flat = errors.width.flat();
	const shade = ( cell ) => bytes.slice( 4 * cell, 4 * cell + 3 ).reduce( ( a, b ) => a + b, 0 );
	const shades = Array.from( { length: 1600 }, ( _, cell ) => shade( cell ) );
	// Rows of the image run downwards. Rows of the errors run upwards.
	const at = ( error ) => ( 39 - Math.floor( flat.indexOf( error ) / 40 ) ) * 40 + flat.indexOf( error ) % 40;
	const isBrightest = shades[ at( Math.max( ...flat ) ) ] === Math.max( ...shades );
	const isDarkest = shades[ at( Math.min( ...flat ) ) ] === Math.min( ...shades );
	await page.locator( '#plot-ratio' ).fill( '1' );
	await output.filter( { hasText: /^alpha [0-9.]+, view/ } ).waitFor();
	// Errors of different ranges are not comparable, but sizes are.
	const part = await service.fit( { ...SMALL, range: { alpha: [ 0.2, 0.5 ] } } );
	await page.evaluate( ( tables ) => location.hash = `#/compare?tables=${ tables }`, [ coarse, part ] );
	await page.getByText( 'errors are not comparable' ).waitFor();
	const marked = await page.locator( 'tr:has(.best) th' ).allInnerTexts();
	const named = await page.locator( '.compare select option:checked' ).allInnerTexts();
	// Different reflectances are not comparable either.
	const metal = await service.fit( { ...SMALL, fresnel: [ { f0: 1 }, { f0: 0.04 } ] } );
	await page.evaluate( ( tables ) => location.hash = `#/compare?tables=${ tables }`, [ coarse, metal ] );
	await page.locator( `.compare a[href="#/tables/${ metal }"]` ).waitFor();
	await page.getByText( 'errors are not comparable' ).waitFor();
	marked.push( ...await page.locator( 'tr:has(.best) th' ).allInnerTexts() );

	// A label replaces the name in the list, in menus and after a reload. Only the keyboard is used.
	await page.evaluate( ( hash ) => location.hash = hash, `#/tables/${ metal }` );
	await page.getByLabel( 'Label, kept in this browser' ).focus();
	await page.keyboard.type( 'Blue plastic' );
	await page.keyboard.press( 'Enter' );
	await page.getByRole( 'heading', { name: 'Blue plastic' } ).waitFor();
	await page.reload();
	const labelled = [ await page.getByRole( 'heading', { level: 1 } ).textContent(), await page.title() ];
	await page.evaluate( ( tables ) => location.hash = `#/compare?tables=${ tables }`, [ coarse, metal ] );
	labelled.push( await page.locator( '.compare select' ).nth( 1 ).locator( 'option:checked' ).textContent() );
	await page.evaluate( () => location.hash = '#/tables' );
	labelled.push( await page.locator( `.list a[href="#/tables/${ metal }"]` ).textContent() );
	await page.getByRole( 'button', { name: 'Lobe error' } ).click();
	await page.getByText( 'errors of different surfaces or ranges are not comparable' ).waitFor();

	// A lookup table has a picture, a report and files for engines. It lights no surface, so nothing else is offered.
	const dfg = await service.fit( { table: 'dfg', resolution: { roughness: 4, cos_theta: 5 } } );
	const { report: { stored } } = await service.call( `/v1/tables/${ dfg }/manifest` );
	const lookup = { row: await page.locator( `tr:has(a[href="#/tables/${ dfg }"])` ).evaluate( ( row ) => [ row.querySelector( 'a' ).textContent, row.querySelectorAll( 'img, input' ).length ] ) };
	await page.locator( `.list a[href="#/tables/${ dfg }"]` ).click();
	await page.locator( '.shown img[src]' ).waitFor();
	lookup.links = await page.locator( '.bar a' ).allTextContents();
	lookup.hasMean = ( await page.locator( '#quality + div' ).textContent() ).includes( `mean error of a value is ${ Number( stored.mean.toPrecision( 3 ) ) }` );
	await page.getByText( 'bevy', { exact: true } ).click();
	lookup.file = await page.locator( '.files a' ).first().textContent();
	await page.getByRole( 'link', { name: 'Fit a variation' } ).click();
	await page.getByRole( 'button', { name: 'Open the table' } ).waitFor();
	lookup.fields = await page.locator( '[id^=field]:visible' ).count();
	return { labelled, lookup, empty, written, marked, named, isNewestFirst: String( newest ) === String( [ half, coarse, digest ] ), sorted, found, winners, varied, hovered, keyed, isBrightest, isDarkest, spread: Math.max( ...shades ) - Math.min( ...shades ) };

} );
