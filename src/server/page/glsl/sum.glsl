// Adds the light of the surface, and its coverage, to a sum over frames.
uniform sampler2D sum_before;
uniform int sum_count;
out vec4 sum;
void main() {
	Shaded at = shaded_point();
	sum = sum_count > 0 ? texelFetch( sum_before, ivec2( gl_FragCoord.xy ), 0 ) : vec4( 0.0 );
	if ( at.coverage > 0.0 ) sum += at.coverage * vec4( reflected( at ), 1.0 );
}
