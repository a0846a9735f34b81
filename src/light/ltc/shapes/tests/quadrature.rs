//! Integrals over ellipses and lines by quadrature.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};

use ltcforge_fit::Ltc;

/// The positive nodes and their weights of Gauss's rule of order 16 on [-1, 1].
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

/// Gauss's rule, recursively on halves until both agree.
fn gauss(low: f64, high: f64, depth: u32, f: &impl Fn(f64) -> f64) -> f64 {
    let over = |low: f64, high: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        GAUSS.iter().map(|(x, w)| w * half * (f(middle - half * x) + f(middle + half * x))).sum::<f64>()
    };
    let middle = 0.5 * (low + high);
    let halves = over(low, middle) + over(middle, high);
    if depth == 0 || (halves - over(low, high)).abs() < 1e-11 {
        return halves;
    }
    gauss(low, middle, depth - 1, f) + gauss(middle, high, depth - 1, f)
}

/// The clamped cosine over an ellipse in cosine space. For each azimuth, the directions on the ellipse form an interval
/// whose integral is known. The method uses the ellipse's plane and equation, without a border or eigenvalues.
pub(super) fn by_quadrature(m: DMat3, centre: DVec3, [x, y]: [DVec3; 2]) -> f64 {
    let inverse = m.inverse();
    let to_ellipse = DMat3::from_cols(inverse * x, inverse * y, inverse * centre).inverse();
    // Directions d with (p, q, r) = to_ellipse d, r > 0, p^2 + q^2 <= r^2. For d = (s cos, s sin, 1) this is a
    // quadratic in s.
    let form = |u: DVec3, v: DVec3| {
        let (u, v) = (to_ellipse * u, to_ellipse * v);
        u.x * v.x + u.y * v.y - u.z * v.z
    };
    let up = DVec3::Z;
    let flat = |azimuth: f64| DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let up_to = |s: f64| if s.is_finite() { s * s / (1.0 + s * s) } else { 1.0 };
    let at = |azimuth: f64| {
        let d = flat(azimuth);
        let (a, b, c) = (form(d, d), form(d, up), form(up, up));
        let root = (b * b - a * c).max(0.0).sqrt();
        // The two roots of a s^2 + 2 b s + c, limited to the side of the ellipse.
        let big = -b - root.copysign(b);
        let mut ends: Vec<f64> = [big / a, c / big].into_iter().filter(|s| s.is_finite() && *s > 0.0).collect();
        ends.extend([0.0, f64::INFINITY]);
        ends.sort_by(f64::total_cmp);
        let inside = |s: f64| {
            let p = to_ellipse * (d * s + up);
            p.z > 0.0 && p.x * p.x + p.y * p.y <= p.z * p.z
        };
        let middle = |low: f64, high: f64| if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low + 1.0 };
        let intervals = ends.windows(2).filter(|pair| pair[1] > pair[0] && inside(middle(pair[0], pair[1])));
        intervals.map(|pair| up_to(pair[1]) - up_to(pair[0])).sum::<f64>()
    };
    // Azimuths at which the interval begins, ends or reaches the horizon. They come from the planes through up that
    // touch the cone, and from the crossings of the horizon.
    let matrix = DMat3::from_cols_array_2d(
        &[DVec3::X, DVec3::Y, DVec3::Z].map(|u| [DVec3::X, DVec3::Y, DVec3::Z].map(|v| form(u, v))),
    );
    let (xx, xy, yy) = (matrix.x_axis.x, matrix.x_axis.y, matrix.y_axis.y);
    let (xz, yz, zz) = (matrix.x_axis.z, matrix.y_axis.z, matrix.z_axis.z);
    let mut cuts = roots(xx, xy, yy);
    cuts.extend(roots(xz * xz - xx * zz, xz * yz - xy * zz, yz * yz - yy * zz));
    cuts.sort_by(f64::total_cmp);
    if let [first, ..] = cuts[..] {
        cuts.push(first + TAU);
    } else {
        cuts = vec![0.0, TAU];
    }
    // A sine substitution makes the square roots at the ends smooth.
    let between = |a: f64, b: f64| {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        gauss(-FRAC_PI_2, FRAC_PI_2, 40, &|u: f64| half * u.cos() * at(middle + half * u.sin()))
    };
    cuts.windows(2).map(|pair| between(pair[0], pair[1])).sum::<f64>() / TAU
}

/// The azimuths in a turn at which `xx cos^2 + 2 xy cos sin + yy sin^2` is zero.
fn roots(xx: f64, xy: f64, yy: f64) -> Vec<f64> {
    let discriminant = xy * xy - xx * yy;
    if discriminant <= 0.0 {
        return Vec::new();
    }
    let big = -xy - discriminant.sqrt().copysign(xy);
    // tan = big / yy and tan = xx / big.
    let angles = [big.atan2(yy), xx.atan2(big)];
    angles.into_iter().flat_map(|a| [a.rem_euclid(TAU), (a + PI).rem_euclid(TAU)]).collect()
}

/// The width times the integral of the density divided by the distance, over the angle along the line.
pub(super) fn line_by_quadrature(m: DMat3, [a, b]: [DVec3; 2], width: f64) -> f64 {
    let ltc = Ltc::new(m).expect("regular");
    let at = |s: f64| {
        let p = a + (b - a) * s;
        let distance = p.length();
        ltc.pdf(p / distance) * a.cross(b).length() / distance.powi(3)
    };
    let (from, to) = ((ltc.inverse() * a).z, (ltc.inverse() * b).z);
    let crossing = if from * to < 0.0 { from / (from - to) } else { 0.5 };
    width * (gauss(0.0, crossing, 40, &at) + gauss(crossing, 1.0, 40, &at))
}
