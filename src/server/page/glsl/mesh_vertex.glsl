// Projects the triangles of a mesh with the same camera. The image is the square from -1 to 1.
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
}
