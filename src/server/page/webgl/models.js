// Lighting models in GLSL ES: a shader text of the service, or the formula that engines use, summed over the lights.
//
// Each program sums two parts of the reflected light: one for a Fresnel factor of one, and one weighted by Schlick's fifth power.
// Both are colours, because lights can have pictures. The program combines the parts with the reflectance f0 of the material.

import { LIGHTS, OUTLINES } from './lights.js';
import { PRECISE, SURFACE_POINT } from './surface.js';

const MAIN = `
vec3 reflected( Shaded at ) {
	mat2x3 parts = parts_of( at );
	return at.f0 * ( parts[0] - parts[1] ) + parts[1];
}
`;

/** Adds the light of the surface, and its coverage, to a sum over frames. */
const SUM = `
uniform sampler2D sum_before;
uniform int sum_count;
out vec4 sum;
void main() {
	Shaded at = shaded_point();
	sum = sum_count > 0 ? texelFetch( sum_before, ivec2( gl_FragCoord.xy ), 0 ) : vec4( 0.0 );
	if ( at.coverage > 0.0 ) sum += at.coverage * vec4( reflected( at ), 1.0 );
}`;

/** The normals model, which supports only polygons. As in previews, polygons replace other shapes. */
const BY_NORMALS = `
mat2x3 parts_of( Shaded at ) {
	NormalsView view = normals_view( at.alpha.x, at.alpha.y, at.wo );
	mat2x3 sum = mat2x3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		uint count = outline_of( l, at, v );
		vec3[4] corners = vec3[4]( v[0], v[1], v[2], v[3] );
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) {
			NormalsTextured textured = normals_textured_rectangle( view, corners, is_two_sided( l ), uint( light_picture[l] ), picture_base );
			sum += outerProduct( light_radiance[l] * textured.colour, textured.parts );
			continue;
		}
#endif
		vec2 of_light = count == 4u ? normals_rectangle( view, corners, is_two_sided( l ) ) : normals_polygon( view, v, count, is_two_sided( l ) );
		sum += outerProduct( light_radiance[l], of_light );
	}
	return sum;
}`;

/** The sum over all lights of the part of a lobe that the light covers, times the light's radiance. */
const COVERED = `
vec3 covered( LtcInverse local, Shaded at ) {
	LtcInverse inverse = LtcInverse( local.m * transpose( mat3( at.x, at.y, at.z ) ), local.side );
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 centre = light_centre[l].xyz - at.position;
		vec3 end = light_x[l].xyz - at.position;
		vec3 colour = light_radiance[l];
		bool is_both = is_two_sided( l );
		float part = 0.0;
		if ( is_shape( l, 0 ) ) {
			vec3 v[8];
			for ( int i = 0; i < 8; i ++ ) v[i] = light_vertices[8 * l + i].xyz - at.position;
			vec3[4] corners = vec3[4]( v[0], v[1], v[2], v[3] );
#if SHAPES_USED & 16
			if ( is_pictured( l ) ) {
				LtcTextured textured = ltc_textured_rectangle( inverse, corners, is_both, uint( light_picture[l] ), picture_base );
				sum += textured.covered * colour * textured.colour;
				continue;
			}
#endif
			part = light_corners[l] == 4 ? ltc_rectangle( inverse, corners, is_both ) : ltc_polygon( inverse, v, uint( light_corners[l] ), is_both );
		}
		if ( is_shape( l, 1 ) ) part = ltc_disk( inverse, centre, light_x[l].xyz, light_y[l].xyz, is_both );
		if ( is_shape( l, 2 ) ) part = ltc_tube( inverse, centre, end, light_centre[l].w );
		if ( is_shape( l, 3 ) ) part = ltc_line( inverse, centre, end, light_centre[l].w );
		sum += part * colour;
	}
	return sum;
}
`;

const LOOKUPS = {
	formula: `
mat2x3 parts_of( Shaded at ) {
	LtcFormula lobe = ltc_formula( at.alpha.x, at.alpha.y, at.wo, dot( at.f0, vec3( 1.0 / 3.0 ) ), 1.0 );
	return outerProduct( covered( lobe.inverse, at ), vec2( lobe.amplitude, lobe.fresnel ) );
}`,
	one: `
mat2x3 parts_of( Shaded at ) {
	LtcLobe lobe = ltc_lookup( at.alpha.x, at.alpha.y, at.wo );
	return outerProduct( covered( ltc_inverse( lobe.m ), at ), vec2( lobe.amplitude, lobe.fresnel ) );
}`,
	two_lobes: `
mat2x3 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	return mat2x3( lobes.first.amplitude * covered( ltc_inverse( lobes.first.m ), at ), lobes.first.fresnel * covered( ltc_inverse( lobes.second ), at ) );
}`,
	blended_lobes: `
mat2x3 parts_of( Shaded at ) {
	LtcLobes lobes = ltc_lookup_both( at.alpha.x, at.alpha.y, at.wo );
	float f0 = dot( at.f0, vec3( 1.0 / 3.0 ) );
	return outerProduct( covered( ltc_inverse( ltc_blend( lobes, f0, 1.0 ) ), at ), vec2( lobes.first.amplitude, lobes.first.fresnel ) );
}`,
};

/** The part of the vector form factor that an edge between two unit vectors adds, times 2 pi. */
const EDGE = `
vec3 edge( vec3 a, vec3 b ) {
	float cosine = clamp( dot( a, b ), - 1.0, 1.0 );
	vec3 normal = cross( a, b );
	float sine = length( normal );
	return sine > 1e-6 ? normal * ( atan( sine, cosine ) / sine ) : normal;
}
`;

/**
 * Diffuse reflection [Lambert], the same for every model: form factors of polygons, which replace other shapes. It uses only the
 * mean colour of a picture.
 */
const DIFFUSE = `
#if SHAPES_USED & 16
uniform highp sampler2DArray diffuse_pictures;
#endif
vec3 reflected( Shaded at ) {
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		vec3 v[8];
		int count = int( outline_of( l, at, v ) );
		vec3 flux = vec3( 0.0 ), first = vec3( 0.0 ), last = vec3( 0.0 );
		for ( int i = 0; i < 2 * count; i ++ ) {
			// Each corner above the horizon, and each point where the outline crosses the horizon.
			vec3 a = v[i / 2], b = v[( i / 2 + 1 ) % count];
			if ( ( i & 1 ) == 0 ? a.z < 0.0 : ( a.z < 0.0 ) == ( b.z < 0.0 ) ) continue;
			vec3 corner = normalize( ( i & 1 ) == 0 ? a : a + ( b - a ) * ( a.z / ( a.z - b.z ) ) );
			if ( first == vec3( 0.0 ) ) first = corner;
			else flux += edge( last, corner );
			last = corner;
		}
		float part = 0.15915494 * ( flux + edge( last, first ) ).z;
		vec3 colour = light_radiance[l];
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) colour *= textureLod( diffuse_pictures, vec3( 0.5, 0.5, light_picture[l] ), 16.0 ).rgb;
#endif
		sum += colour * ( is_two_sided( l ) ? abs( part ) : max( part, 0.0 ) );
	}
	return at.diffuse * sum;
}`;

/**
 * The isotropic table of 2017 as engines read it. It uses the geometric mean of both roughnesses. Instead of clipping a light at the
 * horizon, it uses the visible part of a sphere with the same vector form factor [Hill and Heitz 2016]. It uses only
 * the mean colour of a picture. `EngineWay::Clipless` of `ltcforge-light` is the CPU twin.
 */
const BY_ENGINES = `
uniform sampler2D shipped_matrix, shipped_terms;
#if SHAPES_USED & 16
uniform highp sampler2DArray engines_pictures;
#endif
mat2x3 parts_of( Shaded at ) {
	vec2 place = vec2( sqrt( sqrt( at.alpha.x * at.alpha.y ) ), sqrt( 1.0 - at.wo.z ) ) * ( 63.0 / 64.0 ) + 0.5 / 64.0;
	vec4 stored = textureLod( shipped_matrix, place, 0.0 );
	vec2 terms = textureLod( shipped_terms, place, 0.0 ).xy;
	vec2 azimuth = dot( at.wo.xy, at.wo.xy ) > 1e-12 ? normalize( at.wo.xy ) : vec2( 1.0, 0.0 );
	mat3 to_view = transpose( mat3( azimuth, 0.0, - azimuth.y, azimuth.x, 0.0, 0.0, 0.0, 1.0 ) );
	mat3 inverse = mat3( stored.x, 0.0, stored.y, 0.0, 1.0, 0.0, stored.z, 0.0, stored.w ) * to_view;
	vec3 sum = vec3( 0.0 );
	for ( int l = 0; l < light_count; l ++ ) {
		if ( ! is_two_sided( l ) && dot( light_normal[l].xyz, light_vertices[8 * l].xyz - at.position ) >= 0.0 ) continue;
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
		// The outline of a light with two sides can have either orientation.
		if ( is_two_sided( l ) && dot( flux, inverse * ( v[0] + v[count / 2] ) ) < 0.0 ) flux = - flux;
		float size = length( flux );
		vec3 colour = light_radiance[l];
#if SHAPES_USED & 16
		if ( is_pictured( l ) ) colour *= textureLod( engines_pictures, vec3( 0.5, 0.5, light_picture[l] ), 16.0 ).rgb;
#endif
		sum += colour * max( size * ( size + flux.z / max( size, 1e-12 ) ) / ( size + 1.0 ), 0.0 );
	}
	return outerProduct( sum, terms );
}`;

/** The code of each kind of model: normals, engines, diffuse reflection, formula, or one of the ways to use the lobes of a table. */
const BODIES = {
	normals: OUTLINES + BY_NORMALS + MAIN,
	engines: OUTLINES + EDGE + BY_ENGINES + MAIN,
	diffuse: OUTLINES + EDGE + DIFFUSE,
	...Object.fromEntries( Object.entries( LOOKUPS ).map( ( [ name, lookup ] ) => [ name, COVERED + lookup + MAIN ] ) ),
};

/** The name of the sampler with all levels of the pictures, by kind of model. */
export const picturesOf = ( kind ) => `${ { normals: 'normals', engines: 'engines', diffuse: 'diffuse' }[ kind ] || 'ltc' }_pictures`;

/** The fragment shader of a kind of model. `shapes` has a bit for each shape of the lights. `text` is the shader text of the service. */
export function modelShader( kind, text, shapes ) {
	return `#version 300 es\n${ text }\n${ PRECISE }#define SHAPES_USED ${ shapes }\nuniform float picture_base;\n${ SURFACE_POINT }${ LIGHTS }${ BODIES[ kind ] }${ SUM }`;
}
