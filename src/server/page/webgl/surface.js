// The surface at each pixel, in GLSL ES: a sphere or a floor as in previews, or a mesh.
//
// The programs write position, tangent frame and material to textures, which all other programs of the viewer read. The w of a
// position is the coverage, or 1 plus the number of the mesh.

/** Precisions. Without one, the values of a sampler may have 16 bits. */
export const PRECISE = 'precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler2DArray;\n';
const HEAD = `#version 300 es\n${ PRECISE }`;

const TARGETS = `
layout( location = 0 ) out vec4 out_place;
layout( location = 1 ) out vec4 out_tangent;
layout( location = 2 ) out vec4 out_normal;
layout( location = 3 ) out vec4 out_f0;

/** Three numbers from 0 to 1 in the 24 bits of a float, as square roots. */
float packed( vec3 colour ) {
	uvec3 bytes = uvec3( sqrt( clamp( colour, 0.0, 1.0 ) ) * 255.0 + 0.5 );
	return float( bytes.x << 16 | bytes.y << 8 | bytes.z );
}
`;

/** The unit sphere around the origin, or the floor y = 0, as in shaders/sphere.wgsl. */
export const SURFACE_SHADER = `${ HEAD }${ TARGETS }
uniform int size, surface;
uniform vec3 eye, right, up, forward, f0, diffuse;
uniform float pixel_width;
uniform vec4 material;

void main() {
	ivec2 pixel = ivec2( int( gl_FragCoord.x ), size - 1 - int( gl_FragCoord.y ) );
	vec2 middle = ( vec2( pixel ) + 0.5 ) / float( size ) * 2.0 - 1.0;
	vec3 ray = normalize( forward + right * middle.x - up * middle.y );
	vec3 position, normal, along;
	float coverage;
	if ( surface == 1 ) {
		float t = - eye.y / min( ray.y, - 1e-6 );
		position = eye + t * ray;
		position.y = 0.0;
		normal = vec3( 0.0, 1.0, 0.0 );
		along = vec3( 1.0, 0.0, 0.0 );
		coverage = ray.y < - 1e-6 && eye.y > 1e-3 ? clamp( 2.0 * ( 1.0 - t / 12.0 ), 0.0, 1.0 ) : 0.0;
	} else {
		float closest = - dot( eye, ray );
		vec3 nearest = eye + closest * ray;
		float distance2 = dot( nearest, nearest );
		float rim = ( 1.0 - sqrt( distance2 ) ) / ( pixel_width * closest );
		coverage = closest > 0.0 ? clamp( rim + 0.5, 0.0, 1.0 ) : 0.0;
		position = normalize( nearest - sqrt( max( 1.0 - distance2, 0.0 ) ) * ray );
		normal = position;
		vec3 circle = vec3( normal.z, 0.0, - normal.x );
		float length2 = dot( circle, circle );
		along = length2 > 1e-8 ? circle / sqrt( max( length2, 1e-12 ) ) : vec3( 1.0, 0.0, 0.0 );
	}
	out_place = vec4( position, coverage );
	out_tangent = vec4( material.z * along + material.w * cross( normal, along ), material.x );
	out_normal = vec4( normal, material.y );
	out_f0 = vec4( f0, packed( diffuse ) );
}`;

/** Projects the triangles of a mesh with the same camera. The image is the square from -1 to 1. */
export const MESH_VERTEX = `#version 300 es
layout( location = 0 ) in vec3 place;
layout( location = 1 ) in vec3 normal;
layout( location = 2 ) in vec4 tangent;
layout( location = 3 ) in vec2 uv;
uniform vec3 eye, right, up, forward;
/** Moves the image by a part of a pixel. */
uniform vec2 jitter;
out vec3 at_place, at_normal;
out vec4 at_tangent;
out vec2 at_uv;
const float NEAR = 0.05, FAR = 100.0;
void main() {
	vec3 way = place - eye;
	float depth = dot( way, forward );
	gl_Position = vec4( vec2( dot( way, right ) / dot( right, right ), dot( way, up ) / dot( up, up ) ) + jitter * depth, ( depth * ( FAR + NEAR ) - 2.0 * FAR * NEAR ) / ( FAR - NEAR ), depth );
	at_place = place;
	at_normal = normal;
	at_tangent = tangent;
	at_uv = uv;
}`;

/** Normal, reflectance and roughness from textures [glTF 2.0, section 3.9]. */
const TEXTURED = `
in vec2 at_uv;
uniform sampler2D base_texture, rough_texture, normal_texture;
uniform vec3 base;
uniform vec4 factors;
uniform float normal_scale, is_white;

/** The normal from the normal texture. If a mesh has no tangents, they are computed from screen-space derivatives: x runs along u, y against v. */
vec3 bent( vec3 normal ) {
	vec3 px = dFdx( at_place ), py = dFdy( at_place );
	vec2 ux = dFdx( at_uv ), uy = dFdy( at_uv );
	float side = ux.x * uy.y < uy.x * ux.y ? - 1.0 : 1.0;
	bool is_given = dot( at_tangent.xyz, at_tangent.xyz ) > 1e-12;
	vec3 x = is_given ? at_tangent.xyz : side * ( px * uy.y - py * ux.y );
	x -= normal * dot( normal, x );
	if ( dot( x, x ) < 1e-24 ) return normal;
	x = normalize( x );
	vec3 y = cross( normal, x );
	y *= is_given ? at_tangent.w : dot( y, side * ( px * uy.x - py * ux.x ) ) < 0.0 ? - 1.0 : 1.0;
	vec3 stored = texture( normal_texture, at_uv ).xyz * 2.0 - 1.0;
	return normalize( x * stored.x * normal_scale + y * stored.y * normal_scale + normal * max( stored.z, 1e-3 ) );
}

void read_textures( out vec3 reflected, out vec3 scattered, out vec2 alpha ) {
	vec4 rough = texture( rough_texture, at_uv );
	alpha.y = factors.y * rough.g * factors.y * rough.g;
	alpha.x = mix( alpha.y, 1.0, factors.w );
	vec3 own = base * texture( base_texture, at_uv ).rgb;
	float metal = factors.x * rough.b;
	reflected = mix( mix( vec3( factors.z ), own, metal ), vec3( 1.0 ), is_white );
	scattered = own * ( 1.0 - metal ) * ( 1.0 - is_white );
}
`;

/** The surface of a mesh. Triangles are two-sided. If the file has no tangents, they run around the vertical axis, as on the sphere. */
export const meshShader = ( isTextured ) => `${ HEAD }${ TARGETS }
in vec3 at_place, at_normal;
in vec4 at_tangent;
uniform vec3 f0, diffuse;
uniform vec4 material;
/** The number of the mesh. */
uniform int number;
${ isTextured ? TEXTURED : '' }
void main() {
	vec3 normal = normalize( gl_FrontFacing ? at_normal : - at_normal );
	vec3 reflected = f0, scattered = diffuse;
	vec2 alpha = material.xy;
${ isTextured ? '	normal = bent( normal );\n	read_textures( reflected, scattered, alpha );' : '' }
	vec3 along = dot( at_tangent.xyz, at_tangent.xyz ) > 1e-12 ? at_tangent.xyz : vec3( normal.z, 0.0, - normal.x );
	along -= normal * dot( normal, along );
	along = dot( along, along ) > 1e-8 ? normalize( along ) : normalize( cross( normal, abs( normal.x ) > 0.7 ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 ) ) );
	out_place = vec4( at_place, float( 1 + number ) );
	out_tangent = vec4( material.z * along + material.w * at_tangent.w * cross( normal, along ), alpha.x );
	out_normal = vec4( normal, alpha.y );
	out_f0 = vec4( reflected, packed( scattered ) );
}`;

/** Reads the surface at a pixel. A view direction below the surface is moved just above it. */
export const SURFACE_POINT = `
uniform sampler2D surface_position, surface_tangent, surface_normal, surface_f0;
uniform vec3 eye;
struct Shaded { vec3 position, x, y, z, wo, f0, diffuse; vec2 alpha; float coverage; };

Shaded shaded_point() {
	ivec2 texel = ivec2( gl_FragCoord.xy );
	vec4 place = texelFetch( surface_position, texel, 0 );
	vec4 tangent = texelFetch( surface_tangent, texel, 0 );
	vec4 normal = texelFetch( surface_normal, texel, 0 );
	Shaded at;
	at.position = place.xyz;
	at.coverage = min( place.w, 1.0 );
	at.x = tangent.xyz;
	at.z = normal.xyz;
	at.y = cross( at.z, at.x );
	vec3 view = normalize( eye - at.position );
	at.wo = normalize( vec3( dot( view, at.x ), dot( view, at.y ), max( dot( view, at.z ), 1e-3 ) ) );
	at.alpha = max( vec2( tangent.w, normal.w ), vec2( 1e-5 ) );
	vec4 f0 = texelFetch( surface_f0, texel, 0 );
	at.f0 = f0.xyz;
	uint bytes = uint( f0.w );
	vec3 root = vec3( bytes >> 16, bytes >> 8 & 255u, bytes & 255u ) / 255.0;
	at.diffuse = root * root;
	return at;
}
`;
