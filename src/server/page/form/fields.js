// The fields of a recipe as a form has them. What they mean and allow the service says: it fills in defaults and finds faults.

const BRDFS = [ 'ggx', 'beckmann', 'charlie', 'charlie_neubelt', 'burley_diffuse', 'oren_nayar', 'fuzz' ];
const LAYOUTS = [ 'reflected', 'kt2022', 'ltc2017', 'ltc2016', 'godot', 'hdrp', 'inverse', 'matrix33', 'materials' ];
const HALF_TURN = 1.5707963267948966;

const choice = ( pointer, label, options ) => ( { pointer, label, kind: 'choice', options } );
const whole = ( pointer, label, min, max ) => ( { pointer, label, kind: 'whole', min, max } );
const interval = ( pointer, label, max ) => ( { pointer, label, kind: 'interval', max } );

/** Groups of fields, by their RFC 6901 pointers. A field of one layout tells it, and which others it decides, which a change of it leaves out. */
export const GROUPS = [
	{ name: 'Surface', fields: [
		choice( '/brdf', 'Scattering model', BRDFS ),
		{ pointer: '/fresnel', label: 'Materials', kind: 'materials' },
		choice( '/lobe', 'Lobe', [ 'ltc', 'sg', 'asg' ] ),
	] },
	{ name: 'Table', fields: [
		choice( '/layout', 'Layout', LAYOUTS ),
		{ pointer: '/materials', label: 'Roughnesses', kind: 'roughnesses', layout: 'materials', decides: [ '/range', '/resolution' ].flatMap( ( of ) => [ `${ of }/alpha`, `${ of }/ratio` ] ) },
		choice( '/precision', 'Numbers', [ 'f32', 'f16' ] ),
		choice( '/terms', 'Terms', [ true, false, 'f82' ] ),
	] },
	{ name: 'Nodes', fields: [ 'alpha', 'ratio', 'theta', 'phi' ].map( ( axis ) => whole( `/resolution/${ axis }`, axis, 1, 16_384 ) ) },
	{ name: 'Ranges', fields: [
		interval( '/range/alpha', 'alpha', 1 ), interval( '/range/ratio', 'ratio', 1 ),
		interval( '/range/theta', 'theta', HALF_TURN ), interval( '/range/phi', 'phi', HALF_TURN ),
	] },
	{ name: 'Fit', fields: [
		choice( '/fit/metric', 'Metric', [ 'sw1', 'l3' ] ), choice( '/fit/solver', 'Solver', [ 'bfgs', 'sgd', 'nelder_mead' ] ),
		whole( '/fit/samples', 'Samples', 32, 65_536 ), whole( '/fit/directions', 'Directions', 4, 1024 ),
		whole( '/fit/steps', 'Steps', 1, 100_000 ), whole( '/fit/seed', 'Seed', 0, Number.MAX_SAFE_INTEGER ),
	] },
];

/** Presets, from the quickest. */
export const PRESETS = [ 'draft', 'standard', 'paper', 'best' ];

/** Recipes to begin with, by what they are for. */
export const STARTS = {
	'metal and dielectrics, of any direction': { preset: 'standard', fresnel: 'two_lobes' },
	'brushed metal on phones': { preset: 'paper', precision: 'f16', range: { alpha: [ 0.05, 0.4 ], ratio: [ 0.2, 1 ] }, resolution: { alpha: 7, ratio: 5, theta: 8, phi: 6 } },
	'round surfaces, as engines load it': { preset: 'standard', layout: 'ltc2017' },
	'round surfaces in a kilobyte': { preset: 'paper', precision: 'f16', range: { ratio: [ 1, 1 ], phi: [ 0, 0 ] }, resolution: { alpha: 9, ratio: 1, theta: 8, phi: 1 } },
	'sheen of glTF': { preset: 'paper', brdf: 'charlie_neubelt', range: { alpha: [ 0.0049, 1 ] }, resolution: { alpha: 24, theta: 32 }, precision: 'f16' },
};

/** Members that a canonical recipe leaves out, and what they are then. */
export const LEFT_OUT = { '/lobe': 'ltc', '/fresnel': 'one' };

/** The member of a document at a pointer. */
export function get( document, pointer ) {

	return pointer.slice( 1 ).split( '/' ).reduce( ( value, key ) => value?.[ key ], document ?? undefined );

}

/** Sets the member at a pointer, or removes it where the value is undefined. */
export function set( document, pointer, value ) {

	const keys = pointer.slice( 1 ).split( '/' );
	const last = keys.pop();
	// A document that was pasted may have anything there.
	const inner = keys.reduce( ( at, key ) => at[ key ] = Object( at[ key ] ) === at[ key ] ? at[ key ] : {}, document );
	if ( value === undefined ) delete inner[ last ];
	else inner[ last ] = value;
	for ( const key of keys ) if ( ! Object.keys( document[ key ] ).length ) delete document[ key ];

}
