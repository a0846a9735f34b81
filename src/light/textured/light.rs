//! A rectangular light with a picture. Computes the reflected light of each channel by `normals`, by a table, and
//! exactly.

use glam::DVec3;

use super::{
    LightImage, LightPyramid, Reading, Readings,
    cosine::CosineLobe,
    ggx::GgxLobe,
    readings::{colour, readings},
    rectangle::Rectangle,
};
use crate::{
    ClosedForm, CosineSpace, LightError, NormalsRule, PolygonLight,
    ltc::{FormulaLobe, TableUse, by_table_as, covered_in},
    normals::{self, View},
    rules::surface_and_view,
    truth::{texel_lights, truth_within},
};
use ltcforge_fit::{
    Configuration, Ltc, Sides, Table,
    math::{Scalar, Triple, from_row_major},
};

/// The light of a rectangle of radiance one that GGX reflects, as in [`normals::reflected`], and the readings of its
/// picture. Returns no readings if nothing is reflected.
///
/// Domain: as for [`normals::reflected`], with the corners of a rectangle. The picture begins at the first corner; u
/// goes to the second, v to the fourth.
#[must_use]
pub fn normals_readings<T: Scalar>(
    alpha: [T; 2],
    wo: Triple<T>,
    corners: &[Triple<T>; 4],
    sides: Sides,
    (rule, number): (NormalsRule, Readings),
) -> ([T; 2], Vec<Reading<T>>) {
    let Some(region) = normals::region(alpha, wo, corners, sides, rule) else {
        return ([T::ZERO; 2], Vec::new());
    };
    let reflected = region.reflected(&rule.network());
    let view = View::new(alpha, wo);
    let rectangle = Rectangle::new(corners);
    let lobe = GgxLobe::new(&view, &rectangle);
    let bump = lobe.bump(rectangle.met(view.reflected(region.flux)));
    (reflected, readings(&lobe, &rectangle, &bump, number))
}

/// The readings of a picture on a rectangle for an LTC. Domain: corners as for [`normals_readings`].
#[must_use]
pub fn ltc_readings<T: Scalar>(space: &CosineSpace<T>, corners: &[Triple<T>; 4], number: Readings) -> Vec<Reading<T>> {
    let rectangle = Rectangle::new(corners);
    let lobe = CosineLobe::new(space, &rectangle);
    readings(&lobe, &rectangle, &lobe.bump(), number)
}

/// A rectangle with a picture, relative to the shaded point.
#[derive(Debug, Clone, PartialEq)]
pub struct TexturedLight(PolygonLight);

/// The tolerance for right angles and for equal opposite sides, relative to the lengths of the sides.
const SQUARE: f64 = 1e-4;

impl TexturedLight {
    /// Creates a light. The picture's first texel is at the first corner, its rows go to the second corner, and its
    /// columns to the fourth. Seen from the lit side, the picture is upright if the corners begin at its upper left.
    ///
    /// # Errors
    /// [`LightError::NoRectangle`] for other polygons.
    pub fn new(light: PolygonLight) -> Result<Self, LightError> {
        let &[a, b, c, d] = light.vertices() else { return Err(LightError::NoRectangle) };
        let (x, y) = (b - a, d - a);
        let (width, height) = (x.length(), y.length());
        let is_square = x.dot(y).abs() <= SQUARE * width * height;
        let is_closed = (a + x + y - c).length() <= SQUARE * width.min(height);
        if width > 0.0 && height > 0.0 && is_square && is_closed {
            Ok(Self(light))
        } else {
            Err(LightError::NoRectangle)
        }
    }

    /// The rectangle.
    #[must_use]
    pub fn polygon(&self) -> &PolygonLight {
        &self.0
    }

    /// The lengths of its sides, along the picture's rows and columns, in any unit.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        let corners = self.0.vertices();
        [corners[1].distance(corners[0]), corners[3].distance(corners[0])]
    }

    fn corners(&self) -> [Triple<f64>; 4] {
        [0, 1, 2, 3].map(|i| self.0.vertices()[i].to_array())
    }

    /// The light that GGX reflects, by model `normals`.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
    pub fn by_normals(
        &self,
        at: &Configuration,
        picture: &LightPyramid,
        how: (NormalsRule, Readings),
    ) -> Result<TexturedReflection, LightError> {
        let (alpha, wo) = surface_and_view(at)?;
        let (parts, readings) = normals_readings(alpha, wo.to_array(), &self.corners(), self.0.sides(), how);
        let colour = colour(&readings, picture);
        let [energy, fresnel] = parts.map(|part| colour.map(|channel| part * channel));
        Ok(TexturedReflection { energy, fresnel })
    }

    /// The light that a table's surface reflects. If entries have two lobes, the readings for the Fresnel term belong
    /// to the second lobe.
    ///
    /// # Errors
    /// The errors of [`crate::by_table`], and [`LightError::NoLtc`] for a table of Gaussians.
    pub fn by_table(
        &self,
        table: &Table,
        at: &Configuration,
        picture: &LightPyramid,
        (used, number): (TableUse, Readings),
    ) -> Result<TexturedReflection, LightError> {
        if table.lobe.gaussian().is_some() {
            return Err(LightError::NoLtc);
        }
        let light = by_table_as(table, at, &self.0, used)?;
        let found = table.lookup(at);
        let colour_of = |matrix: &[f64; 9]| {
            let ltc = Ltc::new(from_row_major(matrix)).ok_or(LightError::Singular)?;
            Ok(colour(&ltc_readings(&CosineSpace::from(&ltc), &self.corners(), number), picture))
        };
        let first = colour_of(&found.matrix)?;
        let second = found.second.as_ref().map(colour_of).transpose()?.unwrap_or(first);
        Ok(TexturedReflection {
            energy: first.map(|channel| light.energy * channel),
            fresnel: second.map(|channel| light.fresnel * channel),
        })
    }

    /// The light that GGX reflects, by a model without a table: an LTC, whose lobe is that of a material with this
    /// reflectance at normal and at grazing incidence, or model `normals`.
    ///
    /// # Errors
    /// [`LightError::Domain`] as for [`Self::by_normals`].
    pub fn by_form(
        &self,
        form: ClosedForm,
        at: &Configuration,
        picture: &LightPyramid,
        (fresnel, number): ([f64; 2], Readings),
    ) -> Result<TexturedReflection, LightError> {
        let Some(FormulaLobe { space, parts }) = form.lobe(at, fresnel)? else {
            return self.by_normals(at, picture, (form.rule(), number));
        };
        let covered = covered_in(space, (&self.0).into(), form.is_cut());
        let colour = colour(&ltc_readings(&space, &self.corners(), number), picture);
        let [energy, fresnel] = parts.map(|part| colour.map(|channel| part * covered * channel));
        Ok(TexturedReflection { energy, fresnel })
    }

    /// The exact light that GGX reflects: the sum of the integrals over each texel, a rectangle of one colour.
    ///
    /// # Errors
    /// [`LightError::Domain`] as for [`Self::by_normals`]. [`LightError::NotConverged`] if the sum over texels and the
    /// quadrature in the space of normals, which share no code, differ by more than ten times `tolerance`.
    pub fn truth(
        &self,
        at: &Configuration,
        image: &LightImage,
        tolerance: f64,
    ) -> Result<TexturedReflection, LightError> {
        let lights = self.texel_lights(at, [image.width(), image.height()], tolerance)?;
        Ok(TexturedReflection::of_texels(lights.iter().zip(image.texels())))
    }

    /// The light of every texel of a picture of a given size, row by row, for a Fresnel factor of one and weighted by
    /// Schlick's fifth power.
    ///
    /// # Errors
    /// The errors of [`Self::truth`].
    pub fn texel_lights(
        &self,
        at: &Configuration,
        size: [usize; 2],
        tolerance: f64,
    ) -> Result<Vec<[f64; 2]>, LightError> {
        let (alpha, wo) = surface_and_view(at)?;
        let whole = truth_within(0.1 * tolerance, at, &self.0)?;
        let [corner, x, _, y] = self.corners().map(DVec3::from_array);
        let is_lit = self.0.sides() == Sides::Two || (x - corner).cross(y - corner).dot(corner) > 0.0;
        if !is_lit {
            return Ok(vec![[0.0; 2]; size[0] * size[1]]);
        }
        let lights = texel_lights(alpha, wo, [corner, x - corner, y - corner], size, tolerance);
        let sum: f64 = lights.iter().map(|[energy, _]| energy).sum();
        let off = (sum - whole.energy).abs();
        if off <= 10.0 * tolerance { Ok(lights) } else { Err(LightError::NotConverged { off }) }
    }
}

/// The light of a picture that a surface reflects, by channel: red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedReflection {
    /// The light for a Fresnel factor of one.
    pub energy: [f64; 3],
    /// The light weighted by Schlick's `(1 - wo . h)^5`.
    pub fresnel: [f64; 3],
}

impl TexturedReflection {
    /// The sum over texels, each with its light as returned by [`TexturedLight::texel_lights`].
    #[must_use]
    pub fn of_texels<'a>(texels: impl Iterator<Item = (&'a [f64; 2], &'a [f32; 3])>) -> Self {
        let mut sum = Self { energy: [0.0; 3], fresnel: [0.0; 3] };
        for ([energy, fresnel], texel) in texels {
            for (channel, value) in texel.iter().enumerate() {
                sum.energy[channel] += energy * f64::from(*value);
                sum.fresnel[channel] += fresnel * f64::from(*value);
            }
        }
        sum
    }

    /// The light with Schlick's Fresnel factor, `f0` at normal and `f90` at grazing incidence.
    #[must_use]
    pub fn schlick(&self, f0: f64, f90: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| f0 * (self.energy[i] - self.fresnel[i]) + f90 * self.fresnel[i])
    }
}
