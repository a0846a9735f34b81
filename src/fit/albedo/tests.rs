//! Values against an independent integral, and errors after filtering.

use std::{f64::consts::PI, ops::ControlFlow};

use glam::DVec3;

use super::{
    ggx::ggx,
    glass::{dielectric, glass},
    *,
};
use crate::{
    FITTER_VERSION,
    brdf::{Brdf, Ggx},
    math::{Lattice, direction, exp, ln, recurrence4, sin_cos},
};

fn recipe(table: LutKind, texels: u32) -> LutRecipe {
    LutRecipe {
        fitter: FITTER_VERSION,
        table,
        brdf: table.brdfs()[0],
        form: table.has_forms().then_some(DfgForm::Karis),
        resolution: LutResolution::new(table, |_| texels),
        axes: (table != LutKind::AnisotropicDfg).then(LutAxes::default),
        precision: LutPrecision::F16,
    }
}

fn fitted(recipe: &LutRecipe) -> Lut {
    fit_lut(&LutPlan::new(recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// Adaptive Simpson.
fn simpson(f: &mut dyn FnMut(f64) -> [f64; 2], [a, b]: [f64; 2], tolerance: f64) -> [f64; 2] {
    type Values = [[f64; 2]; 3];
    fn part(
        f: &mut dyn FnMut(f64) -> [f64; 2],
        [a, b]: [f64; 2],
        [fa, fm, fb]: Values,
        tolerance: f64,
        depth: u32,
    ) -> [f64; 2] {
        let m = 0.5 * (a + b);
        let (fl, fr) = (f(0.5 * (a + m)), f(0.5 * (m + b)));
        let rule = |length: f64, x: f64, y: f64, z: f64| length / 6.0 * (x + 4.0 * y + z);
        let whole = [0, 1].map(|i| rule(b - a, fa[i], fm[i], fb[i]));
        let halves = [0, 1].map(|i| rule(m - a, fa[i], fl[i], fm[i]) + rule(b - m, fm[i], fr[i], fb[i]));
        if depth == 0 || (0..2).all(|i| (halves[i] - whole[i]).abs() < 15.0 * tolerance) {
            return [0, 1].map(|i| halves[i] + (halves[i] - whole[i]) / 15.0);
        }
        let left = part(f, [a, m], [fa, fl, fm], 0.5 * tolerance, depth - 1);
        let right = part(f, [m, b], [fm, fr, fb], 0.5 * tolerance, depth - 1);
        [0, 1].map(|i| left[i] + right[i])
    }
    // Several intervals, so no narrow peak is missed.
    let steps = 16;
    let mut sum = [0.0; 2];
    for i in 0..steps {
        let at = |i: usize| a + (b - a) * i as f64 / steps as f64;
        let ends = [at(i), at(i + 1)];
        let values = [f(ends[0]), f(0.5 * (ends[0] + ends[1])), f(ends[1])];
        let found = part(f, ends, values, tolerance / steps as f64, 24);
        (0..2).for_each(|i| sum[i] += found[i]);
    }
    sum
}

/// The integral of two factors over the visible normals, by nested adaptive Simpson over polar angle and azimuth of the
/// normal. `of` takes the normal.
fn independent(alpha: f64, azimuths: f64, of: impl Fn(DVec3) -> [f64; 2]) -> [f64; 2] {
    simpson(
        &mut |u| {
            // The variable is the logarithm of the slope.
            let slope = exp(u);
            let length = (1.0 + slope * slope).sqrt();
            let jacobian = slope * slope / (length * length * length);
            simpson(
                &mut |phi| {
                    let (y, x) = sin_cos(phi);
                    of(DVec3::new(slope * x, slope * y, 1.0) / length).map(|x| x * jacobian)
                },
                [0.0, azimuths],
                3e-9,
            )
        },
        [ln(1e-5 * alpha), ln(1e7)],
        1e-7,
    )
}

/// The view from a cosine, at azimuth zero.
fn view(cosine: f64) -> DVec3 {
    DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

#[test]
fn values_of_ggx_agree_with_an_independent_integral() {
    for [x, y] in Lattice::new(200, [0.21, 0.83]).points() {
        let (alpha, cosine) = (0.002_f64.powf(1.0 - x), 0.01 + 0.99 * y * y);
        let (surface, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, view(cosine));
        let expected = independent(alpha, PI, |wm| {
            let value = 2.0 * surface.eval_normal(wo, wm);
            [value, value * (1.0 - wo.dot(wm)).max(0.0).powi(5)]
        });
        let found = ggx(alpha, cosine);
        let error = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "alpha {alpha}, cosine {cosine}: {found:?}, not {expected:?}");
    }
    // At normal incidence and alpha 1 the integral has a closed form.
    assert!((ggx(1.0, 1.0)[0] - (1.0 - std::f64::consts::LN_2)).abs() < 1e-8);
}

#[test]
fn values_of_glass_agree_with_an_independent_integral() {
    for i in 0..200 {
        let [x, y, z, _] = recurrence4(i, [0.31, 0.77, 0.12, 0.5]);
        let (alpha, cosine) = (0.002_f64.powf(1.0 - x), 0.01 + 0.99 * y * y);
        // Also an index of one, at which nothing is reflected.
        let eta = if i % 20 == 0 { 1.0 } else { 1.0 + 2.0 * z * z };
        let (surface, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, view(cosine));
        let expected = independent(alpha, PI, |wm| {
            let incident = wo.dot(wm);
            if incident <= 0.0 {
                return [0.0; 2];
            }
            let visible = 2.0 * surface.distribution(wm) * incident / cosine;
            let refracted = (1.0 - (1.0 - incident * incident) / (eta * eta)).sqrt();
            let light = [2.0 * incident * wm - wo, (incident / eta - refracted) * wm - wo / eta];
            let masked = light.map(|wi| 1.0 / (1.0 + surface.smith_lambda(wo) + surface.smith_lambda(wi)));
            let reflected = dielectric(incident, eta);
            [
                if light[0].z > 0.0 { visible * reflected * masked[0] } else { 0.0 },
                visible * (1.0 - reflected) * masked[1],
            ]
        });
        let found = glass(eta, alpha, cosine);
        let error = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "index {eta}, alpha {alpha}, cosine {cosine}: {found:?}, not {expected:?}");
        assert!(found[0] >= 0.0 && found[0] + found[1] < 1.0, "index {eta}, alpha {alpha}, cosine {cosine}: {found:?}");
    }
    // At an index of one, all normals pass light straight through: `1 / (1 + Lambda)` of them are visible.
    let (wo, surface) = (view(0.1), Ggx { alpha_x: 0.4, alpha_y: 0.4 });
    let lambda = surface.smith_lambda(wo);
    assert!((glass(1.0, 0.4, 0.1)[1] - (1.0 + lambda) / (1.0 + 2.0 * lambda)).abs() < 1e-6);
    // A flat interface transmits all light that it does not reflect.
    let [reflected, transmitted] = glass(1.5, 1e-4, 1.0);
    assert!((reflected - 0.04).abs() < 1e-6 && (transmitted - 0.96).abs() < 1e-6, "{reflected} {transmitted}");
}

#[test]
fn values_of_anisotropic_ggx_agree_with_an_independent_integral() {
    let recipe = LutRecipe { form: Some(DfgForm::Filament), ..recipe(LutKind::AnisotropicDfg, 2) };
    for i in 0..200 {
        let [x, y, z, w] = recurrence4(i, [0.13, 0.41, 0.9, 0.62]);
        let (alpha_x, ratio) = (0.02_f64.powf(1.0 - x), 0.05_f64.powf(1.0 - y));
        let (theta, phi) = ((0.01 + 0.99 * z * z).acos(), 0.5 * PI * w);
        let (surface, wo) = (Ggx { alpha_x, alpha_y: alpha_x * ratio }, direction(theta, phi));
        let [albedo, bias] = independent(alpha_x * ratio, 2.0 * PI, |wm| {
            let value = surface.eval_normal(wo, wm);
            [value, value * (1.0 - wo.dot(wm)).max(0.0).powi(5)]
        });
        let found = recipe.truth(&[alpha_x, ratio, theta, phi]);
        let error = (found[0] - bias).abs().max((found[1] - albedo).abs());
        assert!(error < 1e-5, "{alpha_x} {ratio} {theta} {phi}: {found:?}, not {bias} {albedo}");
    }
    // An isotropic surface has the values of `dfg` from all azimuths.
    for [x, y] in Lattice::new(50, [0.7, 0.2]).points() {
        let [expected, ..] = [ggx(x, 0.3)].map(|[albedo, bias, _]| [bias, albedo]);
        let found = recipe.truth(&[x, 1.0, 0.3_f64.acos(), 0.5 * PI * y]);
        assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-6), "{x} {y}: {found:?}, not {expected:?}");
    }
}

#[test]
fn values_of_sheen_and_diffuse_agree_with_an_independent_integral() {
    for table in [LutKind::Sheen, LutKind::Diffuse] {
        for &brdf in table.brdfs() {
            let recipe = LutRecipe { brdf, ..recipe(table, 8) };
            for [x, y] in Lattice::new(12, [0.4, 0.7]).points() {
                let (alpha, cosine) = (0.05 + 0.95 * x, 0.02 + 0.98 * y);
                let surface = brdf.surface([alpha; 2]);
                let wo = direction(cosine.acos(), 0.0);
                let mut around = |theta: f64| {
                    simpson(
                        &mut |phi| [2.0 * theta.sin() * surface.eval_cos(wo, direction(theta, phi)), 0.0],
                        [0.0, PI],
                        1e-7,
                    )
                };
                let [expected, _] = simpson(&mut around, [0.0, 0.5 * PI], 1e-7);
                let [found, ..] = recipe.truth(&[alpha, cosine]);
                assert!((found - expected).abs() < 1e-5, "{brdf} {alpha} {cosine}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn filtered_errors_are_within_their_limits() {
    for (texels, mean, max) in [(16, 0.001, 0.012), (32, 0.0003, 0.004), (128, 0.0001, 0.002)] {
        let recipe = recipe(LutKind::Dfg, texels);
        let report = MeasuredLut::new(&recipe).report(&fitted(&recipe));
        let ratio = report.stored.mean / recipe.expectation().error;
        assert!((0.7..1.4).contains(&ratio), "{texels}: the expected error is wrong by {ratio}");
        assert!(report.stored.mean < mean && report.stored.max < max, "{texels}: {report:?}");
    }
}

#[test]
fn tables_of_more_axes_have_the_expected_error() {
    for (table, texels, places, mean, max) in
        [(LutKind::Transmission, 10, 13, 0.003, 0.12), (LutKind::AnisotropicDfg, 5, 4, 0.012, 0.12)]
    {
        let recipe = recipe(table, texels);
        // These values take long, so there are fewer texels and places than usual. The ends of the axes then count more.
        let report = MeasuredLut::at(&recipe, |axis| axis.even(places)).report(&fitted(&recipe));
        assert!(report.stored.mean < mean && report.stored.max < max, "{table}: {report:?}");
        assert!(report.stored.mean < report.sampled.mean, "{table}: {report:?}");
        let ratio = report.stored.mean / recipe.expectation().error;
        assert!((0.7..1.7).contains(&ratio), "{table}: the expected error is wrong by {ratio}");
    }
}

#[test]
fn a_white_furnace_with_the_albedo_table_returns_all_energy() {
    let recipe = recipe(LutKind::Albedo, 64);
    let plan = LutPlan::new(&recipe);
    let shard = |i| plan.fit_shard(i, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let values: Vec<f64> = (0..plan.shards()).flat_map(shard).collect();
    for precision in [LutPrecision::F32, LutPrecision::F16] {
        let recipe = LutRecipe { precision, ..recipe };
        let worst = furnace(&recipe, &LutPlan::new(&recipe).assemble(&values));
        assert!(worst < 0.001, "{precision}: {worst}");
    }
}

/// The largest change of energy of a white metal, with the compensation of Kulla and Conty as shaders compute it.
fn furnace(recipe: &LutRecipe, lut: &Lut) -> f64 {
    let average = lut.average.as_ref().expect("an albedo table has averages");
    let axes = recipe.grid(|_| vec![]);
    let [roughness, cosines] = axes.as_slice() else { panic!("two axes") };
    // The filter of one axis between two rows.
    let read = |row: usize, (below, next): (usize, f64)| {
        let at = |i: usize| f64::from(lut.texels[row * cosines.texels + i]);
        at(below) * (1.0 - next) + at(below + 1) * next
    };
    let mut worst = 0.0_f64;
    for [x, y] in Lattice::new(1500, [0.3, 0.1]).points() {
        // All roughnesses, and views from a cosine of .01.
        let (cosine, (row, down)) = (0.01 + 0.99 * y, roughness.filter(x));
        let mix = |above: f64, below: f64| above * (1.0 - down) + below * down;
        let albedo = |cosine: f64| {
            let place = cosines.filter(cosines.parameter(cosine));
            mix(read(row, place), read(row + 1, place))
        };
        let average = mix(f64::from(average[row]), f64::from(average[row + 1]));
        // Kulla and Conty add (1 - E(o)) (1 - E(i)) / (pi (1 - average)); its albedo is (1 - E(o)) times this factor.
        let steps = 400;
        let lights = (0..steps).map(|i| {
            // The variable is the root of the cosine.
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            4.0 * u * u * u * (1.0 - albedo(u * u)) / f64::from(steps)
        });
        let factor = lights.sum::<f64>() / (1.0 - average).max(1e-6);
        let [single, ..] = recipe.truth(&[roughness.value(x), cosine]);
        worst = worst.max((single + (1.0 - albedo(cosine)) * factor - 1.0).abs());
    }
    worst
}

#[test]
fn shards_in_bytes_give_the_same_table() {
    let recipe = recipe(LutKind::Albedo, 4);
    let plan = LutPlan::new(&recipe);
    let mut values = vec![];
    for shard in 0..plan.shards() {
        let found = plan.fit_shard(shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
        let bytes: Vec<u8> = found.iter().flat_map(|x| x.to_le_bytes()).collect();
        assert!(plan.shard_from_bytes(shard, &bytes[8..]).is_err());
        values.extend(plan.shard_from_bytes(shard, &bytes).expect("a shard"));
        assert!(plan.fit_shard(shard, &mut |_| ControlFlow::Break(())).is_none());
    }
    assert_eq!(plan.assemble(&values), fitted(&recipe));
}
