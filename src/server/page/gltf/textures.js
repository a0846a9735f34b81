// Textures of glTF materials: PNG and JPEG images inside the file, within bounds that their headers are held to before they
// are decoded. What is left out is noted with its reason, and the material's factors are shown in its place.

/** Pixels of a side of an image, and of all images that are kept. */
const [ MOST_SIDE, MOST_PIXELS ] = [ 4096, 2 ** 25 ];
const [ REPEAT, CLAMP, MIRROR ] = [ 10497, 33071, 33648 ];

/** The textures that are shown: their names for shaders, and where a material has them. */
const SHOWN = [
	[ 'base_texture', 'baseColorTexture', ( { pbrMetallicRoughness } ) => pbrMetallicRoughness ],
	[ 'rough_texture', 'metallicRoughnessTexture', ( { pbrMetallicRoughness } ) => pbrMetallicRoughness ],
	[ 'normal_texture', 'normalTexture', ( material ) => material ],
];

/** What stands for an image that a textured material lacks: one pixel that leaves its factors as they are, in the order of SHOWN. */
const NO_IMAGES = Object.fromEntries( SHOWN.map( ( [ name ] ) => [ name, { pixel: new Uint8Array( [ 255, 255, 255, 255 ] ), wrap: [ CLAMP, CLAMP ] } ] ) );

/** The type and extents of an image by its first bytes; null where it is neither PNG nor JPEG. */
export function header( bytes ) {

	const view = new DataView( bytes.buffer, bytes.byteOffset, bytes.byteLength );
	if ( bytes.length >= 24 && view.getUint32( 0 ) === 0x89504e47 && view.getUint32( 4 ) === 0x0d0a1a0a ) return { type: 'image/png', width: view.getUint32( 16 ), height: view.getUint32( 20 ) };
	if ( bytes.length < 4 || view.getUint16( 0 ) !== 0xffd8 ) return null;
	// Segments up to the start of a frame, ITU-T T.81, B.1.1.
	for ( let at = 2; at + 9 <= bytes.length && bytes[ at ] === 0xff; at += 2 + view.getUint16( at + 2 ) ) {

		const marker = bytes[ at + 1 ];
		if ( marker >= 0xc0 && marker <= 0xcf && ! [ 0xc4, 0xc8, 0xcc ].includes( marker ) ) return { type: 'image/jpeg', width: view.getUint16( at + 7 ), height: view.getUint16( at + 5 ) };

	}

	return null;

}

/** The bytes of an image inside the file. */
function bytesOf( { bufferView, uri }, index, document, bufferOf ) {

	if ( bufferView === undefined ) {

		const [ , data ] = /^data:[^,]*;base64,(.*)$/s.exec( uri || '' ) || [];
		if ( data === undefined ) throw new Error( `images/${ index } is not in the file` );
		return Uint8Array.from( atob( data ), ( byte ) => byte.charCodeAt( 0 ) );

	}

	const { buffer, byteOffset = 0, byteLength } = document.bufferViews?.[ bufferView ] || {};
	const whole = bufferOf( buffer );
	if ( ! ( Number.isInteger( byteOffset ) && Number.isInteger( byteLength ) && byteOffset >= 0 && byteLength > 0 && byteOffset + byteLength <= whole.byteLength ) ) throw new Error( `images/${ index } ends behind its buffer` );
	return new Uint8Array( whole, byteOffset, byteLength );

}

/** What finds the textures of materials, each image once a way of reading it; `notes` gets what is left out. */
export function textureReader( document, bufferOf, notes ) {

	const known = new Map();
	let pixels = 0;

	async function decoded( index, isColour, wrap ) {

		const image = document.images?.[ index ];
		if ( ! image ) throw new Error( 'its image is not there, or of a format that is not read here' );
		const bytes = bytesOf( image, index, document, bufferOf );
		const found = header( bytes );
		if ( ! found ) throw new Error( `images/${ index } is neither PNG nor JPEG` );
		const { type, width, height } = found;
		if ( Math.max( width, height ) > MOST_SIDE ) throw new Error( `images/${ index } has ${ width } x ${ height } pixels; at most ${ MOST_SIDE } a side are shown` );
		if ( ( pixels += width * height ) > MOST_PIXELS ) throw new Error( `images/${ index } is behind the first ${ MOST_PIXELS } pixels` );
		try {

			return { isColour, wrap, image: await createImageBitmap( new Blob( [ bytes ], { type } ), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' } ) };

		} catch {

			throw new Error( `images/${ index } cannot be decoded` );

		}

	}

	async function one( name, { index, texCoord = 0, extensions } ) {

		if ( texCoord !== 0 ) throw new Error( `it is of TEXCOORD_${ texCoord }` );
		if ( extensions?.KHR_texture_transform ) throw new Error( 'it has a KHR_texture_transform' );
		const { source, sampler } = document.textures?.[ index ] || {};
		const { wrapS = REPEAT, wrapT = REPEAT } = document.samplers?.[ sampler ] || {};
		const wrap = [ wrapS, wrapT ].map( ( way ) => [ REPEAT, CLAMP, MIRROR ].includes( way ) ? way : REPEAT );
		const key = JSON.stringify( [ source, name === 'base_texture', wrap ] );
		if ( ! known.has( key ) ) known.set( key, decoded( source, name === 'base_texture', wrap ) );
		return known.get( key );

	}

	/** The textures of a material by their names, in one order; null where there are none to show. `isBent` says whether normals are among them. */
	return async ( material, hasPlaces ) => {

		const found = {};
		for ( const [ name, member, of ] of SHOWN ) {

			const texture = of( material )?.[ member ];
			if ( ! texture ) continue;
			try {

				if ( ! hasPlaces ) throw new Error( 'there is no TEXCOORD_0' );
				found[ name ] = await one( name, texture );

			} catch ( error ) {

				notes.add( `${ member } is left out: ${ error.message }` );

			}

		}

		const others = JSON.stringify( material, ( key, value ) => SHOWN.some( ( [ , member ] ) => member === key ) ? undefined : value );
		if ( /"index":/.test( others ) ) notes.add( 'of other textures than base colour, metal, roughness and normals the factors are shown' );
		return { textures: Object.keys( found ).length ? { ...NO_IMAGES, ...found } : null, isBent: Boolean( found.normal_texture ) };

	};

}
