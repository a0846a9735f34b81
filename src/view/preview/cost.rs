//! The cost of rendering a picture.

use super::{
    ScenePicture,
    scene::{COMPARED, Mode, Scene},
};
use ltcforge_light::LightModel;

/// The greatest cost per pixel of a model, in samples of the reference.
pub(super) fn most_cost() -> u32 {
    LightModel::ALL.iter().map(|model| model.cost().max(model.table_cost())).max().unwrap_or(1)
}

impl Scene {
    /// The cost of the picture in samples of the reference. It is the number of pixels times the cost of a pixel: its
    /// samples if the mode shows the reference, plus the cost of each shown model. A picture on the light doubles the
    /// cost of a model. A lobe costs as much as light by the table. The pixels include the background.
    #[must_use]
    pub fn cost(&self) -> f64 {
        let times = if self.picture == ScenePicture::None { 1 } else { 2 };
        let (reference, model) = (self.spp, times * self.model.cost());
        let of_a_pixel = match self.mode {
            Mode::Ltc => model,
            Mode::Models => times * COMPARED.map(LightModel::cost).iter().sum::<u32>() + reference,
            Mode::Reference => reference,
            Mode::Difference | Mode::Strip => model + reference,
            // The CPU shades in f64.
            Mode::Shadows => 2 * (self.spp + 8),
            Mode::Lobe => 2 * LightModel::Ltc.cost(),
        };
        f64::from(self.size) * f64::from(self.size) * f64::from(of_a_pixel)
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
        let pictured = Scene { size: 100, spp: 64, picture: ScenePicture::Window, ..Scene::default() };
        assert_eq!([pictured.cost(), Scene { mode: Mode::Strip, ..pictured }.cost()], [160_000.0, 800_000.0]);
        assert_eq!(cost(Mode::Reference, 200, 64), 4.0 * cost(Mode::Reference, 100, 64));
    }
}
