// Packs files into a ZIP archive without compression [APPNOTE 6.3.10, sections 4.3.7 to 4.3.16], and saves files.

import { el } from '../elements/dom.js';

/** Remainders of all bytes for the CRC-32 polynomial 0xedb88320. */
const TABLE = Uint32Array.from( { length: 256 }, ( _, i ) => {
	for ( let bit = 0; bit < 8; bit ++ ) i = i & 1 ? i >>> 1 ^ 0xedb88320 : i >>> 1;
	return i;
} );
const crc32 = ( bytes ) => ~ bytes.reduce( ( sum, byte ) => sum >>> 8 ^ TABLE[ ( sum ^ byte ) & 255 ], - 1 ) >>> 0;

/** The parts of a record: numbers of two or four bytes, given as `[ size, number ]`, and bytes. */
function record( ...parts ) {
	return parts.flatMap( ( part ) => Array.isArray( part ) ? Array.from( { length: part[ 0 ] }, ( _, i ) => part[ 1 ] >>> 8 * i & 255 ) : [ ...part ] );
}

/** A ZIP archive of files with a path and bytes. All dates are 1980-01-01, so equal files give equal archives. */
export function zip( files ) {
	let at = 0;
	const [ bodies, entries ] = [ [], [] ];
	for ( const { path, bytes } of files ) {
		const name = new TextEncoder().encode( path );
		// Version 2.0, names in UTF-8, method 0, time 0, date 1980-01-01, checksum, both sizes, length of the name, no extra field.
		const shared = [ [ 2, 20 ], [ 2, 0x800 ], [ 2, 0 ], [ 2, 0 ], [ 2, 0x21 ], [ 4, crc32( bytes ) ], [ 4, bytes.length ], [ 4, bytes.length ], [ 2, name.length ], [ 2, 0 ] ];
		const header = Uint8Array.from( record( [ 4, 0x04034b50 ], ...shared, name ) );
		entries.push( record( [ 4, 0x02014b50 ], [ 2, 20 ], ...shared, [ 2, 0 ], [ 2, 0 ], [ 2, 0 ], [ 4, 0 ], [ 4, at ], name ) );
		bodies.push( header, bytes );
		at += header.length + bytes.length;
	}
	const directory = Uint8Array.from( entries.flat() );
	const end = Uint8Array.from( record( [ 4, 0x06054b50 ], [ 2, 0 ], [ 2, 0 ], [ 2, files.length ], [ 2, files.length ], [ 4, directory.length ], [ 4, at ], [ 2, 0 ] ) );
	return new Blob( [ ...bodies, directory, end ], { type: 'application/zip' } );
}

/** Saves a blob as a download. */
export function saveAs( blob, name ) {
	const link = el( 'a', { href: URL.createObjectURL( blob ), download: name } );
	link.click();
	// By then the browser has read the file.
	setTimeout( () => URL.revokeObjectURL( link.href ), 60_000 );
}
