// Reads KTX2 files with ktx-parse, and zstd texels with the decoder of three.js. Prints the contents of each file as
// JSON.
//
//   node ktx.js FILE...

import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';

import { KHR_SUPERCOMPRESSION_ZSTD, read } from 'ktx-parse';
import { ZSTDDecoder } from 'three/examples/jsm/libs/zstddec.module.js';

const zstd = new ZSTDDecoder();
await zstd.init();

const found = process.argv.slice( 2 ).map( ( path ) => {

	const file = read( readFileSync( path ) );
	const [ descriptor ] = file.dataFormatDescriptor;
	const [ level ] = file.levels;
	const isPacked = file.supercompressionScheme === KHR_SUPERCOMPRESSION_ZSTD;
	const texels = isPacked ? zstd.decode( level.levelData, level.uncompressedByteLength ) : level.levelData;
	return {
		format: file.vkFormat, typeSize: file.typeSize,
		sides: [ file.pixelWidth, file.pixelHeight, file.pixelDepth ],
		layers: file.layerCount, faces: file.faceCount, levels: file.levels.length,
		scheme: file.supercompressionScheme, stored: level.levelData.length, length: level.uncompressedByteLength,
		digest: createHash( 'sha256' ).update( texels ).digest( 'hex' ),
		keys: Object.keys( file.keyValue ),
		bits: descriptor.samples.map( ( sample ) => sample.bitLength + 1 ),
	};

} );
console.log( JSON.stringify( found ) );
