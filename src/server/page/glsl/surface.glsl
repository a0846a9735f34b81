// The unit sphere around the origin, or the floor y = 0, as in shaders/sphere.wgsl.
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
}
