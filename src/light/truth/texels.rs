//! The light of each texel of a picture on a rectangle, by adaptive quadrature over its area.
//!
//! A cell is done if the midpoint rules over it and over its quarters agree. Sharp lobes could be between midpoints. So
//! cells are quartered until they are small compared with their distance from the point that a mirror reflects. This
//! file shares no code with the closed form, nor with the quadrature over normals that checks its sum.

use glam::DVec3;

use ltcforge_fit::brdf::{Brdf, Ggx};

/// The largest number of times that a texel is quartered.
const DEPTH: u32 = 14;
/// The error allowed for a cell relative to its own light, in units of `tolerance`. It is large because the
/// extrapolated result is of fourth order.
const OF_CELL: f64 = 30.0;
/// The distance of the meeting point if a mirrored ray does not meet the plane.
const NOWHERE: f64 = 1e9;

/// The light of every texel of a picture on a rectangle, row by row, for a Fresnel factor of one and weighted by
/// Schlick's fifth power. The rectangle is given by a corner and two sides, along rows and columns. `tolerance` is for
/// the whole light.
///
/// Domain: `wo` above the surface.
pub(crate) fn texel_lights(
    [alpha_x, alpha_y]: [f64; 2],
    wo: DVec3,
    [corner, x, y]: [DVec3; 3],
    [width, height]: [usize; 2],
    tolerance: f64,
) -> Vec<[f64; 2]> {
    let ggx = Ggx { alpha_x, alpha_y };
    let parts = [1.0 / width as f64, 1.0 / height as f64];
    let normal = x.cross(y);
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    let descent = corner.dot(normal) / mirrored.dot(normal);
    let met = mirrored * if descent > 0.0 && descent.is_finite() { descent } else { NOWHERE };
    let cells = Cells {
        density: |p: DVec3| density(ggx, wo, normal, p),
        corner,
        sides: [x, y],
        met,
        sharpness: alpha_x.min(alpha_y) * met.length(),
        tolerance,
        area: normal.length(),
    };
    (0..width * height)
        .map(|i| {
            let middle = [((i % width) as f64 + 0.5) * parts[0], ((i / width) as f64 + 0.5) * parts[1]];
            cells.integral(middle, parts, (cells.density)(cells.at(middle)), DEPTH)
        })
        .collect()
}

/// The reflected light of an element of area, divided by the area.
fn density(ggx: Ggx, wo: DVec3, normal: DVec3, p: DVec3) -> [f64; 2] {
    if p.z <= 0.0 {
        return [0.0; 2];
    }
    let r2 = p.length_squared();
    let wi = p / r2.sqrt();
    let cosine = (wo + wi).normalize_or_zero().dot(wo);
    let value = ggx.eval_cos(wo, wi) * normal.dot(wi).abs() / (r2 * normal.length());
    [value, value * (1.0 - cosine).clamp(0.0, 1.0).powi(5)]
}

struct Cells<F> {
    density: F,
    corner: DVec3,
    sides: [DVec3; 2],
    /// The point that a mirror reflects. `sharpness` is about the smallest width of the lobe there, as a length.
    met: DVec3,
    sharpness: f64,
    tolerance: f64,
    /// The area of the rectangle.
    area: f64,
}

impl<F: Fn(DVec3) -> [f64; 2]> Cells<F> {
    fn at(&self, uv: [f64; 2]) -> DVec3 {
        self.corner + self.sides[0] * uv[0] + self.sides[1] * uv[1]
    }

    /// The integral over a cell around `middle`. `parts` are its sides relative to the rectangle's sides, and `first`
    /// is the density at its centre.
    fn integral(&self, middle: [f64; 2], parts: [f64; 2], first: [f64; 2], depth: u32) -> [f64; 2] {
        let area = self.area * parts[0] * parts[1];
        let half = parts.map(|part| 0.5 * part);
        let quarters = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]]
            .map(|[x, y]| [middle[0] + x * half[0], middle[1] + y * half[1]]);
        let values = quarters.map(|uv| (self.density)(self.at(uv)));
        let coarse = first.map(|value| value * area);
        let fine = [0, 1].map(|i| 0.25 * area * values.iter().map(|value| value[i]).sum::<f64>());
        let longest = (self.sides[0].length() * parts[0]).max(self.sides[1].length() * parts[1]);
        let is_small = 5.0 * longest < self.met.distance(self.at(middle)) + 2.0 * self.sharpness;
        let allowed = self.tolerance * (parts[0] * parts[1] + OF_CELL * fine[0]);
        if depth == 0 || (is_small && (fine[0] - coarse[0]).abs() <= allowed) {
            // The error of the midpoint rule falls to a quarter from `coarse` to `fine`.
            return [0, 1].map(|i| fine[i] + (fine[i] - coarse[i]) / 3.0);
        }
        let integrals = [0, 1, 2, 3].map(|i| self.integral(quarters[i], half, values[i], depth - 1));
        [0, 1].map(|i| integrals.iter().map(|integral| integral[i]).sum())
    }
}
