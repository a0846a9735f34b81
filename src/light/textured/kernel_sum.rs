//! The exact sum of the kernel over the picture, which the prefilter approximates.

use super::LightImage;

/// Sums the kernel `(1 + r^2 / sigma^2)^-2.5` around a point over the picture, and divides by its sum. Uses 3 x 3
/// points for each texel. The point is in parts of the picture's sides, sigma in texels.
#[must_use]
pub fn kernel_sum(image: &LightImage, [u, v]: [f64; 2], sigma: f64) -> [f64; 3] {
    const GRID: usize = 3;
    let middle = [u * image.width() as f64, v * image.height() as f64];
    let at = |i: usize, axis: usize| ((i as f64 + 0.5) / GRID as f64 - middle[axis]) / sigma;
    let (mut mass, mut sum) = (0.0, [0.0; 3]);
    for y in 0..image.height() * GRID {
        for x in 0..image.width() * GRID {
            let q = 1.0 + at(x, 0).powi(2) + at(y, 1).powi(2);
            let weight = 1.0 / (q * q * q.sqrt());
            mass += weight;
            for (sum, texel) in sum.iter_mut().zip(image.row(y / GRID)[x / GRID]) {
                *sum += weight * f64::from(texel);
            }
        }
    }
    sum.map(|sum| sum / mass)
}
