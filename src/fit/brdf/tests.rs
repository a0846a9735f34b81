//! Tests of properties that all scattering models share.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Brdf, BrdfKind, BrdfModel, BrdfSample, MOST_ALBEDO, planted_anisotropic, planted_tabulated};
use crate::lobe::ltc::Ltc;
use crate::math::{Lattice, atan2, cosine_hemisphere, direction, sin_cos};

/// Lobes from broad to narrow, seen from above and at grazing angles: `(alpha_x, alpha_y, theta, phi)`.
const CONFIGURATIONS: [(f64, f64, f64, f64); 6] = [
    (1.0, 1.0, 0.0, 0.0),
    (0.5, 0.5, 0.8, 0.3),
    (0.6, 0.2, 1.1, 0.9),
    (0.3, 0.9, 1.4, 2.5),
    (0.25, 0.15, 0.4, 4.0),
    (0.1, 0.1, 1.2, -1.0),
];

/// Every model, including an isotropic and an anisotropic file.
fn models() -> impl Iterator<Item = BrdfModel> {
    BrdfKind::formulas().map(BrdfModel::from).chain([planted_tabulated(), planted_anisotropic()])
}

/// Every model at every configuration, with its name for messages.
fn all() -> impl Iterator<Item = (BrdfModel, Box<dyn Brdf>, DVec3, String)> {
    models().flat_map(|model| {
        CONFIGURATIONS.map(|(alpha_x, alpha_y, theta, phi)| {
            let isotropy = if model.is_isotropic() { "isotropic" } else { "anisotropic" };
            let name = format!("{isotropy} {model} {alpha_x} {alpha_y} from {theta} {phi}");
            (model.clone(), model.surface([alpha_x, alpha_y]), direction(theta, phi), name)
        })
    })
}

#[test]
fn every_item_of_the_list_is_tested() {
    let mut tested: Vec<BrdfKind> = models().map(|model| model.kind()).collect();
    tested.dedup();
    assert_eq!(tested, BrdfKind::ALL);
}

/// Directions of the midpoint rule in height and azimuth, `n` by `2 n`, over the sphere. Each has `2 pi / n^2`
/// steradians.
fn sphere(n: usize) -> impl Iterator<Item = DVec3> {
    let azimuths: Vec<(f64, f64)> = (0..2 * n).map(|j| sin_cos(PI * (j as f64 + 0.5) / n as f64)).collect();
    (0..n).flat_map(move |i| {
        let z = 2.0 * (i as f64 + 0.5) / n as f64 - 1.0;
        let radius = (1.0 - z * z).sqrt();
        azimuths.clone().into_iter().map(move |(sin, cos)| DVec3::new(radius * cos, radius * sin, z))
    })
}

/// The integral over the directions of [`sphere`].
fn integrate(n: usize, f: impl FnMut(DVec3) -> f64) -> f64 {
    sphere(n).map(f).sum::<f64>() * TAU / (n * n) as f64
}

/// `E(wo)`, the albedo under uniform light. The integration variable is the square root of the height, which resolves
/// the singularity of diffuse models at the horizon.
fn albedo(brdf: &dyn Brdf, wo: DVec3) -> f64 {
    const N: usize = 400;
    let part = |k: usize| (k as f64 + 0.5) / N as f64;
    let ring = |i: usize| {
        let (z, weight) = (part(i) * part(i), 2.0 * part(i) * TAU / (N * N) as f64);
        (0..N).map(|j| brdf.eval_cos(wo, direction(libm::acos(z), TAU * part(j)))).sum::<f64>() * weight
    };
    (0..N).map(ring).sum()
}

/// For samplers of visible normals this is the weak white furnace test.
#[test]
fn every_density_integrates_to_one() {
    for (_, brdf, wo, name) in all() {
        let integral = integrate(350, |wi| brdf.pdf(wo, wi));
        assert!((integral - 1.0).abs() < 2e-3, "{name}: {integral}");
    }
}

#[test]
fn the_mean_weight_is_the_albedo() {
    const COUNT: usize = 1 << 14;
    for (_, brdf, wo, name) in all() {
        let mean =
            Lattice::new(COUNT, [0.0; 2]).points().map(|u| brdf.sample(wo, u).weight).sum::<f64>() / COUNT as f64;
        let albedo = albedo(&*brdf, wo);
        assert!((mean - albedo).abs() < 2e-3 * albedo.max(0.5), "{name}: {mean} {albedo}");
    }
}

/// Tests the largest fraction of uniform light that a model reflects, over roughnesses and views up to 89 degrees.
/// Microfacet models lose light by masking. Oren-Nayar reflects all light, because it includes further bounces. Smooth
/// sheen and Burley's diffuse reflection gain light at grazing angles: docs/recipe.md has these figures.
#[test]
fn no_model_reflects_more_than_documented() {
    let most = |model: &BrdfModel| {
        let alphas = [1e-4, 0.01, 0.1, 0.4, 1.0];
        let thetas = [0.0, 0.4, 0.8, 1.2, 1.4, 1.5, 1.55];
        let places = alphas.into_iter().flat_map(|alpha| thetas.map(|theta| (alpha, theta)));
        // The lobe of a mirror falls between the points of every quadrature.
        let places = places.filter(|(alpha, _)| !model.follows_reflection() || *alpha > 0.05);
        places.map(|(alpha, theta)| albedo(&*model.surface([alpha; 2]), direction(theta, 0.2))).fold(0.0, f64::max)
    };
    for model in models() {
        let (low, high) = match model.kind() {
            BrdfKind::Ggx | BrdfKind::Beckmann => (0.98, 1.0 + 1e-3),
            BrdfKind::Charlie => (1.9, 2.0),
            BrdfKind::CharlieNeubelt => (3.2, 3.4),
            BrdfKind::BurleyDiffuse => (1.5, 1.6),
            BrdfKind::OrenNayar => (1.0 - 1e-3, 1.0 + 1e-3),
            BrdfKind::Fuzz => (0.7, 0.75),
            // One file is Oren-Nayar's reflection, interpolated between nodes. The other is GGX with alpha of at least
            // 0.4. No file may reflect more than `MOST_ALBEDO`.
            BrdfKind::Tabulated if model.is_isotropic() => (0.99, MOST_ALBEDO + 1e-3),
            BrdfKind::Tabulated => (0.85, MOST_ALBEDO + 1e-3),
        };
        let most = most(&model);
        assert!((low..=high).contains(&most), "{model}: {most}");
    }
}

/// A model that preserves energy reflects all light for every view.
#[test]
fn oren_nayar_reflects_all_light() {
    for (alpha, theta) in [(0.0, 0.7), (0.04, 0.0), (0.3, 1.0), (1.0, 0.0), (1.0, 0.9), (1.0, 1.4), (0.5, 1.55)] {
        let albedo = albedo(&*BrdfKind::OrenNayar.surface([alpha; 2]), direction(theta, 1.0));
        assert!((albedo - 1.0).abs() < 1e-3, "{alpha} {theta}: {albedo}");
    }
}

#[test]
fn values_are_density_times_weight_and_reciprocal() {
    for (model, brdf, wo, name) in all() {
        let kind = model.kind();
        let (mut above, mut exchanged) = (0, 0);
        let points = || Lattice::new(64, [0.3, 0.1]).points();
        let most = points().map(|u| brdf.eval_cos(wo, brdf.sample(wo, u).wi)).fold(0.0, f64::max);
        for u in points() {
            let BrdfSample { wi, weight, cos_theta_d } = brdf.sample(wo, u);
            assert!((wi.length() - 1.0).abs() < 1e-12, "{name}: {wi}");
            if wi.z <= 0.0 {
                assert_eq!(weight, 0.0, "{name}");
                continue;
            }
            above += 1;
            let value = brdf.eval_cos(wo, wi);
            assert!((value / (brdf.pdf(wo, wi) * weight) - 1.0).abs() < 1e-8, "{name}: {value}");
            // A file has no views beyond its last view, so light beyond this view cannot be exchanged with the view.
            // The lobes of fuzz are fitted for each view separately, so they are not reciprocal.
            if kind == BrdfKind::Fuzz {
                exchanged += 1;
            } else if kind != BrdfKind::Tabulated || wi.z > 0.11 && wo.z > 0.11 {
                let swapped = brdf.eval_cos(wi, wo) / wo.z * wi.z;
                // After the exchange, azimuths lie between the nodes of a file.
                let allowed = if model.has_azimuths() { 0.05 * most } else { 1e-9 * swapped };
                assert!((value - swapped).abs() < allowed, "{name}: {value} {swapped}");
                exchanged += 1;
            }
            assert!((cos_theta_d - wo.dot((wo + wi).normalize())).abs() < 1e-9, "{name}: {cos_theta_d}");
        }
        assert!(above > 16 && exchanged > 16, "{name}");
    }
}

/// A model that returns an LTC has the density of this LTC.
#[test]
fn lobes_that_are_ltcs_have_their_density() {
    let mut ltcs = 0;
    for (model, brdf, wo, name) in all() {
        assert_eq!(brdf.ltc(wo).is_some(), model.kind().is_ltc(), "{name}");
        let Some(ltc) = brdf.ltc(wo).and_then(Ltc::new) else { continue };
        ltcs += 1;
        for u in Lattice::new(64, [0.3, 0.1]).points() {
            let [own, of_matrix] = [brdf.sample(wo, u).wi, ltc.sample(u)];
            assert!((brdf.pdf(wo, own) / ltc.pdf(own) - 1.0).abs() < 1e-9, "{name}: {own}");
            assert!((brdf.pdf(wo, of_matrix) / ltc.pdf(of_matrix) - 1.0).abs() < 1e-9, "{name}: {of_matrix}");
        }
    }
    assert_eq!(ltcs, CONFIGURATIONS.len());
}

/// Compares our models with the formulas of Unity's HDRP, using HDRP's names (`BSDF.hlsl`, `Fabric.hlsl`). Burley's
/// diffuse reflection differs by a constant factor, which LTCs do not contain. Charlie has two visibility terms. HDRP
/// uses the Oren-Nayar model of 1994, which differs from ours.
#[test]
fn hdrp_formulas_match_except_oren_nayar() {
    const DISNEY_NORMALISATION: f64 = 1.035_71;
    let [mut same, mut apart] = [0.0_f64; 2];
    for (alpha, wo) in
        [0.05, 0.3, 0.9].into_iter().flat_map(|alpha| [0.3, 1.0, 1.4].map(|t| (alpha, direction(t, 0.4))))
    {
        let surfaces = [BrdfKind::BurleyDiffuse, BrdfKind::CharlieNeubelt, BrdfKind::Charlie, BrdfKind::OrenNayar];
        let ours = surfaces.map(|kind| kind.surface([alpha; 2]));
        for wi in Lattice::new(40, [0.2, 0.6]).points().map(cosine_hemisphere) {
            let (nv, nl, lv) = (wo.z, wi.z, wo.dot(wi));
            let f90 = 0.5 + alpha.sqrt() * (1.0 + lv);
            let scatter = |cosine: f64| 1.0 + (f90 - 1.0) * (1.0 - cosine).powi(5);
            let disney = scatter(nl) * scatter(nv) / PI / DISNEY_NORMALISATION;
            let sin2 = 1.0 - (wo + wi).normalize().z.powi(2);
            let d = (2.0 + 1.0 / alpha) * sin2.powf(0.5 / alpha) / TAU;
            let ashikhmin = d / (4.0 * (nl + nv - nl * nv));
            let mix = |a: f64, b: f64| a + (b - a) * (1.0 - (1.0 - alpha) * (1.0 - alpha));
            let l = |x: f64| {
                mix(25.3245, 21.5473) / (1.0 + mix(3.32435, 3.82987) * x.powf(mix(0.16801, 0.19823)))
                    + mix(-1.27393, -1.97760) * x
                    + mix(-4.85967, -4.32054)
            };
            let shadow = |x: f64| if x < 0.5 { l(x) } else { 2.0 * l(0.5) - l(1.0 - x) }.exp();
            let charlie = d / ((1.0 + shadow(nv) + shadow(nl)) * 4.0 * nv * nl);
            let theirs = [disney * DISNEY_NORMALISATION, ashikhmin, charlie];
            for (ours, theirs) in ours.iter().zip(theirs) {
                let ratio = ours.eval_cos(wo, wi) / (theirs * nl);
                same = same.max(if theirs > 0.0 { (ratio - 1.0).abs() } else { 0.0 });
            }
            let sigma2 = (0.5 * PI * alpha).powi(2);
            let (low, high) = (nv.min(nl), nv.max(nl));
            let slant = ((1.0 - low * low) * (1.0 - high * high)).sqrt() / high;
            let between = (wo.x * wi.x + wo.y * wi.y) / ((1.0 - nv * nv) * (1.0 - nl * nl)).sqrt();
            let oren_nayar =
                1.0 - 0.5 * sigma2 / (sigma2 + 0.57) + 0.45 * sigma2 / (sigma2 + 0.09) * between.max(0.0) * slant;
            apart = apart.max((ours[3].eval_cos(wo, wi) * PI / (oren_nayar * nl) - 1.0).abs());
        }
    }
    assert!(same < 1e-9 && apart > 0.3, "{same} {apart}");
}

/// An isotropic model uses the larger roughness, and its lobe turns with the view. Other models depend on both
/// roughnesses and on the azimuth.
#[test]
fn isotropic_models_ignore_the_azimuth() {
    let [wo, wi] = [direction(0.8, 0.3), direction(0.5, 2.0)];
    let turned = |by: f64| [direction(0.8, 0.3 + by), direction(0.5, 2.0 + by)];
    for kind in models() {
        let brdf = kind.surface([0.5, 0.2]);
        let value = brdf.eval_cos(wo, wi);
        let [wo, wi] = turned(1.0);
        let apart = brdf.eval_cos(wo, wi) / value - 1.0;
        assert_eq!(apart.abs() < 1e-9, kind.is_isotropic(), "{kind}: {apart}");
        let larger = kind.surface([0.5, 0.5]).eval_cos(wo, wi) / brdf.eval_cos(wo, wi) - 1.0;
        assert_eq!(larger.abs() < 1e-9, kind.is_isotropic(), "{kind}: {larger}");
    }
}

/// Tests surfaces from mirrors to the largest roughness, views from above to the horizon, and points at the ends of the
/// unit square. No value is NaN or negative.
#[test]
fn extremes_are_finite() {
    let ends = [0.0, f64::EPSILON, 0.3, 0.5, 1.0 - f64::EPSILON / 2.0];
    let views = [0.0, 1e-9, 0.7, 1.5, 0.9999 * FRAC_PI_2, FRAC_PI_2 - 1e-9];
    for kind in models() {
        for alphas in [[1e-5, 1e-5], [1e-4, 1e-5], [1.0, 1e-5], [0.01, 0.01], [1.0, 1.0]] {
            let brdf = kind.surface(alphas);
            for wo in views.into_iter().flat_map(|theta| [0.0, 0.6, FRAC_PI_2].map(|phi| direction(theta, phi))) {
                for u in ends.into_iter().flat_map(|a| ends.map(|b| [a, b])) {
                    let BrdfSample { wi, weight, cos_theta_d } = brdf.sample(wo, u);
                    let values = [weight, brdf.pdf(wo, wi), brdf.eval_cos(wo, wi), brdf.eval_cos(wo, wo)];
                    assert!(wi.is_finite() && (wi.length() - 1.0).abs() < 1e-9, "{kind} {alphas:?} {wo} {u:?}: {wi}");
                    assert!(
                        values.iter().all(|x| x.is_finite() && *x >= 0.0),
                        "{kind} {alphas:?} {wo} {u:?}: {values:?}"
                    );
                    assert!((-1.0..=1.0 + 1e-12).contains(&cos_theta_d), "{kind} {alphas:?} {wo} {u:?}: {cos_theta_d}");
                }
            }
        }
    }
}

/// If a sampler does not follow its lobe, few samples carry most of the light. A fit draws only a few hundred samples.
#[test]
fn samplers_follow_their_lobes() {
    for kind in models() {
        for (alpha, theta) in
            [1e-4, 0.02, 0.1, 0.4, 1.0].into_iter().flat_map(|a| [0.0, 0.5, 1.0, 1.4, 1.56].map(|t| (a, t)))
        {
            let (brdf, wo) = (kind.surface([alpha; 2]), direction(theta, 0.4));
            let weights: Vec<f64> = Lattice::new(2048, [0.0; 2]).points().map(|u| brdf.sample(wo, u).weight).collect();
            let (sum, squares) = weights.iter().fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
            let share = sum * sum / squares / 2048.0;
            assert!(share > 0.2, "{kind} {alpha} {theta}: {share}");
        }
    }
}

/// Pearson's chi-square test of random samples against the integrated density, over cells of equal solid angle.
#[test]
fn samples_follow_the_density() {
    const ROWS: usize = 24;
    const COLUMNS: usize = 24;
    const SAMPLES: usize = 50_000;
    let cell = |w: DVec3| {
        let azimuth = (atan2(w.y, w.x) / TAU).rem_euclid(1.0);
        let row = ((w.z + 1.0) * 0.5 * ROWS as f64) as usize;
        row.min(ROWS - 1) * COLUMNS + ((azimuth * COLUMNS as f64) as usize).min(COLUMNS - 1)
    };
    // 480 is a multiple of the numbers of rows and columns, so each quadrature cell lies in one test cell.
    let cells: Vec<(DVec3, usize)> = sphere(480).map(|wi| (wi, cell(wi))).collect();
    for (k, (_, brdf, wo, name)) in all().enumerate() {
        let mut expected = vec![0.0; ROWS * COLUMNS];
        for (wi, cell) in &cells {
            expected[*cell] += brdf.pdf(wo, *wi);
        }
        let total: f64 = expected.iter().sum();
        let mut observed = vec![0.0; ROWS * COLUMNS];
        let mut random = Xoshiro256PlusPlus::seed_from_u64(k as u64);
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        for _ in 0..SAMPLES {
            observed[cell(brdf.sample(wo, [uniform(), uniform()]).wi)] += 1.0;
        }
        let (mut chi2, mut cells, mut rare) = (0.0, -1.0, (0.0, 0.0));
        for (observed, expected) in observed.into_iter().zip(expected) {
            let expected = expected / total * SAMPLES as f64;
            if expected < 5.0 {
                rare = (rare.0 + observed, rare.1 + expected);
                continue;
            }
            chi2 += (observed - expected) * (observed - expected) / expected;
            cells += 1.0;
        }
        assert!(cells > 10.0, "{name}");
        // Chi-square with n degrees of freedom has mean n and variance 2 n. A correct sampler practically never exceeds
        // the mean by five standard deviations.
        let limit = cells + 5.0 * f64::sqrt(2.0 * cells);
        assert!(chi2 < limit, "{name}: {chi2} over {cells} cells");
        assert!((rare.0 - rare.1).abs() < 5.0 * f64::sqrt(rare.1 + 1.0), "{name}: {rare:?}");
    }
}
