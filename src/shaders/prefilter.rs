//! The text that prefilters a picture on a light, for any light model.

use super::{header::commented, sources::joined, stamp::head};

/// The revision, raised when the pyramid changes.
const REVISION: u32 = 1;

const LICENCE: &str = "MIT OR Apache-2.0";

/// The first part of the comment: description, functions and passes.
const ABOUT: &str = "\
The prefiltered pyramid of a picture on a rectangle light, for pictures that change, such as video: what `ltcforge light-texture`
makes of a file. For fragment or compute shaders, without filtering: each function gives one texel of what a pass writes.

FUNCTIONS
  prefilter_halved(texel, fine, coarse)  a texel of the chain, of `coarse` texels, from the level before, of `fine`.
  prefilter_row(row, width), prefilter_mean(height)  the mean of a row, and of a column of such.
  prefilter_level(texel, picture, level)  a texel of the pyramid from the same level of the chain and the level above.
  prefilter_size(picture, level), prefilter_levels(picture)  sizes, which are those of mip levels.

TEXTURES
  prefilter_source is what a pass reads, prefilter_above the level above; both linear, of 16 or 32 bits a number.

PASSES
  Of a picture of n levels; level 0 of the chain is the picture, and the chain's others can be the mip levels of one texture.
  1. for l from 1 to n - 2: chain level l is prefilter_halved(texel, size of l - 1, size of l) of chain level l - 1
  2. a texture of 1 x height: prefilter_row(texel.y, width) of the picture
  3. pyramid level n - 1, one texel: prefilter_mean(height) of that
  4. for l from n - 2 down to 0: pyramid level l is prefilter_level(texel, size of the picture, l) of chain level l and pyramid
     level l + 1
  A fragment shader's texel is vec2<u32>(position.xy); a compute shader's is its invocation, where that is below the size.
  The picture's texels are square on the light. Fetch at level log2(sigma / 2), with a sampler that is linear and clamps.

";

/// The comment at the top of the text.
#[must_use]
pub fn prefilter_comment() -> String {
    commented(&format!("{}{ABOUT}", head(LICENCE, REVISION)))
}

/// The functions, and a fragment shader named `ltc_included` that calls all of them.
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
