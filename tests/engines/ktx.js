// Reads KTX2 files with ktx-parse and prints as JSON what it finds in each.
//
//   node ktx.js FILE...

import { readFileSync } from 'node:fs';

import { read } from 'ktx-parse';

const found = process.argv.slice( 2 ).map( ( path ) => {

	const file = read( readFileSync( path ) );
	const [ descriptor ] = file.dataFormatDescriptor;
	const [ level ] = file.levels;
	return {
		format: file.vkFormat, typeSize: file.typeSize,
		sides: [ file.pixelWidth, file.pixelHeight, file.pixelDepth ],
		layers: file.layerCount, faces: file.faceCount, levels: file.levels.length,
		scheme: file.supercompressionScheme, stored: level.levelData.length, length: level.uncompressedByteLength,
		keys: Object.keys( file.keyValue ),
		bits: descriptor.samples.map( ( sample ) => sample.bitLength + 1 ),
	};

} );
console.log( JSON.stringify( found ) );
