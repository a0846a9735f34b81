// Checks every page in both themes and at four widths: with axe-core, for content wider than the window, for small
// text, and for motion if the user prefers reduced motion. `--pictures FOLDER` writes screenshots.

import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';
import { createServer, request } from 'node:http';
import { once } from 'node:events';
import { join } from 'node:path';

import { PICTURES, SMALL, withWorld } from './world.js';

const AXE = await readFile( createRequire( import.meta.url ).resolve( 'axe-core/axe.min.js' ), 'utf8' );
const WIDTHS = [ 360, 1280, 2560, 3840 ];

/** An element of each page that appears once it is complete. */
const READY = { tables: '.picture img[src]', table: '.plots img[src]', lookup: '.shown img[src]', jobs: '.state', job: '.state', new: 'aside dd', faults: '.bad', compare: '.best', mixed: '.page-compare .muted', viewer: '.facts', difference: '.ramp', nowhere: '.notice' };

/** The smallest font size by the width of the window, in pixels. On a 4K screen without scaling, a pixel is half as large as on others. */
const LEAST = { 360: 11, 1280: 11, 2560: 11, 3840: 16 };

/** Runs in the page: its smallest font size, and the part of the window's width that it uses. */
function text() {

	const written = [ ...document.querySelectorAll( 'header *, main *' ) ].filter( ( element ) => ! ( element instanceof SVGElement ) && element.checkVisibility() && [ ...element.childNodes ].some( ( { nodeType, data } ) => nodeType === Node.TEXT_NODE && data.trim() ) );
	const sizes = written.map( ( element ) => parseFloat( getComputedStyle( element ).fontSize ) * element.currentCSSZoom );
	return { size: Math.min( ...sizes ), part: document.querySelector( 'main' ).getBoundingClientRect().width / window.innerWidth };

}

/** Runs in the page: the number of running animations after one was set on every element. */
function animations() {

	const sheet = new CSSStyleSheet();
	sheet.replaceSync( '@keyframes drift { to { opacity: 0.9 } } * { animation: drift 60s infinite }' );
	document.adoptedStyleSheets = [ sheet ];
	const count = document.getAnimations().length;
	document.adoptedStyleSheets = [];
	return count;

}

/** A proxy that serves the service below a path. It keeps the field `Host`, by which the service recognises its own pages. */
async function below( prefix, service ) {

	const server = createServer( ( asked, answer ) => {

		if ( ! asked.url.startsWith( `${ prefix }/` ) ) return answer.writeHead( 404 ).end();
		const { method, headers } = asked;
		const forwarded = request( { host: '127.0.0.1', port: service.port, path: asked.url.slice( prefix.length ), method, headers }, ( from ) => {

			answer.writeHead( from.statusCode, from.headers );
			from.pipe( answer );

		} );
		asked.pipe( forwarded );

	} ).listen( 0, '127.0.0.1' );
	await once( server, 'listening' );
	return server;

}

/** The violations of accessibility rules on a page. */
async function broken( page, at ) {

	await page.evaluate( AXE );
	const found = await page.evaluate( () => window.axe.run( document, { runOnly: [ 'wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice' ] } ) );
	return found.violations.map( ( { id, nodes } ) => `${ at }: ${ id }: ${ nodes.map( ( { html } ) => html.slice( 0, 120 ) ).join( ' | ' ) }` );

}

await withWorld( async ( { service, open } ) => {

	const violations = [];
	// Lists without tables and jobs.
	for ( const colorScheme of [ 'light', 'dark' ] ) for ( const list of [ 'tables', 'jobs' ] ) {

		const page = await open( list, { colorScheme } );
		await page.locator( '.empty, .page-jobs .muted' ).first().waitFor();
		violations.push( ...await broken( page, `empty ${ list }, ${ colorScheme }` ) );
		await page.context().close();

	}

	// For screenshots, the tables have good quality.
	const recipes = PICTURES ? [ { preset: 'paper' }, { preset: 'standard', layout: 'ltc2017' }, { preset: 'paper', precision: 'f16' }, { preset: 'draft', brdf: 'charlie' } ] : [ SMALL, { ...SMALL, precision: 'f16' } ];
	const digests = [];
	for ( const recipe of recipes ) digests.push( await service.fit( recipe ) );
	const sheen = await service.fit( { ...SMALL, brdf: 'charlie', resolution: { alpha: 2, theta: 2 } } );
	const lookup = await service.fit( { table: 'dfg', resolution: { roughness: 8, cos_theta: 8 } } );
	const failed = await service.fail( { ...SMALL, terms: false } );
	const bad = JSON.stringify( { preset: 'draft', fit: { samples: 3 } } );
	const pages = { tables: 'tables', table: `tables/${ digests[ 0 ] }`, lookup: `tables/${ lookup }`, jobs: 'jobs', job: `jobs/${ failed }`, new: 'new', faults: `new?${ new URLSearchParams( { recipe: bad } ) }`, compare: `compare?tables=${ digests.slice( 0, 3 ) }`, mixed: `compare?tables=${ digests[ 0 ] },${ sheen }`, viewer: `viewer?table=${ digests[ 0 ] }${ PICTURES ? '' : '&show=model' }`, difference: 'viewer?show=difference&size=128&spp=16', nowhere: 'nowhere' };
	const [ wide, small, moving ] = [ [], [], [] ];
	let looked = 0;
	for ( const colorScheme of [ 'light', 'dark' ] ) for ( const width of WIDTHS ) {

		const reducedMotion = colorScheme === 'dark' ? 'reduce' : 'no-preference';
		const page = await open( 'tables', { colorScheme, reducedMotion, viewport: { width, height: 860 } } );
		for ( const [ name, hash ] of Object.entries( pages ) ) {

			await page.evaluate( ( hash ) => location.hash = `#/${ hash }`, hash );
			await page.locator( `.page-${ hash.split( /[/?]/ )[ 0 ] } h1` ).waitFor();
			// Waits for all pictures. For screenshots, it also waits for a complete reference in the viewer.
			await page.locator( READY[ name ] ).first().waitFor();
			await page.waitForFunction( ( samples ) => [ ...document.images ].every( ( { src, complete } ) => src && complete )
				&& [ ...document.querySelectorAll( '.stage canvas' ) ].every( ( { dataset } ) => Number( dataset.samples ) >= samples ), PICTURES && name === 'viewer' ? 1024 : 0 );
			const at = `${ name }, ${ width }, ${ colorScheme }`;
			if ( await page.evaluate( () => document.documentElement.scrollWidth > window.innerWidth ) ) wide.push( at );
			looked ++;
			const { size, part } = await page.evaluate( text );
			if ( size < LEAST[ width ] || part < 0.6 ) small.push( `${ at }: letters of ${ size } pixels, ${ Math.round( 100 * part ) } % of the width` );
			if ( PICTURES ) await page.screenshot( { path: join( PICTURES, `${ name }-${ width }-${ colorScheme }.png` ), fullPage: true } );
			if ( reducedMotion === 'reduce' && name === 'viewer' ) {

				await page.locator( '#view-light_picture' ).selectOption( 'disc' );
				if ( ! await page.getByRole( 'button', { name: 'Play' } ).isVisible() ) moving.push( `${ at }: a video` );

			}

			const running = await page.evaluate( animations );
			if ( reducedMotion === 'reduce' ? running : ! running ) moving.push( `${ at }: ${ running } animations` );
			violations.push( ...await broken( page, at ) );

		}

		await page.context().close();

	}

	const proxy = await below( '/tools/ltc', service );
	const behind = await open( `tables/${ digests[ 0 ] }`, {}, `http://127.0.0.1:${ proxy.address().port }/tools/ltc` );
	await behind.getByText( 'wgpu', { exact: true } ).click();
	const link = await behind.locator( '.files a' ).first().evaluate( ( a ) => a.href );
	const { status } = await fetch( link );
	await behind.waitForLoadState( 'networkidle' );
	proxy.close();
	proxy.closeAllConnections();
	return { violations, wide, small, moving, looked, behind: { link: new URL( link ).pathname.slice( 0, 22 ), status } };

}, [ '--allow-host', '127.0.0.1' ] );
