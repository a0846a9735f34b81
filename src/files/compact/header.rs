//! The uncompressed header of a compact file.
//!
//! | bytes | |
//! |---|---|
//! | 8 | `LTCcomp1`; the last byte is the version |
//! | for each of BRDF, lobe model, layout: 1 + n | the length of the name, the name in ASCII |
//! | for each axis: 2 + 1 + 8 + 8 | number of nodes, u16; polynomials; ends of the range, f64 |
//! | 2 | stored channels, u16, channel 0 is the lowest bit |
//! | 2 | channels with corrections, u16 |
//! | 4 | the unit of corrections, in steps of their channel, f32 |
//! | for each stored channel: 4 | the step of its coefficients, f32 |
//!
//! Numbers are little-endian. The bytes of the range coder follow to the end of the file.

use super::{
    decoder::{CHANNELS, Coded, MOST_ENTRIES, MOST_POLYNOMIALS},
    error::CompactError,
};
use ltcforge_fit::{BrdfKind, Layout, LobeModel, PerAxis};

/// The first bytes of a compact file. The last of these bytes is the version.
pub const COMPACT_MAGIC: &[u8; 8] = b"LTCcomp1";
/// The layouts with a compact form.
pub const LAYOUTS: [Layout; 3] = [Layout::Reflected, Layout::Kt2022, Layout::Ltc2017];
/// The channels of amplitude and Fresnel term.
pub(super) const TERMS: [usize; 2] = [7, 8];
/// Maximum number of nodes on an axis, as in recipes.
const MOST_NODES: u16 = 16_384;

/// The contents of the header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub(super) brdf: BrdfKind,
    pub(super) lobe: LobeModel,
    pub(super) layout: Layout,
    pub(super) nodes: [u16; 4],
    pub(super) polynomials: [u8; 4],
    pub(super) ranges: [[f64; 2]; 4],
    /// The step of each stored channel.
    pub(super) steps: [Option<f32>; CHANNELS],
    pub(super) corrected: [bool; CHANNELS],
    /// The unit of corrections, in steps of their channel.
    pub(super) correction_steps: f32,
}

impl Header {
    /// The nodes of the layout over the ranges, in ascending order.
    pub(super) fn axes(&self) -> Result<PerAxis<Vec<f64>>, CompactError> {
        let (ranges, axes) = self.divided();
        let only = self.layout.only_ranges().is_none_or(|only| only == ranges);
        for (axis, (name, nodes)) in axes.named().into_iter().enumerate() {
            let [low, high] = self.ranges[axis];
            // A layout may raise the first node to a floor.
            let ends = nodes.first().is_some_and(|first| *first >= low) && nodes.last() == Some(&high);
            if !(only && ends && nodes.is_sorted_by(|one, next| one < next)) {
                return Err(self.other_nodes(axis, name));
            }
        }
        Ok(axes)
    }

    /// The ranges, and the nodes into which the layout divides them.
    fn divided(&self) -> (PerAxis<[f64; 2]>, PerAxis<Vec<f64>>) {
        let ([alpha, ratio, theta, phi], nodes) = (self.ranges, self.nodes.map(u32::from));
        let resolution = PerAxis { alpha: nodes[0], ratio: nodes[1], theta: nodes[2], phi: nodes[3] };
        let ranges = PerAxis { alpha, ratio, theta, phi };
        let axes = self.layout.nodes(&ranges, &resolution);
        (ranges, axes)
    }

    /// Finds the ranges of these nodes. If a floor raised the first node, the range began at 0.
    pub(super) fn find_ranges(&mut self, axes: &PerAxis<Vec<f64>>) -> Result<(), CompactError> {
        for (axis, (name, nodes)) in axes.named().into_iter().enumerate() {
            let first = nodes.first().copied().unwrap_or_default();
            let high = nodes.last().copied().unwrap_or_default();
            let found = [first, 0.0].into_iter().any(|low| {
                self.ranges[axis] = [if nodes.len() > 1 { low } else { first }, high];
                self.divided().1.named()[axis].1 == nodes
            });
            if !found {
                self.ranges[axis] = [first, high];
                return Err(self.other_nodes(axis, name));
            }
        }
        self.axes().map(|_| ())
    }

    /// The error for nodes that the layout does not have.
    pub(super) fn other_nodes(&self, axis: usize, name: &'static str) -> CompactError {
        let [low, high] = self.ranges[axis].map(|end| end.to_string());
        CompactError::Nodes { axis: name, layout: self.layout.to_string(), low, high }
    }

    pub(super) fn has_terms(&self) -> bool {
        TERMS.iter().any(|term| self.steps[*term].is_some())
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes = COMPACT_MAGIC.to_vec();
        for name in [self.brdf.name(), self.lobe.name(), self.layout.name()] {
            // Names in the lists are short.
            bytes.push(name.len() as u8);
            bytes.extend(name.bytes());
        }
        for axis in 0..4 {
            bytes.extend(self.nodes[axis].to_le_bytes());
            bytes.push(self.polynomials[axis]);
            bytes.extend(self.ranges[axis].iter().flat_map(|end| end.to_le_bytes()));
        }
        let mask = |chosen: [bool; CHANNELS]| (0..).zip(chosen).fold(0_u16, |mask, (i, on)| mask | u16::from(on) << i);
        bytes.extend(mask(self.steps.map(|step| step.is_some())).to_le_bytes());
        bytes.extend(mask(self.corrected).to_le_bytes());
        bytes.extend(self.correction_steps.to_le_bytes());
        bytes.extend(self.steps.iter().flatten().flat_map(|step| step.to_le_bytes()));
        bytes
    }

    /// Reads the header. Also returns the bytes after it.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, &[u8]), CompactError> {
        let mut reader = Reader(bytes);
        if reader.take::<8>().ok().as_ref() != Some(COMPACT_MAGIC) {
            return Err(CompactError::Magic);
        }
        let brdf = reader.named("brdf", formula, &BrdfKind::formulas().collect::<Vec<_>>())?;
        let lobe = reader.named("lobe", LobeModel::from_name, LobeModel::ALL)?;
        let layout =
            reader.named("layout", |name| Layout::from_name(name).filter(|found| LAYOUTS.contains(found)), &LAYOUTS)?;
        let (mut nodes, mut polynomials, mut ranges) = ([0; 4], [0; 4], [[0.0; 2]; 4]);
        for (axis, name) in ["alpha", "ratio", "theta", "phi"].into_iter().enumerate() {
            nodes[axis] = u16::from_le_bytes(reader.take()?);
            [polynomials[axis]] = reader.take()?;
            ranges[axis] = [f64::from_le_bytes(reader.take()?), f64::from_le_bytes(reader.take()?)];
            let most = nodes[axis].min(MOST_POLYNOMIALS as u16);
            if !(1..=MOST_NODES).contains(&nodes[axis]) {
                return Err(CompactError::field(format!("nodes of {name}"), &nodes[axis], "1 to 16384"));
            }
            if !(1..=most).contains(&u16::from(polynomials[axis])) {
                let (field, allowed) = (format!("polynomials of {name}"), format!("1 to {most}"));
                return Err(CompactError::field(field, &polynomials[axis], &allowed));
            }
            let ([low, high], highest) = (ranges[axis], if axis < 2 { 1.0 } else { std::f64::consts::FRAC_PI_2 });
            let ordered = if nodes[axis] == 1 { low == high } else { low < high };
            if !(ordered && (0.0..=highest).contains(&low) && (0.0..=highest).contains(&high)) {
                let found = format!("{low} to {high}");
                return Err(CompactError::field(
                    format!("range of {name}"),
                    &found,
                    &format!("ascending, within 0 to {highest}"),
                ));
            }
        }
        let (stored, corrected) = (u16::from_le_bytes(reader.take()?), u16::from_le_bytes(reader.take()?));
        for (field, mask, all) in
            [("channels", stored, (1_u16 << CHANNELS) - 1), ("corrected channels", corrected, stored)]
        {
            if mask & !all != 0 {
                return Err(CompactError::field(field.to_owned(), &format!("{mask:#b}"), &format!("bits of {all:#b}")));
            }
        }
        let correction_steps = f32::from_le_bytes(reader.take()?);
        if !(1e-3..=64.0).contains(&correction_steps) {
            return Err(CompactError::field("steps of corrections".to_owned(), &correction_steps, "0.001 to 64"));
        }
        let mut steps = [None; CHANNELS];
        for (channel, step) in steps.iter_mut().enumerate().filter(|(channel, _)| stored >> channel & 1 == 1) {
            let value = f32::from_le_bytes(reader.take()?);
            if !(1e-9..=1.0).contains(&value) {
                return Err(CompactError::field(format!("step of channel {channel}"), &value, "1e-9 to 1"));
            }
            *step = Some(value);
        }
        let corrected = std::array::from_fn(|channel| corrected >> channel & 1 == 1);
        let header = Self { brdf, lobe, layout, nodes, polynomials, ranges, steps, corrected, correction_steps };
        header.check_entries()?;
        Ok((header, reader.0))
    }

    /// The parameters of the decoder for the bytes after the header.
    pub(super) fn coded<'a>(&self, bytes: &'a [u8]) -> Coded<'a> {
        Coded {
            nodes: self.nodes.map(usize::from),
            counts: self.polynomials.map(usize::from),
            steps: self.steps,
            corrected: self.corrected,
            correction_steps: self.correction_steps,
            bytes,
        }
    }

    /// Rejects tables with too many entries.
    pub(super) fn check_entries(&self) -> Result<(), CompactError> {
        let entries = self.nodes.iter().try_fold(1_usize, |product, n| product.checked_mul(usize::from(*n)));
        match entries {
            Some(1..=MOST_ENTRIES) => Ok(()),
            _ => Err(CompactError::field(
                "entries".to_owned(),
                &self.nodes.map(|n| n.to_string()).join(" x "),
                &format!("at most {MOST_ENTRIES} in all"),
            )),
        }
    }
}

/// Finds a scattering model that needs no file. The form cannot store a file's digest.
fn formula(name: &str) -> Option<BrdfKind> {
    BrdfKind::formulas().find(|kind| kind.name() == name)
}

/// Takes bytes from the front of a slice.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], CompactError> {
        let (taken, rest) = self.0.split_first_chunk::<N>().ok_or(CompactError::Short)?;
        self.0 = rest;
        Ok(*taken)
    }

    /// Reads a name, and returns the list item with this name.
    fn named<T: std::fmt::Display>(
        &mut self,
        field: &str,
        from_name: impl Fn(&str) -> Option<T>,
        all: &[T],
    ) -> Result<T, CompactError> {
        let [length] = self.take()?;
        let (name, rest) = self.0.split_at_checked(usize::from(length)).ok_or(CompactError::Short)?;
        self.0 = rest;
        let name = String::from_utf8_lossy(name);
        from_name(&name).ok_or_else(|| {
            let all: Vec<String> = all.iter().map(ToString::to_string).collect();
            CompactError::field(field.to_owned(), &format!("{name:?}"), &all.join(", "))
        })
    }
}
