// Formats numbers, times and sizes for people.

/** A number with three significant digits. Very small and very large numbers have an exponent. */
export function number( value ) {
	if ( value === null || value === undefined ) return '–';
	if ( value !== 0 && ( Math.abs( value ) < 1e-4 || Math.abs( value ) >= 1e6 ) ) return value.toExponential( 1 );
	return Number( value.toPrecision( 3 ) ).toString();
}

/** An integer with commas between thousands. */
export const whole = ( count ) => count.toLocaleString( 'en' );

/** A fraction in percent. */
export const percent = ( part, digits = 1 ) => `${ ( 100 * part ).toFixed( digits ) } %`;

/** The sign before an error that is still measured: noise makes it too small. */
export const atLeast = ( isDone ) => isDone ? '' : '≥ ';

/** An angle in whole degrees. */
export const degrees = ( radians ) => `${ Math.round( radians * 180 / Math.PI ) }°`;

export function bytes( count ) {
	if ( count < 1000 ) return `${ count } B`;
	const kilo = Number( ( count / 1000 ).toFixed( count < 9950 ? 1 : 0 ) );
	return kilo < 1000 ? `${ kilo.toFixed( kilo < 10 ? 1 : 0 ) } kB` : `${ ( count / 1e6 ).toFixed( 1 ) } MB`;
}

/** A duration in at most two units. */
export function span( seconds ) {
	if ( seconds < 1 ) return '< 1 s';
	// Rounds first, so that 59.6 seconds are a minute.
	const [ whole, minutes ] = [ Math.round( seconds ), Math.round( seconds / 60 ) ];
	if ( whole < 60 ) return `${ whole } s`;
	if ( whole < 3600 ) return `${ Math.floor( whole / 60 ) } min ${ whole % 60 } s`;
	if ( minutes < 1440 ) return `${ Math.floor( minutes / 60 ) } h ${ minutes % 60 } min`;
	return `${ Math.floor( minutes / 1440 ) } d`;
}

/** The time since a date, in the largest unit that fits. */
export function age( time ) {
	const seconds = Math.max( 0, ( Date.now() - Date.parse( time ) ) / 1000 );
	const [ size, name ] = [ [ 86_400, 'd' ], [ 3600, 'h' ], [ 60, 'min' ] ].find( ( [ size ] ) => seconds >= size ) || [ 1, 's' ];
	return `${ Math.floor( seconds / size ) } ${ name }`;
}

/** The first digits of a digest. */
export const short = ( digest ) => digest.replace( 'sha256:', '' ).slice( 0, 10 );
