// The surface of a mesh. Triangles are two-sided. If the file has no tangents, they run around the vertical axis, as on the sphere.
in vec3 at_place, at_normal;
in vec4 at_tangent;
uniform vec3 f0, diffuse;
uniform vec4 material;
/** The number of the mesh. */
uniform int number;

#ifdef TEXTURED
// Normal, reflectance and roughness from textures [glTF 2.0, section 3.9].
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
#endif

void main() {
	vec3 normal = normalize( gl_FrontFacing ? at_normal : - at_normal );
	vec3 reflected = f0, scattered = diffuse;
	vec2 alpha = material.xy;
#ifdef TEXTURED
	normal = bent( normal );
	read_textures( reflected, scattered, alpha );
#endif
	vec3 along = dot( at_tangent.xyz, at_tangent.xyz ) > 1e-12 ? at_tangent.xyz : vec3( normal.z, 0.0, - normal.x );
	along -= normal * dot( normal, along );
	along = dot( along, along ) > 1e-8 ? normalize( along ) : normalize( cross( normal, abs( normal.x ) > 0.7 ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 ) ) );
	out_place = vec4( at_place, float( 1 + number ) );
	out_tangent = vec4( material.z * along + material.w * at_tangent.w * cross( normal, along ), alpha.x );
	out_normal = vec4( normal, alpha.y );
	out_f0 = vec4( reflected, packed( scattered ) );
}
