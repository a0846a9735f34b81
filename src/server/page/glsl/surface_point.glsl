// Reads the surface at a pixel. A view direction below the surface is moved just above it.
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
