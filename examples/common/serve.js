// Serves the examples. Run `npm start` in the folder of an example, and open the address that it prints.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import { basename, extname, join, resolve, sep } from 'node:path';
import { fileURLToPath } from 'node:url';

import { truth } from './truth.js';

const EXAMPLES = fileURLToPath( new URL( '..', import.meta.url ) );
const TYPES = { '.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.mjs': 'text/javascript', '.json': 'application/json' };

/** The most pixels along a side for which the truth is computed. */
const MOST_PIXELS = 1024;

/**
 * Serves files to this machine only.
 *
 * @param {Object<string, string>} folders - Folders by the prefix of their addresses; the longest matching prefix counts.
 * @param {Object<string, function(URLSearchParams): Promise<Uint8Array>>} answers - Functions that compute answers, by address.
 * @param {number} port - The port, or 0 for a free port.
 * @returns {Promise<import('node:http').Server>} The server, when it listens.
 */
export function serve( folders, answers = {}, port = 0 ) {

	const server = createServer( async ( request, response ) => {

		try {

			const { pathname, searchParams } = new URL( request.url, 'http://localhost' );
			const compute = answers[ pathname ];
			const file = compute ? pathname : fileOf( folders, decodeURIComponent( pathname ) );
			const body = compute ? await compute( searchParams ) : await readFile( file );
			const type = TYPES[ extname( file ) ] || 'application/octet-stream';
			response.writeHead( 200, { 'content-type': type, 'cache-control': 'no-store' } ).end( body );

		} catch ( error ) {

			const status = error.code === 'ENOENT' || error.code === 'EISDIR' ? 404 : 500;
			response.writeHead( status, { 'content-type': 'text/plain' } ).end( `${ error.message }\n` );

		}

	} );
	return new Promise( ( listening, failed ) => {

		server.on( 'error', failed ).listen( port, '127.0.0.1', () => listening( server ) );

	} );

}

/** The file at an address. Addresses outside the folder have no file. */
function fileOf( folders, pathname ) {

	const prefix = Object.keys( folders ).filter( ( start ) => pathname.startsWith( start ) ).sort( ( a, b ) => b.length - a.length )[ 0 ];
	const folder = prefix && resolve( folders[ prefix ] );
	const file = prefix && join( folder, pathname.slice( prefix.length ), pathname.endsWith( '/' ) ? 'index.html' : '' );
	if ( ! prefix || ! file.startsWith( folder + sep ) ) throw Object.assign( new Error( `no file at ${ pathname }` ), { code: 'ENOENT' } );
	return file;

}

/** The program: LTCFORGE in the environment, or the program that this repository builds, or `ltcforge` on the path. */
export function program() {

	const built = [ 'release', 'debug' ].map( ( profile ) => join( EXAMPLES, '../target', profile, 'ltcforge' ) );
	return process.env.LTCFORGE || built.find( ( path ) => existsSync( path ) ) || 'ltcforge';

}

/** The most lights. */
const MOST_LIGHTS = 8;

/** The truth for an address such as `?width=96&height=64&lights=1`. */
export async function truthAnswer( query ) {

	const [ width, height, lights ] = [ [ 'width', MOST_PIXELS ], [ 'height', MOST_PIXELS ], [ 'lights', MOST_LIGHTS ] ].map( ( [ name, most ] ) => {

		const number = Number( query.get( name ) );
		if ( ! Number.isInteger( number ) || number < 1 || number > most ) {

			throw new Error( `${ name } is ${ query.get( name ) }: it must be a whole number from 1 to ${ most }` );

		}

		return number;

	} );
	const pixels = await truth( program(), width, height, lights );
	return new Uint8Array( pixels.buffer );

}

if ( process.argv[ 1 ] && resolve( process.argv[ 1 ] ) === fileURLToPath( import.meta.url ) ) {

	const server = await serve( { '/': EXAMPLES }, { '/truth': truthAnswer }, Number( process.env.PORT || 8080 ) );
	console.log( `http://127.0.0.1:${ server.address().port }/${ basename( process.cwd() ) }/` );

}
