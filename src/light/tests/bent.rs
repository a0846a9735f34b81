//! Lights whose image among the normals is so curved that triangles around its mean normal overlap.

use glam::DVec3;

use crate::cases::Lit;
use crate::{NormalsRule, by_normals, truth};
use ltcforge_fit::{Configuration, Sides};

/// `alpha_x`, `alpha_y`, `theta` and `phi`, and the vertices of five lights. They were found among hundreds of
/// thousands of random lights.
const BENT: [([f64; 4], [[f64; 3]; 4]); 5] = [
    (
        [0.0868, 0.5393, 1.3154, 4.0156],
        [[0.5407, 1.3045, 0.1641], [0.1216, -0.9958, -0.3575], [1.3831, -1.3918, 0.3757], [1.8022, 0.9084, 0.8973]],
    ),
    (
        [0.4019, 0.0321, 1.4955, 5.1712],
        [[0.7994, 1.4655, 0.1882], [-1.5862, 0.4848, 0.7181], [-1.6774, 0.3211, 0.0044], [0.7082, 1.3019, -0.5254]],
    ),
    (
        [0.4754, 0.051, 1.2741, 4.4496],
        [[0.6725, 1.5176, 0.9599], [-0.2716, 0.2185, -0.0828], [0.1094, 0.2592, -0.4784], [1.0535, 1.5583, 0.5643]],
    ),
    (
        [0.0809, 0.5631, 1.4187, 5.8409],
        [[-0.3391, -1.0926, 1.5686], [-0.9713, 0.4054, -1.0918], [-1.4307, 1.013, -0.6405], [-0.7986, -0.485, 2.0199]],
    ),
    (
        [0.1728, 0.0096, 1.532, 1.0193],
        [
            [-1.4282, -1.1592, -0.0846],
            [-1.4581, -0.8129, 0.2771],
            [0.3824, -0.5434, 0.1712],
            [0.4123, -0.8896, -0.1905],
        ],
    ),
];

/// If triangles cancel, or if a triangle crosses its own sides, their plain sum has an error of up to 0.08 on these
/// lights. On the first light the sum is 0.014 instead of 0.064, which shows as a black patch.
#[test]
fn bent_images_are_no_darker_and_no_brighter() {
    for ([alpha_x, alpha_y, theta, phi], vertices) in BENT {
        let at = Configuration { alpha_x, alpha_y, theta, phi };
        let light = Lit { at, vertices: vertices.map(DVec3::from_array).to_vec() }.light(Sides::Two);
        let wanted = truth(&at, &light).expect("a surface").energy;
        for (rule, limit) in [(NormalsRule::Balanced, 0.035), (NormalsRule::Fine, 0.03)] {
            let found = by_normals(&at, &light, rule).expect("a surface").energy;
            assert!((found - wanted).abs() < limit, "{rule}: {found} instead of {wanted}, {at:?}");
            assert!(found > 0.5 * wanted, "{rule}: {found} instead of {wanted}, {at:?}");
        }
    }
}
