//! The shader text that prefilters a picture on a light, for any light model.

use super::{header::commented, sources::joined, stamp::head};

/// The revision. It is raised when the pyramid changes.
const REVISION: u32 = 1;

const LICENCE: &str = "MIT OR Apache-2.0";

/// The first part of the comment: description, functions and passes.
const ABOUT: &str = "\
The prefiltered pyramid of a picture on a rectangle light, for pictures that change, such as video. For files, use
`ltcforge light-texture`. For fragment or compute shaders. Each function computes one texel that a pass writes.

FUNCTIONS
  prefilter_halved(texel, fine, coarse)  a texel of the chain at size `coarse`, from the level before at size `fine`.
  prefilter_row(row, width), prefilter_mean(height)  the mean of a row, and the mean of a column of rows' means.
  prefilter_level(texel, picture, level)  a texel of the pyramid, from the same chain level and the next coarser level.
  prefilter_size(picture, level), prefilter_levels(picture)  size of a level and number of levels, as for mipmaps.

TEXTURES
  prefilter_source is the input of a pass, prefilter_above the next coarser level of the pyramid. Both have linear
  numbers of 16 or 32 bits. The passes need no sampler.

PASSES
  For a picture with n levels. Chain level 0 is the picture; the other levels can be the mip levels of one texture.
  1. for l from 1 to n - 2: chain level l is prefilter_halved(texel, size of l - 1, size of l) of chain level l - 1
  2. a texture of 1 x height: prefilter_row(texel.y, width) of the picture
  3. pyramid level n - 1, one texel: prefilter_mean(height) of the texture of pass 2
  4. for l from n - 2 down to 0: pyramid level l is prefilter_level(texel, size of the picture, l) of chain level l and
     pyramid level l + 1
  In a fragment shader, texel is vec2<u32>(position.xy). In a compute shader, it is the invocation; skip those outside.
  The picture's texels must be square on the light. Read level log2(sigma / 2) with a sampler that is linear and clamps.

";

/// The comment at the top of the text.
#[must_use]
pub fn prefilter_comment() -> String {
    commented(&format!("{}{ABOUT}", head(LICENCE, REVISION)))
}

/// The functions, and a fragment shader named `ltc_included` that calls each of them.
#[must_use]
pub fn prefilter_source() -> String {
    let caller = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let picture = vec2(8u, 8u);
    let coarse = prefilter_halved(vec2(0u, 0u), picture, prefilter_size(picture, 1u));
    return vec4(coarse + prefilter_row(0u, 8u) + prefilter_mean(8u) + prefilter_level(vec2(0u, 0u), picture, 0u), 1.0);
}
";
    format!("{}{caller}", joined(&["prefilter"]))
}
