// The recipe fields of the form. The service knows their bounds and defaults, and checks the recipe.

import { ENGINES } from '../elements/recipe.js';

const ALPHA_AND_RATIO = [ 'alpha', 'ratio' ];
const AXES = Object.fromEntries( [ ...ALPHA_AND_RATIO, 'theta', 'phi' ].map( ( axis ) => [ axis, axis ] ) );

/** Labels of the fields by group and JSON pointer (RFC 6901). */
const GROUPS = {
	Surface: { brdf: 'Scattering model', fresnel: 'Materials', lobe: 'Lobe' },
	Table: { layout: 'Layout', materials: 'Roughnesses', precision: 'Numbers', terms: 'Terms' },
	Nodes: { resolution: AXES },
	Ranges: { range: AXES },
	Fit: { fit: { metric: 'Metric', solver: 'Solver', samples: 'Samples', directions: 'Directions', steps: 'Steps', seed: 'Seed' } },
};

/** Recipes to start from, by their use. */
export const STARTS = {
	...Object.fromEntries( ENGINES.map( ( [ , label, layout ] ) => [ label, { preset: 'standard', ...( layout && { layout } ) } ] ) ),
	'metals and dielectrics, anisotropic': { preset: 'standard', fresnel: 'two_lobes' },
	'brushed metal on phones': { preset: 'paper', precision: 'f16', range: { alpha: [ 0.05, 0.4 ], ratio: [ 0.2, 1 ] }, resolution: { alpha: 7, ratio: 5, theta: 8, phi: 6 } },
	'isotropic surfaces, one kilobyte': { preset: 'paper', precision: 'f16', range: { ratio: [ 1, 1 ], phi: [ 0, 0 ] }, resolution: { alpha: 9, ratio: 1, theta: 8, phi: 1 } },
	'split sum: BRDF lookup table (DFG)': { table: 'dfg' },
	'glTF sheen': { preset: 'paper', brdf: 'charlie_neubelt', range: { alpha: [ 0.0049, 1 ] }, resolution: { alpha: 24, theta: 32 }, precision: 'f16' },
};

/** The kind of input for a field by its JSON Schema. */
function kindOf( { enum: options, anyOf, type, items } ) {
	if ( options ) return 'choice';
	if ( anyOf ) return 'materials';
	if ( type === 'integer' ) return 'whole';
	return items.type === 'number' ? 'interval' : 'roughnesses';
}

/**
 * The groups of fields, from the JSON Schema of recipes. Each field has a pointer, a label, a schema and a kind. The list of
 * roughnesses needs layout `materials`. It determines the values of the fields in `decided`, so changing the list removes them.
 */
export function groupsOf( schema ) {
	const fields = ( labels, { properties }, above = '' ) => Object.entries( labels ).flatMap( ( [ name, label ] ) => {
		const [ pointer, own ] = [ `${ above }/${ name }`, properties[ name ] ];
		return typeof label === 'object' ? fields( label, own, pointer ) : { pointer, label, schema: own, kind: kindOf( own ) };
	} );
	const decided = [ '/range', '/resolution' ].flatMap( ( of ) => ALPHA_AND_RATIO.map( ( axis ) => `${ of }/${ axis }` ) );
	return Object.entries( GROUPS ).map( ( [ name, labels ] ) => ( { name, fields: fields( labels, schema ).map( ( field ) => field.kind === 'roughnesses' ? { ...field, layout: 'materials', decided } : field ) } ) );
}

/** The value at a pointer of a document. */
export function get( document, pointer ) {
	return pointer.slice( 1 ).split( '/' ).reduce( ( value, key ) => value?.[ key ], document ?? undefined );
}

/** Sets the value at a pointer, or removes it if `value` is undefined. */
export function set( document, pointer, value ) {
	const keys = pointer.slice( 1 ).split( '/' );
	const last = keys.pop();
	// In a pasted document, these members may have any type.
	const inner = keys.reduce( ( at, key ) => at[ key ] = Object( at[ key ] ) === at[ key ] ? at[ key ] : {}, document );
	if ( value === undefined ) delete inner[ last ];
	else inner[ last ] = value;
	for ( const key of keys ) if ( ! Object.keys( document[ key ] ).length ) delete document[ key ];
}
