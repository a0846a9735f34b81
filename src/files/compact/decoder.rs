//! Reads the part after the header of a compact form: bits of a range coder, integers from these bits, and sums of
//! polynomials with these coefficients.
//!
//! This file needs no crate and no other file. Exports in Rust contain it unchanged.

/// The number of channels: the smooth numbers of an entry.
pub(crate) const CHANNELS: usize = 9;
/// The most polynomials of any axis.
pub(crate) const MOST_POLYNOMIALS: usize = 28;
/// The most entries of a table, so that a short file cannot allocate all memory.
pub(crate) const MOST_ENTRIES: usize = 1 << 20;

/// The coded bytes, and the parameters from the header.
pub(crate) struct Coded<'a> {
    pub(crate) nodes: [usize; 4],
    /// The number of polynomials along each axis.
    pub(crate) counts: [usize; 4],
    /// The step of each stored channel.
    pub(crate) steps: [Option<f32>; CHANNELS],
    pub(crate) corrected: [bool; CHANNELS],
    /// The unit of corrections, in steps of their channel.
    pub(crate) correction_steps: f32,
    pub(crate) bytes: &'a [u8],
}

impl Coded<'_> {
    /// The numbers of every entry, and the number of bytes after them; `None` if the bytes end too early. Domain: each
    /// axis has at least one polynomial and at most as many as nodes; there are at most [`MOST_ENTRIES`] entries.
    pub(crate) fn numbers(&self) -> Option<(Vec<[f64; CHANNELS]>, usize)> {
        let bases = Bases::new(self.nodes, self.counts);
        let (mut models, mut corrections) = (Models::new(), Models::new());
        let mut decoder = Decoder::new(self.bytes)?;
        let mut numbers = vec![[0.0; CHANNELS]; self.nodes.iter().product()];
        for channel in 0..CHANNELS {
            let Some(step) = self.steps[channel].map(f64::from) else { continue };
            let mut values = bases.values(multiples(&models.read(self.counts, &mut decoder)?, step));
            if self.corrected[channel] {
                let correction = corrections.read(self.nodes, &mut decoder)?;
                let step = step * f64::from(self.correction_steps);
                for (value, more) in values.iter_mut().zip(multiples(&correction, step)) {
                    *value += more;
                }
            }
            for (entry, value) in numbers.iter_mut().zip(values) {
                entry[channel] = value;
            }
        }
        Some((numbers, decoder.bytes.len()))
    }
}

pub(crate) fn multiples(rounded: &[i32], step: f64) -> Vec<f64> {
    rounded.iter().map(|k| f64::from(*k) * step).collect()
}

/// The bits of a probability.
const CHANCE_BITS: u32 = 11;
/// The adaption rate: a probability moves by 2^-4 of the distance to the bit.
const RATE: u32 = 4;
/// The width of the interval below which a byte is output.
pub(crate) const NARROW: u32 = 1 << 24;

/// The probability that the next bit is a 0, in units of 2^-11.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chance(u16);

impl Chance {
    pub(crate) const EVEN: Self = Self(1 << (CHANCE_BITS - 1));

    pub(crate) fn bound(self, range: u32) -> u32 {
        (range >> CHANCE_BITS) * u32::from(self.0)
    }

    pub(crate) fn saw(&mut self, bit: bool) {
        if bit {
            self.0 -= self.0 >> RATE;
        } else {
            self.0 += ((1 << CHANCE_BITS) - self.0) >> RATE;
        }
    }
}

/// Reads bits.
pub(crate) struct Decoder<'a> {
    code: u32,
    range: u32,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// The reader; `None` for too few bytes.
    pub(crate) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (first, bytes) = bytes.split_first_chunk::<4>()?;
        Some(Self { code: u32::from_be_bytes(*first), range: u32::MAX, bytes })
    }

    /// The next bit; `None` if the bytes end.
    pub(crate) fn read(&mut self, chance: &mut Chance) -> Option<bool> {
        let bound = chance.bound(self.range);
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        chance.saw(bit);
        while self.range < NARROW {
            let (next, rest) = self.bytes.split_first()?;
            self.code = self.code << 8 | u32::from(*next);
            self.range <<= 8;
            self.bytes = rest;
        }
        Some(bit)
    }
}

/// The largest size of a magnitude in bits.
pub(crate) const MOST_BITS: usize = 24;
/// The number of different neighbourhoods.
const NEIGHBOURHOODS: usize = 13;

/// The probabilities for one kind of array.
pub(crate) struct Models {
    /// Whether the magnitude has more bits, by neighbourhood and number of bits so far.
    pub(crate) lengths: [[Chance; MOST_BITS]; NEIGHBOURHOODS],
    /// The second highest bit, by number of bits.
    pub(crate) seconds: [Chance; MOST_BITS + 1],
    /// The lower bits.
    pub(crate) low: Chance,
    pub(crate) sign: Chance,
}

impl Models {
    pub(crate) fn new() -> Self {
        Self {
            lengths: [[Chance::EVEN; MOST_BITS]; NEIGHBOURHOODS],
            seconds: [Chance::EVEN; MOST_BITS + 1],
            low: Chance::EVEN,
            sign: Chance::EVEN,
        }
    }

    /// Reads an array with these lengths, the last axis fastest; `None` if the bytes end.
    pub(crate) fn read(&mut self, lengths: [usize; 4], from: &mut Decoder<'_>) -> Option<Vec<i32>> {
        let mut numbers = vec![0; lengths.iter().product()];
        for i in 0..numbers.len() {
            let longer = &mut self.lengths[neighbourhood(lengths, &numbers, i)];
            let mut bits = 0;
            while bits < MOST_BITS && from.read(&mut longer[bits])? {
                bits += 1;
            }
            if bits == 0 {
                continue;
            }
            let mut magnitude = 1;
            for place in (0..bits - 1).rev() {
                let chance = if place + 2 == bits { &mut self.seconds[bits] } else { &mut self.low };
                magnitude = 2 * magnitude + i32::from(from.read(chance)?);
            }
            numbers[i] = if from.read(&mut self.sign)? { -magnitude } else { magnitude };
        }
        Some(numbers)
    }
}

/// The neighbourhood of the element `i`.
pub(crate) fn neighbourhood([_, ratio, theta, phi]: [usize; 4], numbers: &[i32], i: usize) -> usize {
    let steps = [(i / (phi * theta * ratio), phi * theta * ratio), (i / (phi * theta) % ratio, phi * theta)];
    let steps = steps.into_iter().chain([(i / phi % theta, phi), (i % phi, 1)]);
    let mut sum = 0;
    for (place, step) in steps {
        for (back, weight) in [(1, 2), (2, 1)] {
            if place >= back {
                sum += weight * numbers[i - back * step].unsigned_abs();
            }
        }
    }
    ((u32::BITS - sum.leading_zeros()) as usize).min(NEIGHBOURHOODS - 1)
}

/// The polynomials of one axis.
pub(crate) struct Basis {
    nodes: usize,
    /// One row of `nodes` values for each polynomial.
    values: Vec<f64>,
}

impl Basis {
    /// The first `count` polynomials. Domain: `1 <= count <= nodes`.
    pub(crate) fn new(nodes: usize, count: usize) -> Self {
        let n = nodes as f64;
        let mut values = vec![1.0 / n.sqrt(); nodes];
        let mut previous_weight = 0.0;
        for k in 1..count {
            let square = (k * k) as f64;
            let weight = (square * (n * n - square) / (4.0 * (4.0 * square - 1.0))).sqrt();
            for i in 0..nodes {
                let t = i as f64 - 0.5 * (n - 1.0);
                let last = values[(k - 1) * nodes + i];
                let before = if k > 1 { values[(k - 2) * nodes + i] } else { 0.0 };
                values.push((t * last - previous_weight * before) / weight);
            }
            previous_weight = weight;
        }
        Self { nodes, values }
    }

    pub(crate) fn count(&self) -> usize {
        self.values.len() / self.nodes
    }

    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    /// The polynomial `k` at the node `i`.
    pub(crate) fn at(&self, k: usize, i: usize) -> f64 {
        self.values[k * self.nodes + i]
    }
}

/// The bases of the four axes.
pub(crate) struct Bases(pub(crate) [Basis; 4]);

impl Bases {
    /// Domain: as for [`Basis::new`].
    pub(crate) fn new(nodes: [usize; 4], counts: [usize; 4]) -> Self {
        Self(std::array::from_fn(|axis| Basis::new(nodes[axis], counts[axis])))
    }

    /// The values of a sum of polynomials at the nodes, from its coefficients.
    pub(crate) fn values(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        for axis in (0..4).rev() {
            let (basis, after) = (&self.0[axis], self.0[axis + 1..].iter().map(Basis::nodes).product());
            coefficients = along(&coefficients, basis.count(), basis.nodes(), after, |i, k| basis.at(k, i));
        }
        coefficients
    }
}

/// Multiplies an array along one axis by a matrix of `to` rows. The axis has `from` elements with `after` numbers each.
pub(crate) fn along(
    array: &[f64],
    from: usize,
    to: usize,
    after: usize,
    matrix: impl Fn(usize, usize) -> f64,
) -> Vec<f64> {
    let before = array.len() / (from * after);
    let mut product = vec![0.0; before * to * after];
    for (block, sums) in array.chunks_exact(from * after).zip(product.chunks_exact_mut(to * after)) {
        for (row, sums) in sums.chunks_exact_mut(after).enumerate() {
            for (column, numbers) in block.chunks_exact(after).enumerate() {
                let factor = matrix(row, column);
                for (sum, number) in sums.iter_mut().zip(numbers) {
                    *sum += factor * number;
                }
            }
        }
    }
    product
}
