//! Shards: fixed ranges of entries. A shard is the unit in which workers lease and resume a fit.

use std::ops::{ControlFlow, Range};

use glam::{DMat3, DVec3};

use super::{
    axes::PerAxis,
    cost::fit_seconds,
    entry::{FittedEntry, Fitter},
    layout::within_limits,
    math::{from_row_major, row_major, turned_about_z},
    recipe::Recipe,
    solver::Start,
    stop_check::StopCheck,
};

/// The largest predicted time of a shard. With short shards, a waiting job begins soon, and little work is lost if a
/// worker fails.
const SHARD_SECONDS: f64 = 1.0;
/// The smallest number of entries of a shard, for tables that take a few seconds. With fewer entries, leasing would
/// take longer than fitting.
const FEW_ENTRIES: u64 = 64;
/// The number of shards above which shards grow towards [`SHARD_SECONDS`].
const MANY_SHARDS: u64 = 256;

/// A recipe's nodes and their division into shards. Both depend on the recipe alone.
///
/// Entries with the same alpha, ratio and theta form a view. They share work if symmetry makes them equal. Usually a
/// row is one view. If each view starts from the previous view, a row is all views with the same alpha and ratio. A
/// shard is a whole number of rows, so its entries do not depend on other shards.
#[derive(Debug, Clone)]
pub struct Plan {
    recipe: Recipe,
    nodes: PerAxis<Vec<f64>>,
    entries_per_shard: u64,
}

impl Plan {
    /// The plan of a recipe that `ltcforge_files::recipe_document` has checked.
    #[must_use]
    pub fn new(recipe: &Recipe) -> Self {
        let mut plan = Self { recipe: recipe.clone(), nodes: recipe.nodes(), entries_per_shard: 0 };
        plan.entries_per_shard = plan.shard_length();
        plan
    }

    /// The recipe of the plan.
    #[must_use]
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Entries of the table.
    #[must_use]
    pub fn entries(&self) -> u64 {
        self.recipe.entries()
    }

    /// The number of shards.
    #[must_use]
    pub fn shards(&self) -> u32 {
        u32::try_from(self.entries().div_ceil(self.entries_per_shard)).unwrap_or(u32::MAX)
    }

    /// The entries of `shard`, as indices in storage order; empty after the last shard.
    #[must_use]
    pub fn shard_entries(&self, shard: u32) -> Range<u64> {
        let start = u64::from(shard) * self.entries_per_shard;
        start.min(self.entries())..(start + self.entries_per_shard).min(self.entries())
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.entries() / self.row_length()
    }

    /// The number of entries of a shard: whole rows, at most a second of predicted work unless one row takes longer.
    fn shard_length(&self) -> u64 {
        let row = self.row_length();
        let of_a_second = SHARD_SECONDS * self.entries() as f64 / fit_seconds(&self.recipe);
        let wanted = FEW_ENTRIES.max(self.entries() / MANY_SHARDS).div_ceil(row);
        wanted.min(of_a_second as u64 / row).max(1) * row
    }

    fn row_length(&self) -> u64 {
        let views = if self.is_warm() { self.recipe.resolution.theta.max(1) } else { 1 };
        u64::from(views) * self.view_length()
    }

    fn view_length(&self) -> u64 {
        u64::from(self.recipe.resolution.phi.max(1))
    }

    /// True if each view starts from the previous view.
    fn is_warm(&self) -> bool {
        self.recipe.fit.simplex.is_some_and(|simplex| simplex.start == Start::Warm)
    }

    /// Ascending nodes of each axis.
    #[must_use]
    pub fn nodes(&self) -> &PerAxis<Vec<f64>> {
        &self.nodes
    }

    /// The configuration of the entry at `index` in storage order: its node, clamped to the limits of the fit. Domain:
    /// `index < entries()`.
    #[must_use]
    pub fn place(&self, index: u64) -> PerAxis<f64> {
        within_limits(self.recipe.layout.node(&self.nodes, index as usize))
    }
}

/// Fits the entries of `shard` in storage order.
///
/// `on_progress` receives the number of the shard's finished entries after every entry, and at intervals within a long
/// entry. It can stop the fit. The result is then `None`, and all entries of the shard are discarded.
pub fn fit_shard(
    plan: &Plan,
    shard: u32,
    on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Option<Vec<FittedEntry>> {
    let range = plan.shard_entries(shard);
    let rows = range.start / plan.row_length()..range.end / plan.row_length();
    fit_rows(plan, rows, &mut Fitter::new(&plan.recipe.fit).of(plan.recipe.lobe), on_progress)
}

/// Fits the entries of some rows in storage order. Unlike [`fit_shard`], it is for callers that do not lease shards and
/// want all threads to end at about the same time. `fitter` must have the plan's settings and lobe model.
pub fn fit_rows(
    plan: &Plan,
    rows: Range<u64>,
    fitter: &mut Fitter,
    on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Option<Vec<FittedEntry>> {
    let mut entries = Vec::with_capacity(((rows.end - rows.start) * plan.row_length()) as usize);
    for row in rows {
        fit_row(plan, row, fitter, &mut entries, on_progress)?;
    }
    Some(entries)
}

/// Fits the entries of one row, view by view.
fn fit_row(
    plan: &Plan,
    row: u64,
    fitter: &mut Fitter,
    entries: &mut Vec<FittedEntry>,
    on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Option<()> {
    let first = row * plan.row_length();
    let mut near = None;
    if plan.is_warm() {
        let done = entries.len() as u64;
        near = Some(from_above(plan, plan.place(first).alpha, fitter, &mut StopCheck::new(&mut || on_progress(done)))?);
    }
    for view in (first..first + plan.row_length()).step_by(plan.view_length() as usize) {
        fit_view(plan, view, fitter, &mut near, entries, on_progress)?;
    }
    Some(())
}

/// The start matrix for the first view of a row with warm starts, in the frame of its lobe. It is the matrix of the
/// lobe seen from above. This lobe is fitted at the plan's largest roughness, then at half of it, and so on down to
/// `alpha`; each fit starts from the previous fit.
fn from_above(plan: &Plan, alpha: f64, fitter: &mut Fitter, stop_check: &mut StopCheck) -> Option<DMat3> {
    let mut rough = plan.place(plan.entries() - 1).alpha;
    let mut near = None;
    loop {
        let place = PerAxis { alpha: rough, ratio: 1.0, theta: 0.0, phi: 0.0 };
        let matrix = fitter.next_to(&*plan.recipe.brdf.lobe_surface_at(&place), DVec3::Z, near, stop_check)?;
        if rough <= alpha {
            return Some(matrix);
        }
        near = Some(matrix);
        rough = (0.5 * rough).max(alpha);
    }
}

/// Fits the entries of the view whose first entry is `first`. It starts from `near`, if given, and sets `near` to the
/// start of the next view. Equal lobes are fitted once: seen from above, the lobe is the same for every phi, and on an
/// isotropic surface the lobe turns with phi.
fn fit_view(
    plan: &Plan,
    first: u64,
    fitter: &mut Fitter,
    near: &mut Option<DMat3>,
    entries: &mut Vec<FittedEntry>,
    on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Option<()> {
    let place = plan.place(first);
    let start = *near;
    let (from_above, isotropic) = (place.theta == 0.0, place.ratio == 1.0);
    let mut fit = |phi: f64, index: u64, done: u64, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>| {
        let place = PerAxis { phi, ..place };
        let wo = place.view();
        let mut go_on = || on_progress(done);
        let stop_check = &mut StopCheck::new(&mut go_on);
        let surface = plan.recipe.brdf.lobe_surface_at(&place);
        let (mut entry, next) = fitter.fit_near(&*surface, wo, index, start, stop_check)?;
        if let Some(surface) = plan.recipe.brdf.second_surface_at(&place) {
            let near = start.map(|_| next);
            entry.second = Some(fitter.matrix_near(&*surface, wo, index, near, stop_check)?);
        }
        Some((entry, next))
    };
    let done = entries.len() as u64;
    let shared = if from_above || isotropic { Some(fit(0.0, first, done, on_progress)?) } else { None };
    if start.is_some() {
        *near = shared.map(|(_, matrix)| matrix);
    }
    let shared = shared.map(|(entry, _)| if from_above && isotropic { round(&entry) } else { entry });
    for (index, phi) in (first..).zip(&plan.nodes.phi) {
        entries.push(match shared {
            Some(entry) if from_above => entry,
            Some(entry) => turned(&entry, *phi),
            None => fit(*phi, index, done + (index - first), on_progress)?.0,
        });
        if on_progress(entries.len() as u64).is_break() {
            return None;
        }
    }
    Some(())
}

/// The entry of a round lobe, without the asymmetry of its samples. Its x and y are made equal, because a lookup can
/// swap x and y.
fn round(entry: &FittedEntry) -> FittedEntry {
    let round = |[xx, _, _, _, yy, _, _, _, zz]: [f64; 9]| {
        let radius = 0.5 * (xx + yy);
        [radius, 0.0, 0.0, 0.0, radius, 0.0, 0.0, 0.0, zz]
    };
    FittedEntry { matrix: round(entry.matrix), second: entry.second.map(round), ..*entry }
}

/// The entry of an isotropic lobe, turned with the view.
fn turned(entry: &FittedEntry, phi: f64) -> FittedEntry {
    let turn = |matrix: [f64; 9]| row_major(&turned_about_z(from_row_major(&matrix), phi));
    FittedEntry { matrix: turn(entry.matrix), second: entry.second.map(turn), ..*entry }
}

/// How many numbers an entry has in a shard's bytes: the matrix, amplitude, Fresnel term and error.
const NUMBERS: usize = 12;
/// How many numbers follow if the entry has a second matrix.
const SECOND: usize = 9;

/// The number of bytes does not match the entries of a shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the result of a shard has {actual} bytes; expected {expected}")]
pub struct ShardBytesError {
    /// The number of bytes for the shard's entries.
    pub expected: usize,
    /// The actual number of bytes.
    pub actual: usize,
}

/// Encodes a finished shard: 12 little-endian f64 per entry (matrix, amplitude, Fresnel term, error), and 9 more if the
/// entry has a second matrix.
#[must_use]
pub fn shard_to_bytes(entries: &[FittedEntry]) -> Vec<u8> {
    let numbers = |e: &FittedEntry| {
        e.matrix.into_iter().chain([e.amplitude, e.fresnel, e.error]).chain(e.second.into_iter().flatten())
    };
    entries.iter().flat_map(numbers).flat_map(f64::to_le_bytes).collect()
}

/// Decodes the entries of a plan's shard, the inverse of [`shard_to_bytes`].
///
/// # Errors
/// If the number of bytes does not match the shard's entries.
pub fn shard_from_bytes(plan: &Plan, shard: u32, bytes: &[u8]) -> Result<Vec<FittedEntry>, ShardBytesError> {
    let range = plan.shard_entries(shard);
    let has_second = plan.recipe.brdf.fresnel().second().is_some();
    let each = if has_second { NUMBERS + SECOND } else { NUMBERS };
    let expected = (range.end - range.start) as usize * each * size_of::<f64>();
    if bytes.len() != expected {
        return Err(ShardBytesError { expected, actual: bytes.len() });
    }
    let (words, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
    let matrix = |numbers: &[f64]| std::array::from_fn(|i| numbers[i]);
    let entry = |numbers: &[f64]| FittedEntry {
        matrix: matrix(numbers),
        second: has_second.then(|| matrix(&numbers[NUMBERS..])),
        amplitude: numbers[9],
        fresnel: numbers[10],
        error: numbers[11],
    };
    Ok(numbers.chunks_exact(each).map(entry).collect())
}

#[cfg(test)]
mod tests;
