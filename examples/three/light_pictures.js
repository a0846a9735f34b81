// Pictures on rectangular lights: their prefiltered pyramids, computed on the GPU whenever a picture changes. The passes come from
// `ltcforge shader --as prefilter --language glsl-es`.

import {
	BufferGeometry, Camera, Float32BufferAttribute, GLSL3, HalfFloatType, LinearFilter, LinearMipmapLinearFilter, Mesh, NearestFilter,
	NoBlending, RawShaderMaterial, Vector2, WebGLArrayRenderTarget, WebGLRenderTarget,
} from 'three';

/** The code of each pass by name. It sets the colour at `texel`; `size` is the size of `source`. */
const PASSES = {
	// Rows start at the top. three keeps frames of a video in sRGB.
	picture: `vec2 at = gl_FragCoord.xy / vec2( size );
		vec3 shown = texture( prefilter_source, vec2( at.x, isFromBottom ? 1.0 - at.y : at.y ) ).rgb;
		vec3 decoded = mix( shown / 12.92, pow( ( shown + 0.055 ) / 1.055, vec3( 2.4 ) ), step( 0.04045, shown ) );
		colour = isCoded ? decoded : shown;`,
	halved: 'colour = prefilter_halved( texel, prefilter_size( size, level - 1u ), prefilter_size( size, level ) );',
	row: 'colour = prefilter_row( texel.y, size.x );',
	mean: 'colour = prefilter_mean( size.y );',
	level: 'colour = prefilter_level( texel, size, level );',
	copy: 'colour = texelFetch( prefilter_source, ivec2( texel ), 0 ).rgb;',
};

/** An array with a layer for each of the first lights of a scene, with all levels, and the uniforms of a surface's shader. */
export class LightPictures {

	/**
	 * @param {string} prefilterGlsl - The output of `ltcforge shader --as prefilter --language glsl-es`.
	 * @param {number} width - Texels of a picture along a light's width; they should be square on the light.
	 * @param {number} height - Texels of a picture along a light's height.
	 * @param {number} [layers] - The number of lights with pictures: the first lights of the scene, in three's order.
	 */
	constructor( prefilterGlsl, width, height, layers = 1 ) {

		if ( typeof prefilterGlsl !== 'string' || ! prefilterGlsl.includes( 'prefilter_level(' ) ) {

			throw new TypeError( 'the shader must be the output of `ltcforge shader --as prefilter --language glsl-es`' );

		}

		const faults = Object.entries( { width, height, layers } ).filter( ( [ , value ] ) => ! Number.isInteger( value ) || value < 1 );
		if ( faults.length ) throw new RangeError( faults.map( ( [ name, value ] ) => `${ name } is ${ value }: it must be a whole number of at least 1` ).join( '; ' ) );

		const size = new Vector2( width, height );
		const count = 1 + Math.floor( Math.log2( Math.max( width, height ) ) );
		const sizeOf = ( level ) => [ Math.max( width >> level, 1 ), Math.max( height >> level, 1 ) ];
		const flat = ( sides ) => new WebGLRenderTarget( ...sides, { type: HalfFloatType, depthBuffer: false, minFilter: NearestFilter, magFilter: NearestFilter } );
		this.layers = layers;
		this.chain = Array.from( { length: Math.max( count - 1, 1 ) }, ( _, level ) => flat( sizeOf( level ) ) );
		this.rows = flat( [ 1, height ] );
		this.levels = Array.from( { length: count }, ( _, level ) => flat( sizeOf( level ) ) );
		this.array = new WebGLArrayRenderTarget( width, height, layers, {
			type: HalfFloatType, depthBuffer: false, generateMipmaps: false, minFilter: LinearMipmapLinearFilter, magFilter: LinearFilter,
		} );
		// three allocates an image for each level.
		this.array.texture.mipmaps = this.levels.map( () => ( {} ) );

		const uniforms = {
			prefilter_source: { value: null }, prefilter_above: { value: null },
			size: { value: size }, level: { value: 0 }, isFromBottom: { value: false }, isCoded: { value: false },
		};
		this.passes = Object.fromEntries( Object.entries( PASSES ).map( ( [ name, body ] ) => [ name, new RawShaderMaterial( {
			uniforms, glslVersion: GLSL3, depthTest: false, depthWrite: false, blending: NoBlending,
			vertexShader: 'in vec3 position;\nvoid main() { gl_Position = vec4( position, 1.0 ); }',
			fragmentShader: `${ prefilterGlsl }
				uniform uvec2 size;
				uniform uint level;
				uniform bool isFromBottom;
				uniform bool isCoded;
				out vec4 written;
				void main() {
					uvec2 texel = uvec2( gl_FragCoord.xy );
					vec3 colour;
					${ body }
					// Numbers have 16 bits.
					written = vec4( min( colour, vec3( 65504.0 ) ), 1.0 );
				}`,
		} ) ] ) );
		this.values = uniforms;
		const triangle = new BufferGeometry().setAttribute( 'position', new Float32BufferAttribute( [ - 1, - 1, 0, 3, - 1, 0, - 1, 3, 0 ], 3 ) );
		this.screen = new Mesh( triangle );
		this.screen.frustumCulled = false;

		/** The uniforms of a surface's shader. */
		this.uniforms = {
			normals_pictures: { value: this.array.texture },
			rect_area_pictures: { value: layers },
			rect_area_picture_base: { value: Math.log2( Math.sqrt( width * height ) ) - 1 },
		};

	}

	/**
	 * Prefilters a picture. Call this whenever it changes, such as for each frame of a video, before the surfaces are drawn.
	 *
	 * @param {import('three').WebGLRenderer} renderer - The renderer.
	 * @param {import('three').Texture} texture - A picture, canvas or video, in `SRGBColorSpace` or linear. A texture of another
	 * size is resampled.
	 * @param {number} [layer] - The number of the light.
	 */
	update( renderer, texture, layer = 0 ) {

		if ( ! texture || ! texture.isTexture ) throw new TypeError( 'the picture must be a texture of three.js' );
		if ( ! Number.isInteger( layer ) || layer < 0 || layer >= this.layers ) throw new RangeError( `layer is ${ layer }: it must be a whole number from 0 to ${ this.layers - 1 }` );
		const before = [ renderer.getRenderTarget(), renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel() ];
		const isXr = renderer.xr.enabled;
		renderer.xr.enabled = false;
		// The first row of an image is its top, unless three flips it. The first row of a render target or of data is the bottom.
		this.values.isFromBottom.value = [ 'flipY', 'isRenderTargetTexture', 'isDataTexture' ].some( ( name ) => texture[ name ] === true );
		this.values.isCoded.value = texture.isVideoTexture === true && texture.colorSpace === 'srgb';

		const { chain, rows, levels } = this;
		const last = levels.length - 1;
		const draw = ( name, to, level, source, above = null ) => this.draw( renderer, name, to, level, source.texture || source, above );
		draw( 'picture', [ chain[ 0 ] ], 0, texture );
		for ( let level = 1; level < last; level ++ ) draw( 'halved', [ chain[ level ] ], level, chain[ level - 1 ] );
		draw( 'row', [ rows ], 0, chain[ 0 ] );
		draw( 'mean', [ levels[ last ] ], last, rows );
		for ( let level = last - 1; level >= 0; level -- ) draw( 'level', [ levels[ level ] ], level, chain[ level ], levels[ level + 1 ].texture );
		levels.forEach( ( from, level ) => {

			// three uses the target's viewport for every level.
			this.array.viewport.set( 0, 0, from.width, from.height );
			draw( 'copy', [ this.array, layer, level ], level, from );

		} );
		renderer.xr.enabled = isXr;
		renderer.setRenderTarget( ...before );

	}

	/** Runs a pass into a target, with its layer and level. */
	draw( renderer, name, to, level, source, above ) {

		this.values.prefilter_source.value = source;
		this.values.prefilter_above.value = above;
		this.values.level.value = level;
		this.screen.material = this.passes[ name ];
		renderer.setRenderTarget( ...to );
		renderer.render( this.screen, CAMERA );

	}

	/** Frees the textures. Call this when no material uses them. */
	dispose() {

		for ( const owned of [ ...this.chain, this.rows, ...this.levels, this.array, ...Object.values( this.passes ), this.screen.geometry ] ) owned.dispose();

	}

}

const CAMERA = new Camera();
