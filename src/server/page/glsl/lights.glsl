// The lights. `SHAPES_USED` has a bit for each shape in the scene, and 16 for pictures. A program contains only code for them,
// because software drivers run both sides of a branch.
// Bit 32 is for occluders, and 64 for models with shadows. `light_shape` is 0 for a polygon, 1 for an ellipse, 2 for a tube, 3 for a
// line. A sphere is a tube with equal ends. The vertices are the corners of the polygon, or of an octagon for an ellipse,
// clockwise from the lit side. The w of vertex i is the area of the triangles (0, 1, 2) to (0, i - 1, i), divided by the whole area.
const float HORIZON = 1e-6;
uniform int light_count, light_shape[4], light_corners[4], light_two_sided[4];
uniform vec3 light_radiance[4];
/** The layer of the light's picture, or -1. */
uniform int light_picture[4];
uniform vec4 light_vertices[32];
/** xyz: centre of an ellipse, or one end of a tube or line. w: radius of the tube, or width of the line. */
uniform vec4 light_centre[4];
/** xyz: half axes of an ellipse or rectangle. w: 1 / squared length. For a tube or line, light_x is the other end. */
uniform vec4 light_x[4], light_y[4];
/** xyz: unit normal of the lit side. w: area. */
uniform vec4 light_normal[4];

#if SHAPES_USED & 16
/** The argument `base` of the functions for pictures. */
uniform float picture_base;
#endif

bool is_shape( int l, int shape ) { return ( SHAPES_USED & ( 1 << shape ) ) != 0 && light_shape[l] == shape; }
bool is_pictured( int l ) { return ( SHAPES_USED & 16 ) != 0 && light_picture[l] >= 0; }
bool is_solid( int l ) { return is_shape( l, 2 ) || is_shape( l, 3 ); }
bool is_two_sided( int l ) { return light_two_sided[l] != 0 || is_solid( l ); }

/** Two unit vectors that form an orthonormal basis with axis. */
mat2x3 solid_basis( vec3 axis ) {
	vec3 x = normalize( cross( abs( axis.z ) > 0.7 ? vec3( 1.0, 0.0, 0.0 ) : vec3( 0.0, 0.0, 1.0 ), axis ) );
	return mat2x3( x, cross( axis, x ) );
}

/** The point on the line between both ends that is nearest to the shaded point, relative to the shaded point. */
vec3 solid_nearest( int l, vec3 position ) {
	vec3 start = light_centre[l].xyz - position;
	vec3 along = light_x[l].xyz - light_centre[l].xyz;
	return start + along * clamp( - dot( start, along ) / max( dot( along, along ), 1e-36 ), 0.0, 1.0 );
}

#if SHAPES_USED & 64
/** The visible part of each light. */
uniform sampler2D light_visible;
vec3 radiance_of( int l ) { return light_radiance[l] * texelFetch( light_visible, ivec2( gl_FragCoord.xy ), 0 )[l]; }
#else
vec3 radiance_of( int l ) { return light_radiance[l]; }
#endif

vec3 unit_of( vec3 v ) { return v / sqrt( max( dot( v, v ), 1e-36 ) ); }
