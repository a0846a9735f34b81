// Prefilters the picture of a rectangle light, for pictures that change. Several passes make a pyramid of levels. Each
// function computes one texel that a pass writes. Every result is linear in the picture.

/// The input of a pass: the picture, or a level of the chain of halved pictures.
@group(0) @binding(0) var prefilter_source: texture_2d<f32>;
/// The next coarser level of the pyramid.
@group(0) @binding(1) var prefilter_above: texture_2d<f32>;

/// The size of level `level` of a picture, in texels.
fn prefilter_size(picture: vec2<u32>, level: u32) -> vec2<u32> {
    return vec2(max(picture.x >> level, 1u), max(picture.y >> level, 1u));
}

/// The number of levels of a picture.
fn prefilter_levels(picture: vec2<u32>) -> u32 {
    var levels = 1u;
    for (var side = max(picture.x, picture.y); side > 1u; side = side >> 1u) {
        levels += 1u;
    }
    return levels;
}

/// The weight of the tent filter at an offset from the middle of a coarse texel. A coarse texel is `ratio` fine texels
/// long.
fn prefilter_tent(offset: f32, ratio: f32, coarse: u32) -> f32 {
    // A single coarse texel is the mean of the level.
    return select(max(1.0 - abs(offset) / ratio, 0.0), 1.0, coarse == 1u);
}

/// A texel of the next level of the chain, from the level before it. The next level has `coarse` texels, the level
/// before it has `fine`. The filter is [1 3 3 1] / 8 along an axis with an even size.
fn prefilter_halved(texel: vec2<u32>, fine: vec2<u32>, coarse: vec2<u32>) -> vec3<f32> {
    let ratio = vec2<f32>(fine) / vec2<f32>(coarse);
    let middle = (vec2<f32>(texel) + vec2(0.5)) * ratio - vec2(0.5);
    let first = vec2<u32>(max(ceil(middle - ratio), vec2(0.0)));
    let last = min(vec2<u32>(middle + ratio), fine - vec2(1u));
    var sum = vec3(0.0);
    var mass = 0.0;
    for (var y = first.y; y <= last.y; y += 1u) {
        for (var x = first.x; x <= last.x; x += 1u) {
            let down = prefilter_tent(f32(y) - middle.y, ratio.y, coarse.y);
            let weight = down * prefilter_tent(f32(x) - middle.x, ratio.x, coarse.x);
            sum += weight * textureLoad(prefilter_source, vec2(x, y), 0).xyz;
            mass += weight;
        }
    }
    return sum / mass;
}

/// The mean of a row of the picture. One call for each row gives a column.
fn prefilter_row(row: u32, width: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var x = 0u; x < width; x += 1u) {
        sum += textureLoad(prefilter_source, vec2(x, row), 0).xyz;
    }
    return sum / f32(width);
}

/// The mean of the column that prefilter_row wrote: the last level.
fn prefilter_mean(height: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var y = 0u; y < height; y += 1u) {
        sum += textureLoad(prefilter_source, vec2(0u, y), 0).xyz;
    }
    return sum / f32(height);
}

/// The weight of each neighbour in the blur of a level, along an axis with `size` texels in the picture. It is a
/// quarter if sizes are even, and smaller if halving has already blurred more.
fn prefilter_beside(size: u32, level: u32) -> f32 {
    var here = size;
    var length = 1.0;
    var halved = 0.0;
    var wanted = 0.75;
    for (var i = 0u; i < level; i += 1u) {
        let next = max(here >> 1u, 1u);
        let next_length = f32(size) / f32(next);
        halved += select(0.0, next_length * next_length / 6.0 + length * length / 12.0, next < here);
        here = next;
        length = next_length;
        wanted *= 4.0;
    }
    return max((wanted - 0.25 - halved) / (2.0 * length * length), 0.0);
}

/// The share of a level's own blur; the rest comes from the next coarser level.
fn prefilter_own(level: u32, levels: u32) -> f32 {
    let above = levels - 1u - level;
    return select(select(0.65, 0.75, above == 2u), 0.85, above == 1u);
}

/// The next coarser level, interpolated at the middle of a texel. `size` and `above` are the sizes of both levels.
fn prefilter_up(texel: vec2<u32>, size: vec2<u32>, above: vec2<u32>) -> vec3<f32> {
    let last = vec2<f32>(above) - vec2(1.0);
    let at = clamp((vec2<f32>(texel) + vec2(0.5)) * vec2<f32>(above) / vec2<f32>(size) - vec2(0.5), vec2(0.0), last);
    let near = vec2<u32>(at);
    let far = min(near + vec2(1u), above - vec2(1u));
    let part = at - vec2<f32>(near);
    let top = mix(textureLoad(prefilter_above, near, 0).xyz, textureLoad(prefilter_above, vec2(far.x, near.y), 0).xyz, part.x);
    let bottom = mix(textureLoad(prefilter_above, vec2(near.x, far.y), 0).xyz, textureLoad(prefilter_above, far, 0).xyz, part.x);
    return mix(top, bottom, part.y);
}

/// A texel of level `level` of the pyramid, from the same level of the chain and the next coarser level of the pyramid.
/// Domain: all levels except the last.
fn prefilter_level(texel: vec2<u32>, picture: vec2<u32>, level: u32) -> vec3<f32> {
    let size = prefilter_size(picture, level);
    let beside = vec2(prefilter_beside(picture.x, level), prefilter_beside(picture.y, level));
    let first = max(texel, vec2(1u)) - vec2(1u);
    let last = min(texel + vec2(1u), size - vec2(1u));
    var sum = vec3(0.0);
    var mass = 0.0;
    for (var y = first.y; y <= last.y; y += 1u) {
        for (var x = first.x; x <= last.x; x += 1u) {
            let down = select(beside.y, 1.0 - 2.0 * beside.y, y == texel.y);
            let weight = down * select(beside.x, 1.0 - 2.0 * beside.x, x == texel.x);
            sum += weight * textureLoad(prefilter_source, vec2(x, y), 0).xyz;
            mass += weight;
        }
    }
    let own = prefilter_own(level, prefilter_levels(picture));
    return mix(prefilter_up(texel, size, prefilter_size(picture, level + 1u)), sum / mass, own);
}
