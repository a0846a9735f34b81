//! How much work a picture is.

use super::scene::{Mode, Scene};
use ltcforge_light::LightModel;

/// The cost of light by the table, in samples of the reference.
pub(super) const TABLE_COST: u32 = 8;
/// The cost of light by the closed form in the space of normals.
pub(super) const NORMALS_COST: u32 = 10;
/// The cost of light by a Gaussian in closed form, and by one of a table.
pub(super) const GAUSSIAN_COST: u32 = 6;
pub(super) const GAUSSIAN_TABLE_COST: u32 = 10;

impl Scene {
    /// How much work the picture is, in samples of the reference: pixels times samples where its mode shows the
    /// reference, plus pixels times eight where it shows the table, ten the closed form and six a Gaussian. A lobe costs as
    /// much as light by the table. The pixels are those of the whole panel: the background, which costs little, is not left
    /// out.
    #[must_use]
    pub fn cost(&self) -> f64 {
        let (table, reference) = (f64::from(TABLE_COST), f64::from(self.spp));
        let normals = f64::from(NORMALS_COST);
        let model = match self.model {
            LightModel::Ltc => table,
            LightModel::Normals => normals,
            LightModel::Sg | LightModel::Asg => f64::from(GAUSSIAN_COST),
        };
        let of_a_pixel = match self.mode {
            Mode::Ltc => model,
            Mode::Models => table + normals + reference,
            Mode::Reference => reference,
            Mode::Difference | Mode::Strip => model + reference,
            Mode::Lobe => 2.0 * table,
        };
        f64::from(self.size) * f64::from(self.size) * of_a_pixel
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_cost_only_where_the_reference_is_shown() {
        let cost = |mode, size, spp| Scene { size, spp, mode, ..Scene::default() }.cost();
        assert_eq!(cost(Mode::Ltc, 100, 1), 80_000.0);
        assert_eq!(cost(Mode::Ltc, 100, 4096), 80_000.0);
        assert_eq!(cost(Mode::Reference, 100, 64), 640_000.0);
        assert_eq!(cost(Mode::Strip, 100, 64), 720_000.0);
        assert_eq!(cost(Mode::Difference, 100, 64), 720_000.0);
        assert_eq!(cost(Mode::Lobe, 100, 4096), 160_000.0);
        for (model, of_a_pixel) in [(LightModel::Normals, 10.0), (LightModel::Sg, 6.0), (LightModel::Asg, 6.0)] {
            let cost = |mode| Scene { size: 100, spp: 64, mode, model, ..Scene::default() }.cost();
            assert_eq!([cost(Mode::Ltc), cost(Mode::Strip)], [of_a_pixel, of_a_pixel + 64.0].map(|cost| 1e4 * cost));
        }
        assert_eq!(cost(Mode::Reference, 200, 64), 4.0 * cost(Mode::Reference, 100, 64));
    }
}
