// What lights the surface, in GLSL ES: a text of the service's shaders, or the formula of engines, summed over the lights.
//
// Each program writes the two parts of the light: for a Fresnel factor of one, and weighed by Schlick's fifth power.

import { LIGHTS, OUTLINES } from './glsl_lights.js';
import { SEEN } from './glsl_surface.js';

const MAIN = `
out vec4 parts;
void main() {
	Shaded at = see();
	parts = vec4( at.coverage > 0.0 ? parts_of( at ) : vec2( 0.0 ), 0.0, 1.0 );
}`;

/** By model normals, which lights by polygons: other shapes by those that stand for them, as in previews. */
const BY_NORMALS = `
vec2 parts_of( Shaded at ) {
	NormalsView view = normals_view( at.alpha.x, at.alpha.y, at.wo );
	vec2 sum = vec2( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		uint count = outline_of( l, at, v );
		vec2 of_light = count == 4u ? normals_rectangle( view, vec3[4]( v[0], v[1], v[2], v[3] ), is_solid( l ) ) : normals_polygon( view, v, count, is_solid( l ) );
		sum += light_radiance[l] * of_light;
	}
	return sum;
}`;

/** The part of a lobe that the lights cover, each weighed by its radiance. */
const COVERED = `
float covered( mat3 m, Shaded at ) {
	LtcInverse local = ltc_inverse( m );
	LtcInverse inverse = LtcInverse( local.m * transpose( mat3( at.x, at.y, at.z ) ), local.side );
	float sum = 0.0;
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 centre = light_centre[l].xyz - at.position;
		vec3 end = light_x[l].xyz - at.position;
		float part = 0.0;
		if ( is_shape( l, 0 ) ) {
			vec3 v[8];
			for ( int i = 0; i < 8; i ++ ) v[i] = light_vertices[8 * l + i].xyz - at.position;
			part = light_corners[l] == 4 ? ltc_rectangle( inverse, vec3[4]( v[0], v[1], v[2], v[3] ), false ) : ltc_polygon( inverse, v, uint( light_corners[l] ), false );
		}
		if ( is_shape( l, 1 ) ) part = ltc_disk( inverse, centre, light_x[l].xyz, light_y[l].xyz, false );
		if ( is_shape( l, 2 ) ) part = ltc_tube( inverse, centre, end, light_centre[l].w );
		if ( is_shape( l, 3 ) ) part = ltc_line( inverse, centre, end, light_centre[l].w );
		sum += light_radiance[l] * part;
	}
	return sum;
}
`;

const LOOKUPS = {
	one: `
vec2 parts_of( Shaded at ) {
	LtcLobe lobe = ltc_lookup( at.alpha.x, at.alpha.y, at.wo );
	return vec2( lobe.amplitude, lobe.fresnel ) * covered( lobe.m, at );
}`,
	two_lobes: `
vec2 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	return vec2( lobes.first.amplitude, lobes.first.fresnel ) * vec2( covered( lobes.first.m, at ), covered( lobes.second, at ) );
}`,
	blended_lobes: `
vec2 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	float f0 = dot( texelFetch( seen_f0, ivec2( gl_FragCoord.xy ), 0 ).xyz, vec3( 1.0 / 3.0 ) );
	return vec2( lobes.first.amplitude, lobes.first.fresnel ) * covered( ltc_blend( lobes, f0, 1.0 ), at );
}`,
};

/**
 * By the isotropic table of 2017 as engines read it: the mean of the roughnesses; of a light's vector form factor what the
 * sphere of the same one leaves above the horizon [Hill and Heitz 2016]. `EngineWay::Clipless` of `ltcforge-light` is its twin.
 */
const BY_ENGINES = `
uniform sampler2D shipped_matrix, shipped_terms;
vec3 edge( vec3 a, vec3 b ) {
	float cosine = clamp( dot( a, b ), - 1.0, 1.0 );
	vec3 normal = cross( a, b );
	float sine = length( normal );
	return sine > 1e-6 ? normal * ( atan( sine, cosine ) / sine ) : normal;
}
vec2 parts_of( Shaded at ) {
	vec2 place = vec2( sqrt( sqrt( at.alpha.x * at.alpha.y ) ), sqrt( 1.0 - at.wo.z ) ) * ( 63.0 / 64.0 ) + 0.5 / 64.0;
	vec4 stored = textureLod( shipped_matrix, place, 0.0 );
	vec2 terms = textureLod( shipped_terms, place, 0.0 ).xy;
	vec2 azimuth = dot( at.wo.xy, at.wo.xy ) > 1e-12 ? normalize( at.wo.xy ) : vec2( 1.0, 0.0 );
	mat3 to_view = transpose( mat3( azimuth, 0.0, - azimuth.y, azimuth.x, 0.0, 0.0, 0.0, 1.0 ) );
	mat3 inverse = mat3( stored.x, 0.0, stored.y, 0.0, 1.0, 0.0, stored.z, 0.0, stored.w ) * to_view;
	float sum = 0.0;
	for ( int l = 0; l < light_count; l ++ ) {
		if ( ! is_solid( l ) && dot( light_normal[l].xyz, light_vertices[8 * l].xyz - at.position ) >= 0.0 ) continue;
		vec3 v[8];
		int count = int( outline_of( l, at, v ) );
		vec3 flux = vec3( 0.0 );
		vec3 before = normalize( inverse * v[count - 1] );
		for ( int i = 0; i < count; i ++ ) {
			vec3 corner = normalize( inverse * v[i] );
			flux += edge( before, corner );
			before = corner;
		}
		flux *= 0.15915494;
		// The outline of a solid may run either way.
		if ( is_solid( l ) && dot( flux, inverse * ( v[0] + v[count / 2] ) ) < 0.0 ) flux = - flux;
		float size = length( flux );
		sum += light_radiance[l] * max( size * ( size + flux.z / max( size, 1e-12 ) ) / ( size + 1.0 ), 0.0 );
	}
	return terms * sum;
}`;

/** The body of a program by its kind: normals, engines, or how the lobes of a table's entries are used. */
const BODIES = {
	normals: OUTLINES + BY_NORMALS,
	engines: OUTLINES + BY_ENGINES,
	...Object.fromEntries( Object.entries( LOOKUPS ).map( ( [ name, lookup ] ) => [ name, COVERED + lookup ] ) ),
};

/** The fragment shader of a kind of model under lights of these shapes, a bit each; `text` is the service's, which begins with precisions. */
export function modelShader( kind, text, shapes ) {

	return `#version 300 es\n${ text || 'precision highp float;\nprecision highp int;\n' }\nconst int SHAPES_USED = ${ shapes };\n${ SEEN }${ LIGHTS }${ BODIES[ kind ] }${ MAIN }`;

}
