// The viewer's shaders in GLSL ES: a surface as previews have it, lit by a text of ours, and by Monte Carlo integration.
// What they compute is that of shaders/sphere.wgsl and shaders/ggx_reference.wgsl, line by line.

/** One triangle that covers the picture. */
export const VERTEX = `#version 300 es
void main() {
	gl_Position = vec4( gl_VertexID == 1 ? 3.0 : - 1.0, gl_VertexID == 2 ? 3.0 : - 1.0, 0.0, 1.0 );
}`;

/** What a pixel sees. The row of pixels counts from above, as in files of pictures. */
const SURFACE = `
uniform int size, surface;
uniform vec3 eye, right, up, forward, f0, light_normal, corners[4];
uniform float pixel_width, light_area, radiance;
uniform vec4 material;
const float HORIZON = 1e-6;
const vec3 BACKGROUND = vec3( 0.02 );
struct Shaded { vec3 position, x, y, z, wo; vec2 alpha; float coverage; };

ivec2 pixel_of() { return ivec2( int( gl_FragCoord.x ), size - 1 - int( gl_FragCoord.y ) ); }

Shaded see( ivec2 pixel ) {
	vec2 place = ( vec2( pixel ) + 0.5 ) / float( size ) * 2.0 - 1.0;
	vec3 ray = normalize( forward + right * place.x - up * place.y );
	Shaded at;
	vec3 normal, along;
	if ( surface == 1 ) {
		float t = - eye.y / min( ray.y, - 1e-6 );
		at.position = eye + t * ray;
		at.position.y = 0.0;
		normal = vec3( 0.0, 1.0, 0.0 );
		along = vec3( 1.0, 0.0, 0.0 );
		at.coverage = ray.y < - 1e-6 && eye.y > 1e-3 ? clamp( 2.0 * ( 1.0 - t / 12.0 ), 0.0, 1.0 ) : 0.0;
	} else {
		float closest = - dot( eye, ray );
		vec3 nearest = eye + closest * ray;
		float distance2 = dot( nearest, nearest );
		float rim = ( 1.0 - sqrt( distance2 ) ) / ( pixel_width * closest );
		at.coverage = closest > 0.0 ? clamp( rim + 0.5, 0.0, 1.0 ) : 0.0;
		at.position = normalize( nearest - sqrt( max( 1.0 - distance2, 0.0 ) ) * ray );
		normal = at.position;
		vec3 circle = vec3( normal.z, 0.0, - normal.x );
		float length2 = dot( circle, circle );
		along = length2 > 1e-8 ? circle / sqrt( max( length2, 1e-12 ) ) : vec3( 1.0, 0.0, 0.0 );
	}
	vec3 across = cross( normal, along );
	at.x = material.z * along + material.w * across;
	at.y = material.z * across - material.w * along;
	at.z = normal;
	vec3 view = normalize( eye - at.position );
	at.wo = normalize( vec3( dot( view, at.x ), dot( view, at.y ), max( dot( view, normal ), 1e-3 ) ) );
	at.alpha = max( material.xy, vec2( 1e-5 ) );
	return at;
}

vec3 reflected( vec2 parts ) { return ( f0 * ( parts.x - parts.y ) + vec3( parts.y ) ) * radiance; }
`;

/** The parts of what is reflected, by model normals. */
const BY_NORMALS = `
vec2 parts_of( Shaded at, vec3 local[4] ) {
	return normals_rectangle( normals_view( at.alpha.x, at.alpha.y, at.wo ), local, false );
}`;

/** The same by a table. */
const BY_TABLE = `
vec2 parts_of( Shaded at, vec3 local[4] ) {
	LtcLobe lobe = ltc_lookup( at.alpha.x, at.alpha.y, at.wo );
	return vec2( lobe.amplitude, lobe.fresnel ) * ltc_rectangle( ltc_inverse( lobe.m ), local, false );
}`;

const DISPLAY = `
uniform sampler2D reference_sum;
uniform int show, samples;
uniform float exposure, split, difference_scale;
out vec4 colour;

/** Blue, green, yellow, red. */
vec3 false_colour( float t ) {
	vec3 c = clamp( vec3( 2.5 * t - 0.9, 1.0 - abs( 2.6 * t - 1.2 ), 1.0 - 2.6 * abs( t - 0.22 ) ), 0.0, 1.0 );
	return mix( vec3( 0.02, 0.03, 0.12 ), c, smoothstep( 0.0, 0.15, t ) );
}

void main() {
	ivec2 pixel = pixel_of();
	Shaded at = see( pixel );
	mat3 to_local = transpose( mat3( at.x, at.y, at.z ) );
	vec3 local[4] = vec3[4]( to_local * ( corners[0] - at.position ), to_local * ( corners[1] - at.position ), to_local * ( corners[2] - at.position ), to_local * ( corners[3] - at.position ) );
	vec3 by_model = at.coverage > 0.0 ? mix( BACKGROUND, reflected( parts_of( at, local ) ), at.coverage ) : BACKGROUND;
	vec2 truth = texelFetch( reference_sum, ivec2( gl_FragCoord.xy ), 0 ).xy / float( max( samples, 1 ) );
	vec3 by_truth = mix( BACKGROUND, reflected( truth ), at.coverage );
	if ( show == 3 ) {
		float apart = dot( abs( by_model - by_truth ), vec3( 1.0 / 3.0 ) );
		colour = vec4( false_colour( clamp( apart / difference_scale, 0.0, 1.0 ) ), 1.0 );
		return;
	}
	bool is_truth = show == 2 || ( show == 0 && float( pixel.x ) >= split * float( size ) );
	vec3 y = vec3( 1.0 ) - exp( - exposure * max( is_truth ? by_truth : by_model, vec3( 0.0 ) ) );
	vec3 curved = mix( 1.055 * pow( max( y, vec3( 0.003 ) ), vec3( 1.0 / 2.4 ) ) - 0.055, 12.92 * y, lessThanEqual( y, vec3( 0.0031308 ) ) );
	colour = vec4( clamp( curved, 0.0, 1.0 ), 1.0 );
}`;

/** Adds samples to a sum: a visible normal and a point of the light each, by the balance heuristic. */
const REFERENCE = `
uniform sampler2D reference_sum;
uniform int first, samples;
out vec4 sum;

uint hash( uint key ) {
	uint x = key;
	x = ( x ^ ( x >> 16u ) ) * 0x7feb352du;
	x = ( x ^ ( x >> 15u ) ) * 0x846ca68bu;
	return x ^ ( x >> 16u );
}
vec2 point( uint i, uvec2 seed ) { return vec2( ( uvec2( i * 0xc13fa9a9u, i * 0x91e10da5u ) + seed ) >> uvec2( 8u ) ) / 16777216.0; }
float lambda( vec2 alpha, vec3 w ) { vec2 t = alpha * w.xy / w.z; return 0.5 * ( sqrt( 1.0 + dot( t, t ) ) - 1.0 ); }
float distribution( vec2 alpha, vec3 wm ) {
	vec2 t = wm.xy / alpha;
	float q = dot( t, t ) + wm.z * wm.z;
	return 1.0 / ( 3.14159265 * alpha.x * alpha.y * q * q );
}
vec3 visible_normal( vec2 alpha, vec3 wo, vec2 u ) {
	vec3 standard = normalize( vec3( alpha * wo.xy, wo.z ) );
	float z = ( 1.0 - u.y ) * ( 1.0 + standard.z ) - standard.z;
	float radius = sqrt( max( 1.0 - z * z, 0.0 ) );
	vec3 wm = vec3( radius * cos( 6.2831853 * u.x ), radius * sin( 6.2831853 * u.x ), z ) + standard;
	return normalize( vec3( alpha * wm.xy, max( wm.z, 0.0 ) ) );
}
float light_pdf( vec3 position, vec3 wi ) {
	float cosine = dot( light_normal, wi );
	if ( - cosine <= HORIZON ) return - 1.0;
	float away = dot( light_normal, corners[0] - position ) / cosine;
	if ( away <= 0.0 ) return - 1.0;
	vec3 hit = position + away * wi;
	bool is_hit = true;
	for ( int i = 0; i < 4; i ++ ) {
		vec3 a = corners[( i + 3 ) % 4];
		is_hit = is_hit && dot( cross( corners[i] - a, hit - a ), light_normal ) <= 0.0;
	}
	return is_hit ? away * away / ( light_area * - cosine ) : - 1.0;
}
vec2 fresnel( float cosine ) { float m = clamp( 1.0 - cosine, 0.0, 1.0 ); return vec2( 1.0, m * m * m * m * m ); }

void main() {
	ivec2 pixel = pixel_of();
	Shaded at = see( pixel );
	sum = first > 0 ? texelFetch( reference_sum, ivec2( gl_FragCoord.xy ), 0 ) : vec4( 0.0 );
	if ( at.coverage <= 0.0 ) return;
	uint a = hash( uint( pixel.y * size + pixel.x ) );
	uint b = hash( a ^ 0x9e3779b9u );
	uint c = hash( b ^ 0x9e3779b9u );
	uint d = hash( c ^ 0x9e3779b9u );
	float lambda_o = lambda( at.alpha, at.wo );
	float to_pdf = 1.0 / ( 4.0 * at.wo.z * ( 1.0 + lambda_o ) );
	for ( int i = first; i < first + samples; i ++ ) {
		vec3 wm = visible_normal( at.alpha, at.wo, point( uint( i ), uvec2( a, b ) ) );
		float cosine = dot( at.wo, wm );
		vec3 wi = 2.0 * cosine * wm - at.wo;
		if ( wi.z > HORIZON ) {
			float of_light = light_pdf( at.position, at.x * wi.x + at.y * wi.y + at.z * wi.z );
			if ( of_light >= 0.0 ) {
				float of_brdf = distribution( at.alpha, wm ) * to_pdf;
				float seen = ( 1.0 + lambda_o ) / ( 1.0 + lambda_o + lambda( at.alpha, wi ) );
				sum.xy += fresnel( cosine ) * ( seen * of_brdf / ( of_brdf + of_light ) );
			}
		}
		vec2 u = point( uint( i ), uvec2( c, d ) );
		bool is_second = u.x >= 0.5;
		float share = clamp( is_second ? 2.0 * u.x - 1.0 : 2.0 * u.x, 0.0, 1.0 );
		float root = sqrt( share );
		vec3 first_edge = corners[is_second ? 2 : 1] - corners[0];
		vec3 second_edge = corners[is_second ? 3 : 2] - corners[0];
		vec3 way = corners[0] + root * ( ( 1.0 - u.y ) * first_edge + u.y * second_edge ) - at.position;
		float distance2 = dot( way, way );
		vec3 direction = way / sqrt( max( distance2, 1e-36 ) );
		float facing = - dot( light_normal, direction );
		wi = vec3( dot( direction, at.x ), dot( direction, at.y ), dot( direction, at.z ) );
		if ( wi.z > HORIZON && facing > HORIZON ) {
			float of_light = distance2 / ( light_area * facing );
			wm = normalize( at.wo + wi );
			float of_brdf = distribution( at.alpha, wm ) * to_pdf;
			float seen = ( 1.0 + lambda_o ) / ( 1.0 + lambda_o + lambda( at.alpha, wi ) );
			sum.xy += fresnel( dot( at.wo, wm ) ) * ( seen * of_brdf / ( of_brdf + of_light ) );
		}
	}
}`;

/** The fragment shader that shows model and reference; `text` is the model's, of a table or of normals. */
export function displayShader( text, isTable ) {

	return `#version 300 es\n${ text }${ SURFACE }${ isTable ? BY_TABLE : BY_NORMALS }${ DISPLAY }`;

}

/** The fragment shader that adds samples. */
export const REFERENCE_SHADER = `#version 300 es\nprecision highp float;\nprecision highp int;\n${ SURFACE }${ REFERENCE }`;
