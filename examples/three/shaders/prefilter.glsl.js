export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: 1108e1dfa31cd79a
// The prefiltered pyramid of a picture on a rectangle light, for pictures that change, such as video: what \`ltcforge light-texture\`
// makes of a file. For fragment or compute shaders, without filtering: each function gives one texel of what a pass writes.
//
// FUNCTIONS
//   prefilter_halved(texel, fine, coarse)  a texel of the chain, of \`coarse\` texels, from the level before, of \`fine\`.
//   prefilter_row(row, width), prefilter_mean(height)  the mean of a row, and of a column of such.
//   prefilter_level(texel, picture, level)  a texel of the pyramid from the same level of the chain and the level above.
//   prefilter_size(picture, level), prefilter_levels(picture)  sizes, which are those of mip levels.
//
// TEXTURES
//   prefilter_source is what a pass reads, prefilter_above the level above; both linear, of 16 or 32 bits a number.
//
// PASSES
//   Of a picture of n levels; level 0 of the chain is the picture, and the chain's others can be the mip levels of one texture.
//   1. for l from 1 to n - 2: chain level l is prefilter_halved(texel, size of l - 1, size of l) of chain level l - 1
//   2. a texture of 1 x height: prefilter_row(texel.y, width) of the picture
//   3. pyramid level n - 1, one texel: prefilter_mean(height) of that
//   4. for l from n - 2 down to 0: pyramid level l is prefilter_level(texel, size of the picture, l) of chain level l and pyramid
//      level l + 1
//   A fragment shader's texel is vec2<u32>(position.xy); a compute shader's is its invocation, where that is below the size.
//   The picture's texels are square on the light. Fetch at level log2(sigma / 2), with a sampler that is linear and clamps.
//

precision highp float;
precision highp int;

// The prefilter of a picture on a rectangle light, for pictures that change: passes that make its pyramid, each function a
// texel of what a pass writes. Linear in texels.

// What a pass reads: a level of the chain, or the picture.
uniform highp sampler2D prefilter_source;
// The next coarser level of the pyramid.
uniform highp sampler2D prefilter_above;

// The texels of level \`level\` of a picture.
uvec2 prefilter_size(uvec2 picture, uint level) {
    return uvec2(max(picture.x >> level, 1u), max(picture.y >> level, 1u));
}

// How many levels a picture has.
uint prefilter_levels(uvec2 picture) {
    uint levels = 1u;
    for (uint side = max(picture.x, picture.y); side > 1u; side = side >> 1u) {
        levels += 1u;
    }
    return levels;
}

// The weight of a texel that is away from the middle of one that is ratio texels long.
float prefilter_tent(float away, float ratio, uint coarse) {
    // A single texel is the mean.
    return coarse == 1u ? 1.0 : max(1.0 - abs(away) / ratio, 0.0);
}

// A texel of the next level of the chain, of coarse texels, from the level before, of fine: [1 3 3 1] / 8 along both axes
// where sizes are even.
vec3 prefilter_halved(uvec2 texel, uvec2 fine, uvec2 coarse) {
    vec2 ratio = vec2(fine) / vec2(coarse);
    vec2 middle = (vec2(texel) + vec2(0.5)) * ratio - vec2(0.5);
    uvec2 first = uvec2(max(ceil(middle - ratio), vec2(0.0)));
    uvec2 last = min(uvec2(middle + ratio), fine - uvec2(1u));
    vec3 sum = vec3(0.0);
    float mass = 0.0;
    for (uint y = first.y; y <= last.y; y += 1u) {
        for (uint x = first.x; x <= last.x; x += 1u) {
            float down = prefilter_tent(float(y) - middle.y, ratio.y, coarse.y);
            float weight = down * prefilter_tent(float(x) - middle.x, ratio.x, coarse.x);
            sum += weight * texelFetch(prefilter_source, ivec2(uvec2(x, y)), 0).xyz;
            mass += weight;
        }
    }
    return sum / mass;
}

// The mean of a row of the picture: with one for each row, a column.
vec3 prefilter_row(uint row, uint width) {
    vec3 sum = vec3(0.0);
    for (uint x = 0u; x < width; x += 1u) {
        sum += texelFetch(prefilter_source, ivec2(uvec2(x, row)), 0).xyz;
    }
    return sum / float(width);
}

// The mean of such a column: the last level.
vec3 prefilter_mean(uint height) {
    vec3 sum = vec3(0.0);
    for (uint y = 0u; y < height; y += 1u) {
        sum += texelFetch(prefilter_source, ivec2(uvec2(0u, y)), 0).xyz;
    }
    return sum / float(height);
}

// How much of a neighbour a texel takes, along an axis on which the picture has size texels: a quarter where sizes are even,
// less where halving has spread more.
float prefilter_beside(uint size, uint level) {
    uint here = size;
    float length_ = 1.0;
    float halved = 0.0;
    float wanted = 0.75;
    for (uint i = 0u; i < level; i += 1u) {
        uint next = max(here >> 1u, 1u);
        float next_length = float(size) / float(next);
        halved += next < here ? next_length * next_length / 6.0 + length_ * length_ / 12.0 : 0.0;
        here = next;
        length_ = next_length;
        wanted *= 4.0;
    }
    return max((wanted - 0.25 - halved) / (2.0 * length_ * length_), 0.0);
}

// How much of a level is its own blur; the rest comes from the level above.
float prefilter_own(uint level, uint levels) {
    uint above = levels - 1u - level;
    return above == 1u ? 0.85 : (above == 2u ? 0.75 : 0.65);
}

// Between the texels of the level above, of above texels, where a texel of size texels has its middle.
vec3 prefilter_up(uvec2 texel, uvec2 size, uvec2 above) {
    vec2 last = vec2(above) - vec2(1.0);
    vec2 at = clamp((vec2(texel) + vec2(0.5)) * vec2(above) / vec2(size) - vec2(0.5), vec2(0.0), last);
    uvec2 near = uvec2(at);
    uvec2 far = min(near + uvec2(1u), above - uvec2(1u));
    vec2 part = at - vec2(near);
    vec3 top = mix(texelFetch(prefilter_above, ivec2(near), 0).xyz, texelFetch(prefilter_above, ivec2(uvec2(far.x, near.y)), 0).xyz, part.x);
    vec3 bottom = mix(texelFetch(prefilter_above, ivec2(uvec2(near.x, far.y)), 0).xyz, texelFetch(prefilter_above, ivec2(far), 0).xyz, part.x);
    return mix(top, bottom, part.y);
}

// A texel of level \`level\` of the pyramid, but the last, from the same level of the chain and the level above.
vec3 prefilter_level(uvec2 texel, uvec2 picture, uint level) {
    uvec2 size = prefilter_size(picture, level);
    vec2 beside = vec2(prefilter_beside(picture.x, level), prefilter_beside(picture.y, level));
    uvec2 first = max(texel, uvec2(1u)) - uvec2(1u);
    uvec2 last = min(texel + uvec2(1u), size - uvec2(1u));
    vec3 sum = vec3(0.0);
    float mass = 0.0;
    for (uint y = first.y; y <= last.y; y += 1u) {
        for (uint x = first.x; x <= last.x; x += 1u) {
            float down = y == texel.y ? 1.0 - 2.0 * beside.y : beside.y;
            float weight = down * (x == texel.x ? 1.0 - 2.0 * beside.x : beside.x);
            sum += weight * texelFetch(prefilter_source, ivec2(uvec2(x, y)), 0).xyz;
            mass += weight;
        }
    }
    float own = prefilter_own(level, prefilter_levels(picture));
    return mix(prefilter_up(texel, size, prefilter_size(picture, level + 1u)), sum / mass, own);
}
`;
