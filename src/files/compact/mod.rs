//! The compact form of a table, for programs in which a texture would be too large. An entry takes a hundredth of a
//! byte to four bytes.
//!
//! An entry has nine numbers that vary smoothly, one for each channel (`fit::layout::smooth`). Over the nodes, a
//! channel is a sum of products of Gram's polynomials. Their coefficients are rounded to multiples of a step and coded
//! by a range coder. Where the rounded sum is off by more than five steps, a correction is stored for the node. Thus an
//! edge in a table costs bytes, not accuracy. A decoder rebuilds the numbers of the table's layout.
//!
//! Steps are fractions of a lobe's width: see `rounding`. The error that they cause is measured, and the steps become
//! finer until the decoded table is at most 1 % worse.
//!
//! Invariant: equal tables give equal bytes, and equal bytes give equal tables, on every machine. Hostile bytes give an
//! error, never a panic.

mod coder;
mod decoder;
mod error;
mod header;
mod integers;
mod outline;
mod polynomials;
mod predicted;
mod rounding;

use coder::Encoder;
use decoder::{Bases, CHANNELS, MOST_BITS, Models, multiples};
pub use error::CompactError;
pub use header::COMPACT_MAGIC;
pub use header::LAYOUTS;
use header::{Header, TERMS};
pub use outline::Outline;
use polynomials::most_polynomials;
pub use predicted::{CompactBytes, encoded_and_decoded};
use rounding::Rounding;

use ltcforge_fit::{Spread, Table, width_between};

/// The source of the decoder for the bytes after a header. It needs no crate.
pub const DECODER: &str = include_str!("decoder.rs");

/// Coefficients with a fraction below `1 - ROUND_UP` are rounded towards zero. This saves many bytes for a small loss
/// of accuracy.
const ROUND_UP: f64 = 0.4;
/// The smallest error of a number that is corrected, in steps of its channel.
const MOST_MISSED: f64 = 5.0;

/// The largest mean error of a decoded table between nodes, relative to the table's mean error.
const MOST_ERROR: f64 = 1.01;
/// The number of places between nodes where both errors are measured.
const MEASURED_AT: usize = 512;
/// Maximum number of roundings that are tried. The steps of the last are 28 times finer than those of the first.
const ATTEMPTS: u32 = 16;

/// A compact form, and its cost: errors between nodes as fractions of a lobe's width, at 512 places.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoded {
    /// The compact form.
    pub bytes: Vec<u8>,
    /// The errors of the table.
    pub table: Spread,
    /// The errors of the table that the bytes decode to. Their mean is at most 1 % above the mean of `table`.
    pub decoded: Spread,
}

/// The compact form of a table: [`encode_measured`] without the errors.
///
/// # Errors
/// Like [`encode_measured`].
pub fn encode(table: &Table) -> Result<Vec<u8>, CompactError> {
    encode_measured(table).map(|encoded| encoded.bytes)
}

/// The compact form of a table, with a mean error between nodes that is at most 1 % above the table's. It contains
/// neither `node_error` nor a second lobe: see [`encode_lobes`]. Runs on the current rayon pool: about a second on two
/// cores, and half a second more for each refinement of the steps. The result does not depend on the size of the pool.
///
/// # Errors
/// The table has a layout without a compact form, too many entries, nodes that are not its layout's, a matrix whose
/// determinant is not positive, an amplitude of zero, or lobes for which no steps are accurate enough.
pub fn encode_measured(table: &Table) -> Result<Encoded, CompactError> {
    if !LAYOUTS.contains(&table.layout()) {
        return Err(CompactError::Layout { layout: table.layout().to_string() });
    }
    check_lobes(table)?;
    let header = header_of(table)?;
    check_determinants(table)?;
    let numbers = table.smooth_numbers();
    if let Some(entry) = numbers.iter().position(|entry| entry.iter().any(|x| !x.is_finite())) {
        return Err(CompactError::Entry { entry });
    }
    let errors = width_between(table, MEASURED_AT);
    let (mut rounding, mut reached) = (Rounding::of(table), f64::NAN);
    for _ in 0..ATTEMPTS {
        let bytes = encode_rounded(table, header.clone(), &numbers, rounding)?;
        // The bytes name the scattering model, but not the materials whose lobe was fitted, so `table` provides both.
        let decoded = Table { brdf: table.brdf.clone(), ..decode(&bytes)? };
        let decoded = width_between(&decoded, MEASURED_AT);
        reached = decoded.mean;
        if reached <= MOST_ERROR * errors.mean {
            return Ok(Encoded { bytes, table: errors, decoded });
        }
        rounding = rounding.finer();
    }
    Err(CompactError::Inexact { table: format!("{:.4}", errors.mean), decoded: format!("{reached:.4}") })
}

/// The compact forms of a table's lobes: one or two forms. The second decodes to [`Table::of_second`] without terms.
///
/// # Errors
/// Like [`encode_measured`].
pub fn encode_lobes(table: &Table) -> Result<Vec<Encoded>, CompactError> {
    let second = table.of_second().map(|second| Table { terms: None, ..second });
    [encode_measured(table)].into_iter().chain(second.as_ref().map(encode_measured)).collect()
}

/// Rejects lobes that are not LTCs, because decoders read LTCs, and lobes that do not follow the reflection to which
/// [`Table::smooth_numbers`] are relative.
///
/// # Errors
/// [`CompactError::Lobe`] and [`CompactError::Reflection`].
pub fn check_lobes(table: &Table) -> Result<(), CompactError> {
    let (brdf, lobe) = (table.brdf(), table.lobe());
    if lobe.gaussian().is_some() {
        return Err(CompactError::Lobe { lobe });
    }
    if brdf.follows_reflection() { Ok(()) } else { Err(CompactError::Reflection { brdf }) }
}

/// Rejects matrices that [`Table::smooth_numbers`] cannot represent.
fn check_determinants(table: &Table) -> Result<(), CompactError> {
    let mut refused = table.determinants().enumerate().filter(|(_, determinant)| *determinant <= 0.0);
    let Some((entry, _)) = refused.next() else { return Ok(()) };
    Err(CompactError::Determinants { count: 1 + refused.count(), entry, place: table.place_of(entry) })
}

/// Encodes a table with the steps of a rounding. Domain: a header and finite numbers of this table.
fn encode_rounded(
    table: &Table,
    mut header: Header,
    numbers: &[[f64; CHANNELS]],
    rounding: Rounding,
) -> Result<Vec<u8>, CompactError> {
    header.correction_steps = rounding.correction_steps;
    let bases = bases(&header);
    let (mut models, mut corrections) = (Models::new(), Models::new());
    let mut encoder = Encoder::new();
    for channel in 0..CHANNELS {
        let exact: Vec<f64> = numbers.iter().map(|entry| entry[channel]).collect();
        let is_left_out =
            if TERMS.contains(&channel) { table.terms().is_none() } else { exact.iter().all(|x| x.abs() < 1e-6) };
        if is_left_out {
            continue;
        }
        let step = rounding.step(channel) as f32;
        header.steps[channel] = Some(step);
        let step = f64::from(step);
        let smooth = rounding.smoothed(table, step, exact.clone());
        let rounded = rounded(&bases.coefficients(smooth), step, ROUND_UP);
        let rounded = rounded.ok_or(CompactError::Large { channel })?;
        models.write(bases.counts(), &rounded, &mut encoder);
        let values = bases.values(multiples(&rounded, step));
        let missed = exact.iter().zip(values).enumerate().map(|(entry, (exact, value))| {
            let missed = exact - value;
            let is_large = missed.abs() >= MOST_MISSED * step * rounding.tolerance(channel, &numbers[entry]);
            if is_large && rounding.is_seen(table, channel, entry, [*exact, value], step) { missed } else { 0.0 }
        });
        let missed: Vec<f64> = missed.collect();
        let correction = self::rounded(&missed, step * f64::from(header.correction_steps), 0.5);
        let correction = correction.ok_or(CompactError::Large { channel })?;
        if correction.iter().any(|x| *x != 0) {
            header.corrected[channel] = true;
            corrections.write(bases.nodes(), &correction, &mut encoder);
        }
    }
    let mut bytes = header.bytes();
    bytes.extend(encoder.finish());
    Ok(bytes)
}

/// Decodes a compact form to a table in its layout. The nodes are exact, and the numbers are as accurate as the lobes
/// need. Every `node_error` is NaN.
///
/// # Errors
/// The bytes are not a compact form.
pub fn decode(bytes: &[u8]) -> Result<Table, CompactError> {
    let (header, coded) = Header::read(bytes)?;
    let axes = header.axes()?;
    let (numbers, left) = header.coded(coded).numbers().ok_or(CompactError::Short)?;
    if left > 0 {
        return Err(CompactError::Long { bytes: left });
    }
    let items = (header.brdf, header.lobe, header.layout);
    let table = Table::of_smooth_numbers(items, axes, &numbers, header.has_terms());
    let finite = |entry: usize| {
        let terms = table
            .terms()
            .is_none_or(|terms| terms.amplitude()[entry].is_finite() && terms.fresnel()[entry].is_finite());
        terms && table.matrices()[entry].iter().all(|x| x.is_finite())
    };
    match (0..numbers.len()).find(|entry| !finite(*entry)) {
        Some(entry) => Err(CompactError::Entry { entry }),
        None => Ok(table),
    }
}

/// The header of a table, without channels.
fn header_of(table: &Table) -> Result<Header, CompactError> {
    let axes = table.axes();
    let counts = axes.named().map(|(_, nodes)| u16::try_from(nodes.len()).unwrap_or(u16::MAX));
    let mut header = Header {
        brdf: table.brdf(),
        lobe: table.lobe(),
        layout: table.layout(),
        nodes: counts,
        polynomials: counts.map(|n| most_polynomials(usize::from(n)) as u8),
        ranges: [[0.0; 2]; 4],
        correction_steps: 1.0,
        steps: [None; CHANNELS],
        corrected: [false; CHANNELS],
    };
    header.check_entries()?;
    header.find_ranges(axes)?;
    Ok(header)
}

fn bases(header: &Header) -> Bases {
    Bases::new(header.nodes.map(usize::from), header.polynomials.map(usize::from))
}

/// Numbers as multiples of a step; a fraction of at least `1 - up` is rounded away from zero. `None` if a number is too
/// large.
fn rounded(numbers: &[f64], step: f64, up: f64) -> Option<Vec<i32>> {
    let most = f64::from(1_u32 << MOST_BITS);
    let multiple = |x: &f64| {
        let magnitude = (x.abs() / step + up).floor();
        (magnitude < most).then(|| magnitude.copysign(*x) as i32)
    };
    numbers.iter().map(multiple).collect()
}

#[cfg(any(test, feature = "testing"))]
pub mod planted;
#[cfg(test)]
mod tests;
