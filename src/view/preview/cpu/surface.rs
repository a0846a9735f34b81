//! Twin of `sphere.wgsl`.

use glam::{Mat3, Vec2, Vec3};

use super::{
    any_brdf,
    ggx::{self, ColouredParts, Shaded},
    light::Inverse,
    lookup::{LEAST_ALPHA, blend, lookup, lookup_both},
    solids, textured,
};
use crate::preview::{
    ShaderTable, Surface,
    estimator::Estimator,
    frame::{Frame, FrameShape, LOWEST_VIEW},
    radiances::{BELOW, BESIDE},
};
use ltcforge_fit::{BrdfKind, SecondLobe, Sides};
use ltcforge_light::{
    ClosedForm, Gaussian, LightModel, LitPoint, albedo,
    gaussians::{self, SphericalGaussian},
    ltc::FormulaLobe,
};

const POLE: f32 = 1e-4;
const LOWEST_EYE: f32 = 1e-3;
/// The distance of the background.
const FAR: f32 = 1e30;

pub(super) fn pixel(frame: &Frame, table: &ShaderTable, estimator: Estimator, at: [u32; 2]) -> [f32; 3] {
    let (place, cell) = place_of(frame, at);
    match estimator {
        Estimator::ClosedForm(form) => surface(frame, place, cell, |at| by_closed_form(frame, form, at)),
        Estimator::Table(lobe) => surface(frame, place, cell, |at| match lobe.gaussian() {
            None => by_table(frame, table, at),
            Some(gaussian) => by_gaussian_table(frame, table, gaussian, at),
        }),
        Estimator::TwoLobes(second) => surface(frame, place, cell, |at| by_two_lobes(frame, table, second, at)),
        Estimator::Reference => surface(frame, place, cell, |shaded| {
            let key = at[1] * frame.size + at[0];
            let colour = |wi: Vec3| textured::colour(frame, shaded.position, wi);
            if table.brdf == BrdfKind::Ggx {
                let parts = ggx::reference(shaded, &frame.light, colour, frame.spp, key);
                return reflected_colours(frame, parts, || albedo_of(shaded));
            }
            let parts = any_brdf::reference(&table.brdf, shaded, &frame.light, colour, frame.spp, key);
            reflected_colours(frame, parts, || lookup(table, shaded.alpha.x, shaded.alpha.y, shaded.wo).amplitude)
        }),
        Estimator::TableLobe | Estimator::ReferenceLobe => {
            let density = direction_of(frame, place).map_or(BESIDE, |wi| lobe(frame, table, estimator, wi));
            [density; 3]
        }
    }
}

/// The cell whose surface covers at least a part of a pixel. `None` if a light in front of the surface does so too.
pub(in crate::preview) fn covering(frame: &Frame, pixel: [u32; 2]) -> Option<usize> {
    let (place, cell) = place_of(frame, pixel);
    hit_at(frame, place, cell).filter(|hit| !textured::covers(frame, place, hit.distance)).map(|_| cell as usize)
}

fn place_of(frame: &Frame, pixel: [u32; 2]) -> (Vec2, u32) {
    let side = frame.size / frame.cells;
    let cell = pixel.map(|x| (x / side).min(frame.cells - 1));
    let within = |axis: usize| ((pixel[axis] - cell[axis] * side) as f32 + 0.5) / side as f32 * 2.0 - 1.0;
    (Vec2::new(within(0), -within(1)), cell[1] * frame.cells + cell[0])
}

fn surface(frame: &Frame, place: Vec2, cell: u32, shade: impl FnOnce(&Shaded) -> Vec3) -> [f32; 3] {
    let hit = hit_at(frame, place, cell);
    let distance = hit.as_ref().map_or(FAR, |hit| hit.distance);
    let radiance = hit.map_or(frame.background, |Hit { at, coverage, .. }| {
        frame.background * (1.0 - coverage) + shade(&at) * coverage
    });
    let (light, covered) = textured::light_in(frame, place, distance);
    ((1.0 - covered) * radiance + light).to_array()
}

/// A visible point of the surface, the share of the pixel that it covers, and its distance.
struct Hit {
    at: Shaded,
    coverage: f32,
    distance: f32,
}

fn hit_at(frame: &Frame, place: Vec2, cell: u32) -> Option<Hit> {
    let material = frame.material(cell)?;
    let ray = (frame.forward + frame.right * place.x + frame.up * place.y).normalize();
    let eye = frame.eye;
    let (position, normal, along, coverage, distance) = match frame.surface {
        Surface::Floor => {
            let t = -eye.y / ray.y.min(-1e-6);
            let position = eye + t * ray;
            let fades = 1.0 - t / frame.floor_end;
            let is_seen = ray.y < -1e-6 && eye.y > LOWEST_EYE;
            let coverage = if is_seen { (2.0 * fades).clamp(0.0, 1.0) } else { 0.0 };
            (Vec3::new(position.x, 0.0, position.z), Vec3::Y, Vec3::X, coverage, t)
        }
        Surface::Sphere => {
            let closest = -eye.dot(ray);
            let nearest = eye + closest * ray;
            let distance2 = nearest.dot(nearest);
            let rim = (1.0 - distance2.sqrt()) / (frame.pixel * closest);
            let coverage = if closest > 0.0 { (rim + 0.5).clamp(0.0, 1.0) } else { 0.0 };
            let depth = (1.0 - distance2).max(0.0).sqrt();
            let position = (nearest - depth * ray).normalize();
            let circle = Vec3::new(position.z, 0.0, -position.x);
            let length2 = circle.dot(circle);
            let along = if length2 > POLE * POLE { circle / length2.max(1e-12).sqrt() } else { Vec3::X };
            (position, position, along, coverage, closest - depth)
        }
    };
    if coverage <= 0.0 {
        return None;
    }
    let [alpha_x, alpha_y, cos, sin] = material;
    let across = normal.cross(along);
    let x = cos * along + sin * across;
    let y = cos * across - sin * along;
    let view = (eye - position).normalize();
    let wo = Vec3::new(view.dot(x), view.dot(y), view.dot(normal).max(LOWEST_VIEW)).normalize();
    let alpha = Vec2::new(alpha_x, alpha_y).max(Vec2::splat(LEAST_ALPHA));
    Some(Hit { at: Shaded { position, x, y, z: normal, wo, alpha }, coverage, distance })
}

fn by_table(frame: &Frame, table: &ShaderTable, at: &Shaded) -> Vec3 {
    let lobe = lookup(table, at.alpha.x, at.alpha.y, at.wo);
    let covered = coloured_by(frame, &Inverse::of(lobe.matrix), at);
    let parts = ColouredParts { all: lobe.amplitude * covered, fresnel: lobe.fresnel * covered };
    reflected_colours(frame, parts, || lobe.amplitude)
}

fn by_two_lobes(frame: &Frame, table: &ShaderTable, second: SecondLobe, at: &Shaded) -> Vec3 {
    let (first, matrix) = lookup_both(table, at.alpha.x, at.alpha.y, at.wo);
    let covered = match second {
        SecondLobe::Blended => {
            let f0 = frame.f0.dot(Vec3::splat(1.0 / 3.0));
            [coloured_by(frame, &Inverse::of(blend(&first, matrix, f0, 1.0)), at); 2]
        }
        SecondLobe::Integrated => [first.matrix, matrix].map(|m| coloured_by(frame, &Inverse::of(m), at)),
    };
    let parts = ColouredParts { all: first.amplitude * covered[0], fresnel: first.fresnel * covered[1] };
    reflected_colours(frame, parts, || first.amplitude)
}

/// The part of a lobe that the light covers, times the colour of the light's picture.
fn coloured_by(frame: &Frame, inverse: &Inverse, at: &Shaded) -> Vec3 {
    let covered = covered_by(frame, inverse, at);
    match &frame.picture {
        Some(picture) if covered > 0.0 => covered * textured::colour_by_lobe(frame, picture, inverse, at),
        _ => Vec3::splat(covered),
    }
}

fn covered_by(frame: &Frame, inverse: &Inverse, at: &Shaded) -> f32 {
    let to_local = Mat3::from_cols(at.x, at.y, at.z).transpose();
    if frame.is_cut {
        inverse.covered_above(&frame.light, at.position, to_local)
    } else {
        inverse.covered(&frame.light, at.position, to_local)
    }
}

/// The vertices of the light in the tangent frame of a surface.
fn around(frame: &Frame, at: &Shaded) -> (Vec<[f32; 3]>, Sides) {
    let to_local = Mat3::from_cols(at.x, at.y, at.z).transpose();
    let light = &frame.light;
    let vertices = match light.shape {
        FrameShape::Polygon | FrameShape::Ellipse(_) => {
            light.vertices.iter().map(|v| (to_local * (*v - at.position)).to_array()).collect()
        }
        FrameShape::Tube { .. } | FrameShape::Line { .. } => {
            solids::outline(&light.shape, at.position, at.z).into_iter().map(|v| (to_local * v).to_array()).collect()
        }
    };
    (vertices, if light.is_two_sided() { Sides::Two } else { Sides::One })
}

fn by_closed_form(frame: &Frame, form: ClosedForm, at: &Shaded) -> Vec3 {
    if form.model() == LightModel::LtcFormula {
        let f0 = frame.f0.dot(Vec3::splat(1.0 / 3.0));
        let lobe = FormulaLobe::new(at.alpha.to_array(), at.wo.to_array(), [f0, 1.0]);
        let covered = coloured_by(frame, &Inverse::of_rows(lobe.space.rows()), at);
        let [all, fresnel] = lobe.parts.map(|part| part * covered);
        return reflected_colours(frame, ColouredParts { all, fresnel }, || lobe.parts[0]);
    }
    if let Some(picture) = &frame.picture {
        return reflected_colours(frame, textured::by_normals(frame, picture, form.rule(), at), || albedo_of(at));
    }
    let (vertices, sides) = around(frame, at);
    let lit = LitPoint { alpha: at.alpha.to_array(), wo: at.wo.to_array(), vertices: &vertices, sides };
    reflected(frame, Vec2::from(form.reflected_f32(&lit)), || albedo_of(at))
}

fn by_gaussian_table(frame: &Frame, table: &ShaderTable, gaussian: Gaussian, at: &Shaded) -> Vec3 {
    let (vertices, sides) = around(frame, at);
    let parts = lit_by_gaussian(table, gaussian, at.alpha.to_array(), at.wo, &vertices, sides);
    reflected(frame, Vec2::from(parts), || albedo_of(at))
}

/// Twin of `gaussians_table.wgsl`.
pub(super) fn lit_by_gaussian(
    table: &ShaderTable,
    gaussian: Gaussian,
    [alpha_x, alpha_y]: [f32; 2],
    wo: Vec3,
    vertices: &[[f32; 3]],
    sides: Sides,
) -> [f32; 2] {
    let lobe = lookup(table, alpha_x, alpha_y, wo);
    let columns = [lobe.matrix.x_axis, lobe.matrix.y_axis, lobe.matrix.z_axis].map(|column| column.to_array());
    let shape = SphericalGaussian::of_columns(gaussian, columns);
    gaussians::reflected_by(&shape, [lobe.amplitude, lobe.fresnel], vertices, sides)
}

/// Twin of `ltc_albedo.wgsl`.
fn albedo_of(at: &Shaded) -> f32 {
    albedo::albedo(at.alpha.to_array(), at.wo.to_array())
}

fn reflected(frame: &Frame, parts: Vec2, albedo: impl FnOnce() -> f32) -> Vec3 {
    reflected_colours(frame, ColouredParts::grey(parts), albedo)
}

fn reflected_colours(frame: &Frame, parts: ColouredParts, albedo: impl FnOnce() -> f32) -> Vec3 {
    let once = (frame.f0 * (parts.all - parts.fresnel) + parts.fresnel) * frame.light.radiance;
    if !frame.is_compensated {
        return once;
    }
    once * (Vec3::ONE + frame.f0 * (1.0 / albedo().max(0.01) - 1.0))
}

/// The pixel that shows a direction in the picture of a lobe. `None` on the far side of the sphere of directions. The
/// inverse of [`direction_of`].
pub(in crate::preview) fn place_of_direction(frame: &Frame, w: Vec3) -> Option<[f32; 2]> {
    let place = Vec2::new(w.dot(frame.right), w.dot(frame.up)) / 1.05;
    let half = 0.5 * frame.size as f32;
    (w.dot(frame.forward) <= 0.0).then_some([half * (1.0 + place.x), half * (1.0 - place.y)])
}

fn direction_of(frame: &Frame, place: Vec2) -> Option<Vec3> {
    let flat = place * 1.05;
    let height2 = 1.0 - flat.dot(flat);
    (height2 > 0.0).then(|| frame.right * flat.x + frame.up * flat.y - frame.forward * height2.sqrt())
}

fn lobe(frame: &Frame, table: &ShaderTable, estimator: Estimator, wi: Vec3) -> f32 {
    let [alpha_x, alpha_y, ..] = frame.materials[0];
    let wo = frame.lobe_wo;
    if estimator == Estimator::TableLobe {
        let lobe = lookup(table, alpha_x, alpha_y, wo);
        let density = Inverse::of(lobe.matrix).density(wi) * lobe.amplitude;
        return if wi.z < 0.0 && density <= 0.0 { BELOW } else { density };
    }
    if wi.z <= ggx::HORIZON {
        return if wi.z < 0.0 { BELOW } else { 0.0 };
    }
    let alpha = Vec2::new(alpha_x, alpha_y).max(Vec2::splat(LEAST_ALPHA));
    if table.brdf != BrdfKind::Ggx {
        return any_brdf::lobe(&table.brdf, alpha, wo, wi);
    }
    let g2 = 1.0 / (1.0 + ggx::smith_lambda(alpha, wo) + ggx::smith_lambda(alpha, wi));
    ggx::distribution(alpha, (wo + wi).normalize()) * g2 / (4.0 * wo.z)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::preview::NamedScene;
    use ltcforge_fit::Configuration;
    use ltcforge_light::{NormalsRule, PolygonLight, normals, truth_within};

    /// Mean error, over the pixels, of the light by the closed form, for white metal under a light of radiance one.
    fn error(scene: NamedScene) -> f64 {
        let scene = scene.scene();
        let frame = Frame::new(&crate::preview::Scene { size: 32, ..scene }, false);
        let (mut sum, mut count) = (0.0, 0);
        for pixel in (0..frame.size * frame.size).map(|i| [i % frame.size, i / frame.size]) {
            let (place, cell) = place_of(&frame, pixel);
            let Some(Hit { at, .. }) = hit_at(&frame, place, cell).filter(|hit| hit.coverage == 1.0) else { continue };
            let to_local = Mat3::from_cols(at.x, at.y, at.z).transpose();
            let vertices: Vec<Vec3> = frame.light.vertices.iter().map(|v| to_local * (*v - at.position)).collect();
            let sides = if frame.light.two_sided { Sides::Two } else { Sides::One };
            let arrays: Vec<[f32; 3]> = vertices.iter().map(Vec3::to_array).collect();
            let [found, _] =
                normals::reflected(at.alpha.to_array(), at.wo.to_array(), &arrays, sides, NormalsRule::Balanced);
            let wo = at.wo.as_dvec3().normalize();
            let [alpha_x, alpha_y] = at.alpha.to_array().map(f64::from);
            let seen = Configuration { alpha_x, alpha_y, theta: wo.z.acos(), phi: wo.y.atan2(wo.x) };
            // Rounding can make an edge that points at the surface look concave.
            let light: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
            let Ok(light) = PolygonLight::new(light, sides) else { continue };
            let wanted = truth_within(1e-5, &seen, &light).expect("a surface").energy;
            sum += (f64::from(found) - wanted).abs();
            count += 1;
        }
        assert!(count > 300, "{count}");
        sum / f64::from(count)
    }

    /// The reference is a quadrature, without noise. The limits are twice the measured errors.
    #[test]
    fn scenes_by_normals_are_near_the_quadrature() {
        for (scene, limit) in LIMITS {
            let error = error(scene);
            println!("{scene:?}: {error:.6}");
            assert!(error < limit, "{scene:?}: {error}");
        }
    }

    const LIMITS: [(NamedScene, f64); 4] = [
        (NamedScene::Sphere, 0.0004),
        (NamedScene::Figure14, 0.0004),
        (NamedScene::BrushedFloor, 0.0008),
        (NamedScene::Horizon, 0.0025),
    ];
}
