// Both sides and the truth: sums over frames. A weight is the reciprocal of the number of frames or samples.
uniform sampler2D left_sum, right_sum, even_sum, odd_sum;
uniform float model_weight, truth_weight;
/** Whether the right side is a model. Otherwise it is the truth. */
uniform int has_right;
vec4 left_of( ivec2 texel ) { return texelFetch( left_sum, texel, 0 ) * model_weight; }
vec4 truth_of( ivec2 texel ) { return ( texelFetch( even_sum, texel, 0 ) + texelFetch( odd_sum, texel, 0 ) ) * truth_weight; }
vec4 right_of( ivec2 texel ) { return has_right != 0 ? texelFetch( right_sum, texel, 0 ) * model_weight : truth_of( texel ); }
float mean( vec4 colour ) { return dot( colour.rgb, vec3( 1.0 / 3.0 ) ); }
