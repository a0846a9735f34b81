layout( location = 0 ) out vec4 out_place;
layout( location = 1 ) out vec4 out_tangent;
layout( location = 2 ) out vec4 out_normal;
layout( location = 3 ) out vec4 out_f0;

/** Three numbers from 0 to 1 in the 24 bits of a float, as square roots. */
float packed( vec3 colour ) {
	uvec3 bytes = uvec3( sqrt( clamp( colour, 0.0, 1.0 ) ) * 255.0 + 0.5 );
	return float( bytes.x << 16 | bytes.y << 8 | bytes.z );
}
