// Reads ZIP archives without compression.

import { gzipSync } from 'node:zlib';

/** The text of each file of an archive. Checks its checksums with those of gzip. */
export function unzipped( bytes ) {

	const files = {};
	for ( let at = 0; bytes.readUInt32LE( at ) === 0x04034b50; ) {

		const [ checksum, length, name ] = [ bytes.readUInt32LE( at + 14 ), bytes.readUInt32LE( at + 22 ), bytes.readUInt16LE( at + 26 ) ];
		const data = bytes.subarray( at + 30 + name, at + 30 + name + length );
		if ( gzipSync( data ).readUInt32LE( gzipSync( data ).length - 8 ) !== checksum ) throw new Error( 'wrong checksum' );
		files[ bytes.toString( 'utf8', at + 30, at + 30 + name ) ] = data.toString();
		at += 30 + name + length;

	}

	return files;

}
