// The models that light the surface: tables of the service, models without a table, and published tables.

import { call, manifest, reach } from '../service/api.js';
import { hasReference } from '../webgl/shaders.js';

/** The label of the model whose name in a link is empty on the left side and `normals` on the right side. */
export const NORMALS = 'closed form: normals';

/** Other models that are no tables of the service: name in a link, and label. */
export const NAMED = { 'normals-fast': `${ NORMALS }, rule fast`, 'normals-fine': `${ NORMALS }, rule fine`, 'ltc-formula': 'closed form: ltc-formula', engines: 'engine table (LTC 2017)', kt2022: 'anisotropic table of KT et al. 2022' };

async function fetched( path ) {
	const response = await reach( path );
	if ( ! response.ok ) throw new Error( `${ path }: the service returned status ${ response.status }` );
	return response;
}

/** Size and texels of an uncompressed KTX2 file with floats of 32 or 16 bits. */
function texels( buffer ) {
	const view = new DataView( buffer );
	const word = ( at ) => view.getUint32( at, true );
	// Header: KTX 2.0 specification, section 3. Formats: R32G32B32A32_SFLOAT and R16G16B16A16_SFLOAT.
	const [ name, Of ] = { 109: [ 'numbers', Float32Array ], 97: [ 'halves', Uint16Array ] }[ word( 12 ) ] || [];
	if ( ! Of || word( 44 ) !== 0 ) throw new Error( 'the texture must be uncompressed, with four floats per texel' );
	const [ width, height, depth ] = [ word( 20 ), word( 24 ), Math.max( word( 28 ), 1 ) ];
	return { width, height, depth, [ name ]: new Of( buffer.slice( word( 80 ), word( 80 ) + 4 * Of.BYTES_PER_ELEMENT * width * height * depth ) ) };
}

const known = new Map();

/** The result of `make` for a name. Later calls return the first result. */
async function once( name, make ) {
	if ( ! known.has( name ) ) known.set( name, await make( name ) );
	return known.get( name );
}

/** A shader text of the service. */
export const textOf = ( file ) => once( file, async () => ( await fetched( `/page/${ file }` ) ).text() );

/** The textures and uniforms of a table, as `ltcforge export --for wgpu` writes them. */
async function tableOf( at ) {
	const { ltc_table: members, textures: files } = await call( `${ at }ltc.json` );
	const textures = await Promise.all( files.map( async ( file ) => ( { name: file.replace( '.ktx2', '' ), ...texels( await ( await fetched( `${ at }${ file }` ) ).arrayBuffer() ) } ) ) );
	return { uniforms: Object.fromEntries( Object.entries( members ).map( ( [ member, value ] ) => [ `ltc_table.${ member }`, value ] ) ), textures };
}

/** A texture of the table of 2017: a DDS file with a header of 128 bytes and 64 x 64 texels of half floats. */
async function shipped( name, file ) {
	return { name, width: 64, height: 64, halves: new Uint16Array( await ( await fetched( `/page/${ file }` ) ).arrayBuffer(), 128, 4 * 64 * 64 ) };
}

/** The reason why the viewer cannot show a table, or an empty text. The viewer's shaders support only LTCs, and its reference supports few scattering models. */
function unsupported( { brdf, lobe } ) {
	if ( ! hasReference( brdf ) ) return `The viewer can compute the truth only for GGX and sheen, not for ${ brdf }. The table’s page shows a picture with a reference.`;
	return lobe ? `The viewer shows only LTCs, and this table has lobes of type ${ lobe }. The table’s page shows a picture.` : '';
}

/**
 * Loads a model by its name in a link: '' (normals), a name in `NAMED`, or a table's digest. `kind` selects the
 * program, and `source` is the name of the service's shader text. `brdf` is the scattering model.
 */
async function found( name ) {
	if ( name === 'engines' ) return { kind: 'engines', brdf: 'ggx', source: null, uniforms: {}, textures: await Promise.all( [ shipped( 'shipped_matrix', 'published/ltc2017_1.dds' ), shipped( 'shipped_terms', 'published/ltc2017_2.dds' ) ] ) };
	if ( name === 'kt2022' ) return { kind: 'one', brdf: 'ggx', source: 'ltc-kt2022', ...await tableOf( '/page/kt2022-' ) };
	if ( name === 'ltc-formula' ) return { kind: 'formula', brdf: 'ggx', source: name, uniforms: {}, textures: [] };
	if ( ! name || name.startsWith( 'normals' ) ) return { kind: 'normals', brdf: 'ggx', source: name || 'normals', uniforms: {}, textures: [] };
	const { recipe } = await manifest( name );
	const reason = unsupported( recipe );
	if ( reason ) throw new Error( reason );
	const kind = typeof recipe.fresnel === 'string' ? recipe.fresnel : 'one';
	return { kind, brdf: recipe.brdf, source: `ltc-${ recipe.layout }${ kind === 'one' ? '' : '-two-lobes' }`, ...await tableOf( `/v1/tables/${ name }/exports/wgpu/` ) };
}

/** Loads a model with its shader text, with or without pictures on lights. */
export async function modelOf( name, hasPictures ) {
	const model = await once( `model ${ name }`, () => found( name ) );
	return { ...model, text: model.source ? await textOf( `${ model.source }${ hasPictures ? '-textured' : '' }.glsl` ) : '' };
}
