// A recipe's place among others: predicted error against bytes and seconds, and the tables of the service as they were measured.

import { bytes, number, percent } from '../elements/format.js';
import { call, each, manifest } from '../service/api.js';

const SVG = 'http://www.w3.org/2000/svg';
const [ WIDTH, HEIGHT, LEFT, TOP, BOTTOM ] = [ 240, 164, 24, 8, 32 ];
/** Least and greatest error, and those of each chart's own axis; what is beyond stands at the edge. */
const ERRORS = [ 0.02, 0.5 ];
const CHARTS = [
	{ of: 'bytes', range: [ 1e2, 1e7 ], ticks: { '1 kB': 1e3, '10 kB': 1e4, '100 kB': 1e5, '1 MB': 1e6 }, tell: bytes },
	{ of: 'seconds', range: [ 1e-2, 1e4 ], ticks: { 0.1: 0.1, 1: 1, 10: 10, 100: 100, 1000: 1000 }, tell: ( seconds ) => `${ number( seconds ) } s` },
];

/** Recipes of whole domains for which the service tells its predictions: by layout, from coarse to fine. */
const FAMILIES = {
	reflected: [ [ 6, 4, 5, 4 ], [ 8, 5, 7, 5 ], [ 10, 6, 9, 7 ], [ 14, 8, 12, 9 ], [ 20, 12, 18, 13 ] ].map( four( 'reflected' ) ),
	kt2022: [ [ 6, 6, 6, 6 ], [ 8, 8, 8, 8 ], [ 12, 12, 12, 12 ], [ 16, 16, 16, 16 ] ].map( four( 'kt2022' ) ),
	ltc2017: [ 16, 32, 64 ].map( ( count ) => ( { layout: 'ltc2017', resolution: { alpha: count, theta: count } } ) ),
};

function four( layout ) {

	return ( [ alpha, ratio, theta, phi ] ) => ( { layout, resolution: { alpha, ratio, theta, phi } } );

}

/** Tables of the service that are shown. */
const MOST_TABLES = 24;

function drawn( tag, attributes, ...children ) {

	const element = document.createElementNS( SVG, tag );
	for ( const [ name, value ] of Object.entries( attributes ) ) element.setAttribute( name, value );
	element.append( ...children );
	return element;

}

const along = ( value, [ least, most ] ) => Math.min( 1, Math.max( 0, Math.log( value / least ) / Math.log( most / least ) ) );

/** Two charts and what shows a recipe's forecast in them. */
export function tradeoff( signal ) {

	const y = ( error ) => TOP + ( HEIGHT - TOP - BOTTOM ) * ( 1 - along( error, ERRORS ) );
	const charts = CHARTS.map( ( chart ) => {

		const x = ( value ) => LEFT + ( WIDTH - LEFT - 8 ) * along( value, chart.range );
		const frame = [ 0.02, 0.05, 0.1, 0.2, 0.5 ].flatMap( ( error ) => [
			drawn( 'line', { x1: LEFT, x2: WIDTH - 8, y1: y( error ), y2: y( error ) } ),
			drawn( 'text', { x: LEFT - 5, y: y( error ) + 3.5, 'text-anchor': 'end' }, percent( error, 0 ).replace( ' %', '' ) ),
		] );
		const ticks = Object.entries( chart.ticks ).map( ( [ name, tick ] ) => drawn( 'text', { x: x( tick ), y: HEIGHT - BOTTOM + 14, 'text-anchor': 'middle' }, name ) );
		const others = drawn( 'g', {} );
		const own = drawn( 'circle', { class: 'own', r: 5, visibility: 'hidden' } );
		const svg = drawn( 'svg', { class: 'tradeoff', viewBox: `0 0 ${ WIDTH } ${ HEIGHT }`, role: 'img' },
			...frame, ...ticks, drawn( 'text', { x: LEFT, y: HEIGHT - 4 }, `error in % against ${ chart.of }` ), others, own );
		svg.setAttribute( 'aria-label', `Predicted error against ${ chart.of }` );
		return { ...chart, x, svg, others, own };

	} );

	/** A mark in each chart that has its number. */
	function mark( { error, ...prices }, name, kind ) {

		for ( const { of, x, others, tell } of charts ) if ( prices[ of ] ) others.append( drawn( 'circle', { class: kind, cx: x( prices[ of ] ), cy: y( error ), r: 2.5 }, drawn( 'title', {}, `${ name }: ${ percent( error ) }, ${ tell( prices[ of ] ) }` ) ) );

	}

	async function load() {

		await each( Object.entries( FAMILIES ), 1, signal, async ( [ layout, recipes ] ) => {

			const found = await Promise.all( recipes.map( ( recipe ) => call( '/v1/recipes', { method: 'POST', body: recipe, signal } ) ) );
			const points = found.map( ( { expected } ) => expected ).filter( Boolean );
			for ( const { of, x, others } of charts ) if ( points.length ) {

				others.append( drawn( 'polyline', { points: points.map( ( point ) => `${ x( point[ of ] ) },${ y( point.error ) }` ).join( ' ' ) } ) );
				const last = points[ 0 ];
				others.append( drawn( 'text', { class: 'name', x: x( last[ of ] ) - 4, y: y( last.error ) - 5 }, layout ) );

			}

			points.forEach( ( point, i ) => mark( point, `${ layout }, ${ Object.values( recipes[ i ].resolution ).join( ' × ' ) }`, 'predicted' ) );

		} );
		const { items } = await call( `/v1/tables?limit=${ MOST_TABLES }`, { signal } );
		await each( items, 2, signal, async ( { digest, bytes } ) => {

			const { recipe, report } = await manifest( digest );
			mark( { error: report.between.width.mean, bytes }, `a table of ${ recipe.brdf }, ${ recipe.layout }, measured`, 'measured' );

		} );

	}

	// The charts are beside the point where they fail: the forecast tells what is wrong.
	load().catch( () => {} );

	/** Shows a forecast as the recipe's own point. */
	function show( expected ) {

		for ( const { of, x, own, svg, tell } of charts ) {

			own.setAttribute( 'visibility', expected ? 'visible' : 'hidden' );
			if ( ! expected ) continue;
			own.setAttribute( 'cx', x( expected[ of ] ) );
			own.setAttribute( 'cy', y( expected.error ) );
			svg.setAttribute( 'aria-label', `This recipe: error ${ percent( expected.error ) } at ${ tell( expected[ of ] ) }, among others` );

		}

	}

	return { charts: charts.map( ( { svg } ) => svg ), show };

}
