// Numbers, times and recipes as people read them.

/** JSON in lines, with lists of numbers in one. */
export function json( value ) {

	return JSON.stringify( value, null, 2 ).replace( /\[[^[\]{}]*\]/g, ( list ) => list.replace( /\s+/g, ' ' ) );

}

/** Three significant digits without an exponent, as far as that is short. */
export function number( value ) {

	if ( value === null || value === undefined ) return '–';
	if ( value !== 0 && ( Math.abs( value ) < 1e-4 || Math.abs( value ) >= 1e6 ) ) return value.toExponential( 1 );
	return Number( value.toPrecision( 3 ) ).toString();

}

/** A part of a whole in percent. */
export function percent( part, digits = 1 ) {

	return `${ ( 100 * part ).toFixed( digits ) } %`;

}

export function bytes( count ) {

	if ( count < 1000 ) return `${ count } B`;
	const kilo = count / 1000;
	return kilo < 1000 ? `${ kilo.toFixed( kilo < 10 ? 1 : 0 ) } kB` : `${ ( kilo / 1000 ).toFixed( 1 ) } MB`;

}

/** A time span in its two largest units at most. */
export function span( seconds ) {

	if ( seconds < 1 ) return '< 1 s';
	if ( seconds < 60 ) return `${ Math.round( seconds ) } s`;
	if ( seconds < 3600 ) return `${ Math.floor( seconds / 60 ) } min ${ Math.round( seconds % 60 ) } s`;
	if ( seconds < 86_400 ) return `${ Math.floor( seconds / 3600 ) } h ${ Math.round( seconds % 3600 / 60 ) } min`;
	return `${ Math.floor( seconds / 86_400 ) } d`;

}

/** How long ago a time is, in its largest unit. */
export function age( time ) {

	const seconds = Math.max( 0, ( Date.now() - Date.parse( time ) ) / 1000 );
	const units = [ [ 86_400, 'd' ], [ 3600, 'h' ], [ 60, 'min' ], [ 1, 's' ] ];
	const [ size, name ] = units.find( ( [ size ] ) => seconds >= size ) || [ 1, 's' ];
	return `${ Math.floor( seconds / size ) } ${ name }`;

}

/** The first digits of a digest. */
export function short( digest ) {

	return digest.replace( 'sha256:', '' ).slice( 0, 10 );

}

/** Nodes along the axes that have more than one. */
export function nodes( { resolution } ) {

	const counts = [ 'alpha', 'ratio', 'theta', 'phi' ].map( ( axis ) => resolution[ axis ] ).filter( ( count ) => count > 1 );
	return counts.join( ' × ' ) || '1';

}

/** What a recipe fits, in a few words. */
export function title( recipe ) {

	const materials = recipe.fresnel === undefined ? [] : [ Array.isArray( recipe.fresnel ) ? `F0 ${ recipe.fresnel.map( ( { f0 } ) => f0 ).join( ', ' ) }` : recipe.fresnel.replaceAll( '_', ' ' ) ];
	const lobe = recipe.lobe === undefined ? [] : [ recipe.lobe ];
	return [ recipe.brdf, recipe.layout, nodes( recipe ), recipe.precision, ...lobe, ...materials ].join( ' · ' );

}

/** Whether all surfaces of a recipe are isotropic. */
export function isIsotropic( { range } ) {

	return range.ratio[ 0 ] === 1;

}
