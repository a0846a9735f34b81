// Textures of glTF materials: PNG and JPEG images inside the file. The size in the header is checked before an image is
// decoded. If a texture is not shown, a note says why, and only the material's factors are used.

/** Limits: pixels per side of an image, and pixels of all images. */
const [ MOST_SIDE, MOST_PIXELS ] = [ 4096, 2 ** 25 ];
const [ REPEAT, CLAMP, MIRROR ] = [ 10497, 33071, 33648 ];

/** The supported textures: name in shaders, and place in a material. */
const SHOWN = [
	[ 'base_texture', 'baseColorTexture', ( { pbrMetallicRoughness } ) => pbrMetallicRoughness ],
	[ 'rough_texture', 'metallicRoughnessTexture', ( { pbrMetallicRoughness } ) => pbrMetallicRoughness ],
	[ 'normal_texture', 'normalTexture', ( material ) => material ],
];

/** The image for a missing texture of a textured material: one white pixel, which does not change the factors. */
const NO_IMAGES = Object.fromEntries( SHOWN.map( ( [ name ] ) => [ name, { pixel: new Uint8Array( [ 255, 255, 255, 255 ] ), wrap: [ CLAMP, CLAMP ] } ] ) );

/** Type and size of an image from its header; null if it is neither PNG nor JPEG. */
export function header( bytes ) {
	const view = new DataView( bytes.buffer, bytes.byteOffset, bytes.byteLength );
	if ( bytes.length >= 24 && view.getUint32( 0 ) === 0x89504e47 && view.getUint32( 4 ) === 0x0d0a1a0a ) return { type: 'image/png', width: view.getUint32( 16 ), height: view.getUint32( 20 ) };
	if ( bytes.length < 4 || view.getUint16( 0 ) !== 0xffd8 ) return null;
	// Segments up to the start of a frame [ITU-T T.81, B.1.1].
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
		if ( data === undefined ) throw new Error( `images/${ index } is not inside the file` );
		return Uint8Array.from( atob( data ), ( byte ) => byte.charCodeAt( 0 ) );
	}
	const { buffer, byteOffset = 0, byteLength } = document.bufferViews?.[ bufferView ] || {};
	const whole = bufferOf( buffer );
	if ( ! ( Number.isInteger( byteOffset ) && Number.isInteger( byteLength ) && byteOffset >= 0 && byteLength > 0 && byteOffset + byteLength <= whole.byteLength ) ) throw new Error( `images/${ index } ends after the end of its buffer` );
	return new Uint8Array( whole, byteOffset, byteLength );
}

/** Returns a function that reads the textures of a material. An image is decoded once for each use. If a texture is not shown, the reason is added to `notes`. */
export function textureReader( document, bufferOf, notes ) {
	const known = new Map();
	let pixels = 0;

	async function decoded( index, isColour, wrap ) {
		const image = document.images?.[ index ];
		if ( ! image ) throw new Error( 'its image is missing, or its format is not supported' );
		const bytes = bytesOf( image, index, document, bufferOf );
		const found = header( bytes );
		if ( ! found ) throw new Error( `images/${ index } is neither PNG nor JPEG` );
		const { type, width, height } = found;
		if ( Math.max( width, height ) > MOST_SIDE ) throw new Error( `images/${ index } has ${ width } x ${ height } pixels; the limit is ${ MOST_SIDE } per side` );
		if ( ( pixels += width * height ) > MOST_PIXELS ) throw new Error( `images/${ index } exceeds the limit of ${ MOST_PIXELS } pixels for all images` );
		try {
			return { isColour, wrap, image: await createImageBitmap( new Blob( [ bytes ], { type } ), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' } ) };
		} catch {
			throw new Error( `images/${ index } cannot be decoded` );
		}
	}

	async function textureOf( name, { index, texCoord = 0, extensions } ) {
		if ( texCoord !== 0 ) throw new Error( `it uses TEXCOORD_${ texCoord }; only TEXCOORD_0 is supported` );
		if ( extensions?.KHR_texture_transform ) throw new Error( 'KHR_texture_transform is not supported' );
		const { source, sampler } = document.textures?.[ index ] || {};
		const { wrapS = REPEAT, wrapT = REPEAT } = document.samplers?.[ sampler ] || {};
		const wrap = [ wrapS, wrapT ].map( ( way ) => [ REPEAT, CLAMP, MIRROR ].includes( way ) ? way : REPEAT );
		const key = JSON.stringify( [ source, name === 'base_texture', wrap ] );
		if ( ! known.has( key ) ) known.set( key, decoded( source, name === 'base_texture', wrap ) );
		return known.get( key );
	}

	/** The textures of a material by their names in shaders, or null if none of them can be shown. `isBent` is true if there is a normal texture. */
	return async ( material, hasPlaces ) => {
		const found = {};
		for ( const [ name, member, of ] of SHOWN ) {
			const texture = of( material )?.[ member ];
			if ( ! texture ) continue;
			try {
				if ( ! hasPlaces ) throw new Error( 'TEXCOORD_0 is missing' );
				found[ name ] = await textureOf( name, texture );
			} catch ( error ) {
				notes.add( `${ member } is not shown: ${ error.message }` );
			}
		}
		const others = JSON.stringify( material, ( key, value ) => SHOWN.some( ( [ , member ] ) => member === key ) ? undefined : value );
		if ( /"index":/.test( others ) ) notes.add( 'only base colour, metallic-roughness and normal textures are shown; factors replace all other textures' );
		return { textures: Object.keys( found ).length ? { ...NO_IMAGES, ...found } : null, isBent: Boolean( found.normal_texture ) };
	};
}
