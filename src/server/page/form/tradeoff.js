// A chart of error against size. It shows the recipe and the tables of the service.

import { svg } from '../elements/dom.js';
import { bytes, percent } from '../elements/format.js';
import { call } from '../service/api.js';

const [ WIDTH, HEIGHT, LEFT, TOP, BOTTOM ] = [ 240, 164, 24, 8, 32 ];
/** Marks on the logarithmic axes. A point outside of the marks is drawn at the edge. */
const ERRORS = [ 0.02, 0.05, 0.1, 0.2, 0.5 ];
const BYTES = [ 1e2, 1e3, 1e4, 1e5, 1e6, 1e7 ];
/** Maximum number of tables in the chart. */
const MOST_TABLES = 24;
const along = ( value, marks ) => Math.min( 1, Math.max( 0, Math.log( value / marks[ 0 ] ) / Math.log( marks.at( - 1 ) / marks[ 0 ] ) ) );
const x = ( value ) => LEFT + ( WIDTH - LEFT - 8 ) * along( value, BYTES );
const y = ( error ) => TOP + ( HEIGHT - TOP - BOTTOM ) * ( 1 - along( error, ERRORS ) );
const words = ( point ) => `error ${ percent( point.error ) } at ${ bytes( point.bytes ) }`;

/** The chart. `show` marks the forecast of the recipe. */
export function tradeoff( signal ) {
	const own = svg( 'circle', { class: 'own', r: 5, visibility: 'hidden' } );
	const others = svg( 'g' );
	const root = svg( 'svg', { class: 'tradeoff', viewBox: `0 0 ${ WIDTH } ${ HEIGHT }`, role: 'img', 'aria-label': 'Error against size' },
		ERRORS.map( ( error ) => [
			svg( 'line', { x1: LEFT, x2: WIDTH - 8, y1: y( error ), y2: y( error ) } ),
			svg( 'text', { x: LEFT - 5, y: y( error ) + 3.5, 'text-anchor': 'end' }, String( 100 * error ) ),
		] ),
		BYTES.slice( 1, - 1 ).map( ( count ) => svg( 'text', { x: x( count ), y: HEIGHT - BOTTOM + 14, 'text-anchor': 'middle' }, bytes( count ) ) ),
		svg( 'text', { x: LEFT, y: HEIGHT - 4 }, 'error in % against size' ), others, own );

	async function load() {
		const { items } = await call( `/v1/tables?limit=${ MOST_TABLES }`, { signal } );
		for ( const { bytes, recipe, errors } of items.filter( ( { recipe, errors } ) => recipe && errors ) ) {
			const point = { error: errors.width, bytes };
			others.append( svg( 'circle', { class: 'measured', cx: x( bytes ), cy: y( point.error ), r: 2.5 }, svg( 'title', {}, `table for ${ recipe.brdf }, layout ${ recipe.layout }: ${ words( point ) }` ) ) );
		}
	}

	// After an error the chart lacks tables. The forecast shows errors of the service.
	load().catch( () => {} );

	function show( expected ) {
		own.setAttribute( 'visibility', expected ? 'visible' : 'hidden' );
		if ( ! expected ) return;
		own.setAttribute( 'cx', x( expected.bytes ) );
		own.setAttribute( 'cy', y( expected.error ) );
		root.setAttribute( 'aria-label', `This recipe: ${ words( expected ) }, among the tables of this service` );
	}
	return { root, show };
}
