//! Adaptive quadrature over an interval.

/// Nodes and weights of the Kronrod rule of 15 points on [-1, 1], for zero and the positive nodes in ascending order.
const KRONROD: [(f64, f64); 8] = [
    (0.0, 0.209_482_141_084_727_83),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_56),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224),
];
/// Weights of Gauss's rule of 7 points. Its nodes are every other node of Kronrod's rule.
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_64, 0.129_484_966_168_869_7];

/// The sum of two vectors.
pub(super) fn plus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// The integral of `f` over an interval by the rules of Gauss and Kronrod. The interval is halved until both agree.
pub(crate) fn integral<const N: usize>(
    f: &impl Fn(f64) -> [f64; N],
    [from, to]: [f64; 2],
    tolerance: f64,
    halvings: u32,
) -> [f64; N] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut fine, mut coarse) = ([0.0; N], [0.0; N]);
    for (i, (x, weight)) in KRONROD.into_iter().enumerate() {
        let right = f(middle + half * x);
        let both = if i == 0 { right } else { plus(right, f(middle - half * x)) };
        fine = plus(fine, both.map(|y| y * weight * half));
        if i % 2 == 0 {
            coarse = plus(coarse, both.map(|y| y * GAUSS[i / 2] * half));
        }
    }
    if halvings == 0 || fine.iter().zip(coarse).all(|(fine, coarse)| (fine - coarse).abs() < tolerance) {
        return fine;
    }
    let part = |ends| integral(f, ends, 0.6 * tolerance, halvings - 1);
    plus(part([from, middle]), part([middle, to]))
}
