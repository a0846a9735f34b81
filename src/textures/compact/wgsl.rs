//! The decoder in WGSL: `shaders/ltc_decode.wgsl`, with constants for a table.

use std::fmt::Write as _;

use crate::about::About;
use ltcforge_files::compact::{CompactError, Outline};
use ltcforge_fit::Layout;

/// The source files of the decoder. Each follows the files that it needs.
const SOURCES: [&str; 4] =
    [ltcforge_wgsl::LTC_MATH, ltcforge_wgsl::LAYOUT_REFLECTED, ltcforge_wgsl::LTC_SMOOTH, ltcforge_wgsl::LTC_DECODE];
/// The number of integers that one dispatch of the first pass reads, and the number of extra integers that it passes to
/// the next dispatch, as in the shader.
const AT_ONCE: usize = 1024;
const STATE: usize = 2 * 339 + 4;

/// Sizes of the buffers that the host must create for the decoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sizes {
    /// The number of integers per channel.
    slot: usize,
    /// The number of entries of the table, which is also the number of texels of each texture.
    entries: usize,
    /// The number of textures.
    textures: usize,
}

impl Sizes {
    fn of(outline: &Outline) -> Self {
        let coefficients: usize = outline.counts.iter().map(|n| usize::from(*n)).product();
        let entries = outline.axes.lengths().named().iter().map(|(_, n)| **n).product();
        let corrections = if outline.corrected.contains(&true) { entries } else { 0 };
        let textures = if outline.layout == Layout::Reflected { 3 } else { 2 };
        Self { slot: coefficients + corrections, entries, textures }
    }
}

/// The WGSL module that decodes these bytes.
///
/// # Errors
/// The bytes are not a compact form.
pub(super) fn module(bytes: &[u8], about: &About) -> Result<String, CompactError> {
    let outline = Outline::of(bytes)?;
    let mut out = about.comment();
    // Writing to a String cannot fail.
    let _ = write_module(&mut out, bytes.len(), &outline);
    Ok(out)
}

/// Domain: layouts `reflected` and `ltc2017`.
fn write_module(out: &mut String, bytes: usize, outline: &Outline) -> std::fmt::Result {
    let Sizes { slot, entries, textures } = Sizes::of(outline);
    let lengths = outline.axes.lengths();
    let is_reflected = outline.layout == Layout::Reflected;
    let [alpha, ratio, theta, phi] = lengths.named().map(|(_, n)| *n);
    let (names, size) = if is_reflected {
        ("ltc_matrix_a, ltc_matrix_b, ltc_terms", format!("{phi} x {} x {alpha}", ratio * theta))
    } else {
        ("LTC_1, LTC_2", format!("{alpha} x {theta}"))
    };
    writeln!(
        out,
        "//\n// Rebuilds the table's textures at load. SPDX-License-Identifier: MIT OR Apache-2.0\n//\n\
         // BINDINGS of group 0\n\
         //   0  storage, read:        {:>9} bytes: the file ltc.compact and zeros after it\n\
         //   1  storage, read_write:  {:>9} bytes: scratch memory of the decoder, zeros\n\
         //   2  storage, read_write:  {:>9} bytes: RGBA of 32 bits, {names}, each {size}\n\
         // PASSES\n\
         //   ltc_read, {} dispatches of 1 workgroup; then ltc_expand, {} workgroups. Copy the texels to textures of 16 or\n\
         //   32 bits, or leave them in the buffer.\n",
        bytes.next_multiple_of(4),
        4 * (9 * slot + STATE),
        16 * textures * entries,
        (9 * slot).div_ceil(AT_ONCE),
        entries.div_ceil(64)
    )?;
    let mask = |on: [bool; 9]| (0..).zip(on).map(|(i, on)| u32::from(on) << i).sum::<u32>();
    writeln!(out, "const LTC_BYTES: u32 = {bytes}u;\nconst LTC_CODED_AT: u32 = {}u;", outline.coded_at)?;
    writeln!(out, "const LTC_NODES = vec4<u32>({alpha}u, {ratio}u, {theta}u, {phi}u);")?;
    let [a, r, t, p] = outline.counts;
    writeln!(out, "const LTC_COUNTS = vec4<u32>({a}u, {r}u, {t}u, {p}u);\nconst LTC_SLOT: u32 = {slot}u;")?;
    writeln!(out, "const LTC_STATE: u32 = {}u;", 9 * slot)?;
    writeln!(out, "const LTC_STORED: u32 = {}u;", mask(outline.steps.map(|step| step != 0.0)))?;
    writeln!(out, "const LTC_CORRECTED: u32 = {}u;", mask(outline.corrected))?;
    writeln!(
        out,
        "const LTC_HAS_TERMS: bool = {};\nconst LTC_IS_REFLECTED: bool = {is_reflected};",
        outline.has_terms
    )?;
    writeln!(out, "const LTC_CORRECTION_STEPS: f32 = {:?};", outline.correction_steps)?;
    let list = |numbers: Vec<f32>| numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
    writeln!(out, "const LTC_STEPS = array<f32, 9>({});", list(outline.steps.to_vec()))?;
    let nodes: Vec<f32> = outline.axes.named().iter().flat_map(|(_, nodes)| nodes.iter().map(|x| *x as f32)).collect();
    writeln!(out, "const LTC_AXES = array<f32, {}>({});\n", nodes.len(), list(nodes))?;
    SOURCES.iter().try_for_each(|source| writeln!(out, "{source}"))
}
