// Runs a script with its own service and a browser, and collects the errors that the browser reports.

import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtemp, rename, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { parseArgs } from 'node:util';

import { chromium } from 'playwright-core';

const { values } = parseArgs( { options: { ltcforge: { type: 'string' }, chromium: { type: 'string' }, pictures: { type: 'string' } } } );

/** Path of the program. */
export const LTCFORGE = values.ltcforge;

/** The folder for pictures; undefined without `--pictures`. */
export const PICTURES = values.pictures;

/** WebGL 2 with Mesa's software rasterizer. */
const FLAGS = [ '--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist' ];

/** Milliseconds after which a script fails. It takes up to a minute on an idle machine, and several beside all other tests. Scripts that write pictures wait for complete references. */
const DEADLINE = PICTURES ? 600_000 : 480_000;

/** A recipe of sixteen entries that takes milliseconds. */
export const SMALL = { preset: 'draft', resolution: { alpha: 2, ratio: 2, theta: 2, phi: 2 }, fit: { samples: 64, directions: 4, steps: 5 } };

/** A recipe that no script waits for. */
export const ENDLESS = { preset: 'best', resolution: { alpha: 16, ratio: 16, theta: 16, phi: 16 } };

async function freePort() {

	const server = createServer().listen( 0, '127.0.0.1' );
	await once( server, 'listening' );
	const { port } = server.address();
	server.close();
	await once( server, 'close' );
	return port;

}

/** A service on a port. It can be stopped, and started again with the same data. */
class Service {

	constructor( port, data, args ) {

		Object.assign( this, { port, data, args, url: `http://127.0.0.1:${ port }` } );

	}

	async start() {

		this.child = spawn( values.ltcforge, [ 'serve', '--listen', `127.0.0.1:${ this.port }`, '--data', this.data, ...this.args ], { cwd: this.data, stdio: [ 'ignore', 'pipe', 'ignore' ] } );
		// Otherwise the service would outlive an aborted script.
		process.on( 'exit', () => this.child.kill( 'SIGKILL' ) );
		const [ line ] = await Promise.race( [ once( createInterface( this.child.stdout ), 'line' ), once( this.child, 'exit' ) ] );
		if ( line !== `listening on ${ this.url }` ) throw new Error( `the service did not start: ${ line }` );

	}

	async stop() {

		if ( this.child.exitCode !== null ) return;
		this.child.kill( 'SIGTERM' );
		await once( this.child, 'exit' );

	}

	/** The JSON response of a successful call. Sends `this.token` if it is set. */
	async call( path, body, method = body === undefined ? 'GET' : 'POST' ) {

		const headers = { ...( body && { 'content-type': 'application/json' } ), ...( this.token && { authorization: `Bearer ${ this.token }` } ) };
		const init = { method, headers, body: body && JSON.stringify( body ), signal: AbortSignal.timeout( DEADLINE / 4 ) };
		const response = await fetch( `${ this.url }${ path }`, init );
		if ( response.ok ) return response.json();
		throw new Error( `${ method } ${ path }: ${ response.status } ${ await response.text() }` );

	}

	/** Submits a recipe whose table cannot be stored, and waits until the job has failed. */
	async fail( recipe ) {

		const blobs = join( this.data, 'blobs' );
		await rename( blobs, `${ blobs }.away` );
		await writeFile( blobs, '' );
		let job = await this.call( '/v1/jobs', recipe );
		while ( job.state !== 'failed' ) {

			await new Promise( ( done ) => setTimeout( done, 50 ) );
			job = await this.call( `/v1/jobs/${ job.id }` );

		}

		await rm( blobs );
		await rename( `${ blobs }.away`, blobs );
		return job.id;

	}

	/** The digest of the table of a recipe. */
	async fit( recipe ) {

		let job = await this.call( '/v1/jobs', recipe );
		while ( job.state === 'queued' || job.state === 'running' ) {

			await new Promise( ( done ) => setTimeout( done, 50 ) );
			job = await this.call( `/v1/jobs/${ job.id }` );

		}

		if ( ! job.table ) throw new Error( JSON.stringify( job ) );
		return job.table;

	}

}

/** What the jobs and the open pages show when a script fails. */
async function report( service, browser, complaints ) {

	const pages = browser?.contexts().flatMap( ( context ) => context.pages() ) ?? [];
	const shown = pages.map( async ( page ) => `${ page.url() }:\n${ await page.locator( 'body' ).innerText( { timeout: 5000 } ) }` );
	const jobs = service.call( '/v1/jobs' ).then( JSON.stringify );
	const parts = await Promise.allSettled( [ jobs, ...shown ] );
	return [ ...complaints, ...parts.map( ( { value, reason } ) => value ?? reason.message ) ].join( '\n\n' );

}

/**
 * Runs `work` with a service, a function that opens pages, and a list of complaints: errors of scripts and of the console, and
 * violations of the Content-Security-Policy. Prints the result of `work` with the complaints. `args` are arguments of the
 * service, `flags` are arguments of the browser.
 */
export async function withWorld( work, args = [], flags = [] ) {

	const deadline = setTimeout( () => {

		console.error( `not done after ${ DEADLINE / 1000 } s` );
		process.exit( 1 );

	}, DEADLINE );
	process.on( 'SIGTERM', () => process.exit( 1 ) );
	const data = await mkdtemp( join( tmpdir(), 'ltcforge-page-' ) );
	const service = new Service( await freePort(), data, args );
	const complaints = [];
	let browser = null;
	try {

		await service.start();
		browser = await chromium.launch( { executablePath: values.chromium, args: [ ...FLAGS, ...flags ], timeout: 0 } );
		const open = async ( hash, options = {}, base = service.url ) => {

			const context = await browser.newContext( { viewport: { width: 1280, height: 860 }, ...options } );
			const page = await context.newPage();
			page.setDefaultTimeout( DEADLINE / 2 );
			await page.exposeFunction( 'complain', ( text ) => complaints.push( text ) );
			await page.addInitScript( () => document.addEventListener( 'securitypolicyviolation', ( event ) => window.complain( `policy: ${ event.violatedDirective } ${ event.blockedURI }` ) ) );
			page.on( 'console', ( message ) => message.type() === 'error' && complaints.push( message.text() ) );
			page.on( 'pageerror', ( error ) => complaints.push( error.message ) );
			await page.goto( `${ base }/#/${ hash }` );
			return page;

		};

		const result = await work( { service, open, complaints } );
		console.log( JSON.stringify( { ...result, complaints } ) );

	} catch ( error ) {

		console.error( await report( service, browser, complaints ) );
		throw error;

	} finally {

		clearTimeout( deadline );
		if ( browser ) await browser.close();
		await service.stop();
		await rm( data, { recursive: true, force: true } );

	}

}
