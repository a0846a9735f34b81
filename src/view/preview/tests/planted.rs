use glam::{DMat3, DVec3};

use ltcforge_fit::{
    BrdfKind, Layout, LobeModel, PerAxis, Table, Terms,
    math::{row_major, sin_cos},
};

/// A table whose entries are the limit of sharp lobes, `[2 alpha_x (v_z x + v_x z), 2 alpha_y (v_z y + v_y z), r]` with
/// mirror direction `r`. They are close to fitted entries, but need no fit.
pub(in crate::preview) fn planted() -> Table {
    sharp(Layout::Kt2022.nodes(&whole([0.0, 1.0]), &PerAxis { alpha: 5, ratio: 4, theta: 6, phi: 4 }))
}

/// All views and ratios, for these roughnesses.
fn whole(alpha: [f64; 2]) -> PerAxis<[f64; 2]> {
    PerAxis { alpha, ratio: [0.0, 1.0], theta: [0.0, 1.57], phi: [0.0, std::f64::consts::FRAC_PI_2] }
}

/// [`planted`] for isotropic surfaces: one ratio and one phi. Its lobes rotate with the view.
pub(in crate::preview) fn isotropic() -> Table {
    let range = PerAxis { ratio: [1.0; 2], phi: [0.3; 2], ..whole([0.0, 1.0]) };
    sharp(Layout::Kt2022.nodes(&range, &PerAxis { alpha: 5, ratio: 1, theta: 6, phi: 1 }))
}

fn sharp(axes: PerAxis<Vec<f64>>) -> Table {
    let mut entries = Vec::new();
    for alpha in &axes.alpha {
        for ratio in &axes.ratio {
            for theta in &axes.theta {
                entries.extend(axes.phi.iter().map(|phi| (*alpha, alpha * ratio, *theta, *phi)));
            }
        }
    }
    table(axes, |entry| {
        let (alpha_x, alpha_y, theta, phi) = entries[entry];
        let ((sin_t, cos_t), (sin_p, cos_p)) = (sin_cos(theta), sin_cos(phi));
        let v = DVec3::new(sin_t * cos_p, sin_t * sin_p, cos_t.max(1e-4));
        let m = DMat3::from_cols(
            2.0 * alpha_x * DVec3::new(v.z, 0.0, v.x),
            2.0 * alpha_y.max(1e-5) * DVec3::new(0.0, v.z, v.y),
            DVec3::new(-v.x, -v.y, v.z),
        );
        (m, 1.0 - 0.3 * alpha_x, (1.0 - v.z).powi(5))
    })
}

/// A table of layout `reflected` whose entries are near the limit of sharp lobes, `diag(1, ratio, 1)`. Its axes end
/// within the domain.
pub(in crate::preview) fn reflected() -> Table {
    let axes = Layout::Reflected.nodes(&whole([0.0, 0.9]), &PerAxis { alpha: 5, ratio: 4, theta: 6, phi: 4 });
    let PerAxis { ratio, theta, phi, .. } = axes.lengths();
    let (alphas, ratios) = (axes.alpha.clone(), axes.ratio.clone());
    let planted = table(axes, |entry| {
        let (alpha, ratio) = (alphas[entry / (ratio * theta * phi)], ratios[entry / (theta * phi) % ratio]);
        let lean = 0.1 * alpha * (entry % theta) as f64;
        let m = DMat3::from_cols(
            DVec3::new(1.0 - 0.4 * alpha, 0.0, lean),
            DVec3::new(0.0, ratio.max(1e-3), 0.0),
            DVec3::new(-lean, 0.0, 1.0),
        );
        (m, 1.0 - 0.3 * alpha, 0.05 * alpha)
    });
    Table { layout: Layout::Reflected, ..planted }
}

/// A table in which every entry is the clamped cosine with amplitude one.
pub(super) fn diffuse() -> Table {
    let axes = Layout::Kt2022.nodes(&whole([0.0, 1.0]), &PerAxis { alpha: 2, ratio: 2, theta: 2, phi: 2 });
    table(axes, |_| (DMat3::IDENTITY, 1.0, 0.0))
}

/// A table, built from a function that returns the matrix, amplitude and Fresnel term of each entry.
fn table(axes: PerAxis<Vec<f64>>, entry: impl Fn(usize) -> (DMat3, f64, f64)) -> Table {
    let PerAxis { alpha, ratio, theta, phi } = axes.lengths();
    let entries: Vec<(DMat3, f64, f64)> = (0..alpha * ratio * theta * phi).map(entry).collect();
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        axes,
        matrix: entries.iter().map(|(m, ..)| row_major(m).map(|x| x as f32)).collect(),
        terms: Some(Terms {
            amplitude: entries.iter().map(|(_, amplitude, _)| *amplitude as f32).collect(),
            fresnel: entries.iter().map(|(.., fresnel)| *fresnel as f32).collect(),
            edge: None,
        }),
        second: None,
        node_error: vec![0.0; entries.len()],
    }
}
