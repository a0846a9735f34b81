// The models by which the viewer lights: the service's tables, model normals, and tables that others published.

import { call, manifest, reach } from '../service/api.js';
import { hasReference } from '../webgl/reference.js';

/** The names in a link of published tables: what engines ship, and that of KT et al. */
export const PUBLISHED = { engines: 'engines, table of 2017', kt2022: 'KT et al., table of 2022' };

async function fetched( path ) {

	const response = await reach( path );
	if ( ! response.ok ) throw new Error( `${ path }: the answer was ${ response.status }` );
	return response;

}

/** The texels of a KTX2 file of 32-bit numbers without levels: their bytes and the extents. */
function texels( buffer ) {

	const view = new DataView( buffer );
	const word = ( at ) => view.getUint32( at, true );
	// The header is that of section 3 of the KTX 2.0 specification; format 109 is R32G32B32A32_SFLOAT.
	if ( word( 12 ) !== 109 || word( 44 ) !== 0 ) throw new Error( 'the texture is not of 32-bit numbers' );
	const [ width, height, depth ] = [ word( 20 ), word( 24 ), Math.max( word( 28 ), 1 ) ];
	return { width, height, depth, numbers: new Float32Array( buffer.slice( word( 80 ), word( 80 ) + 16 * width * height * depth ) ) };

}

const known = new Map();

/** What `make` gives, kept by a name that always stands for the same. */
async function once( name, make ) {

	if ( ! known.has( name ) ) known.set( name, await make( name ) );
	return known.get( name );

}

/** A text of the service to include. */
export const textOf = ( file ) => once( file, async () => ( await fetched( `/page/${ file }` ) ).text() );

/** The textures and uniforms of a table, as `ltcforge export --for wgpu` makes them. */
async function tableOf( at ) {

	const { ltc_table: members, textures: files } = await call( `${ at }ltc.json` );
	const textures = await Promise.all( files.map( async ( file ) => ( { name: file.replace( '.ktx2', '' ), ...texels( await ( await fetched( `${ at }${ file }` ) ).arrayBuffer() ) } ) ) );
	return { uniforms: Object.fromEntries( Object.entries( members ).map( ( [ member, value ] ) => [ `ltc_table.${ member }`, value ] ) ), textures };

}

/** A published table of 2017, a DDS file of 64 x 64 half floats behind a header of 128 bytes. */
async function shipped( name, file ) {

	return { name, width: 64, height: 64, halves: new Uint16Array( await ( await fetched( `/page/${ file }` ) ).arrayBuffer(), 128, 4 * 64 * 64 ) };

}

/** Why a table is not shown: the text reads LTCs, and the reference beside it knows few scattering models. */
function unfit( { brdf, lobe, layout } ) {

	if ( ! hasReference( brdf ) ) return `The reference here is of GGX and sheen, and this table is of ${ brdf }; its page has a picture beside its own.`;
	if ( layout === 'materials' ) return 'This table is of a list of materials, which a shader looks up by number; its page has a picture.';
	return lobe ? `This table is of lobe ${ lobe }, and the shader here reads LTCs.` : '';

}

/**
 * A model by its name in a link: '' for normals, one of those that are published, or a table's digest. `kind` says which
 * program, `source` which text of the service, `brdf` the scattering model that it stands for.
 */
async function found( name ) {

	if ( name === 'engines' ) return { kind: 'engines', brdf: 'ggx', source: null, uniforms: {}, textures: await Promise.all( [ shipped( 'shipped_matrix', 'published/ltc2017_1.dds' ), shipped( 'shipped_terms', 'published/ltc2017_2.dds' ) ] ) };
	if ( name === 'kt2022' ) return { kind: 'one', brdf: 'ggx', source: 'ltc-kt2022', ...await tableOf( '/page/kt2022-' ) };
	if ( ! name ) return { kind: 'normals', brdf: 'ggx', source: 'normals', uniforms: {}, textures: [] };
	const { recipe } = await manifest( name );
	const reason = unfit( recipe );
	if ( reason ) throw new Error( reason );
	const kind = typeof recipe.fresnel === 'string' ? recipe.fresnel : 'one';
	return { kind, brdf: recipe.brdf, source: `ltc-${ recipe.layout }${ kind === 'one' ? '' : '-two-lobes' }`, ...await tableOf( `/v1/tables/${ name }/exports/wgpu/` ) };

}

/** Such a model with its text, which knows pictures on lights or does not. */
export async function modelOf( name, hasPictures ) {

	const model = await once( `model ${ name }`, () => found( name ) );
	return { ...model, text: model.source ? await textOf( `${ model.source }${ hasPictures ? '-textured' : '' }.glsl` ) : '' };

}
