//! The picture of `light --texture`, read once and prefiltered for each shape of light. `preview --light-texture` also
//! reads it.

use std::path::Path;

use super::{CommandFailure, file_failure, light_args::LightArgs, usage};
use ltcforge_files::bounded::read_named;
use ltcforge_fit::{BrdfKind, BrdfModel, Configuration, Table};
use ltcforge_light::{
    AnyLight, ClosedForm, LightError, LightModel, LightShape, TableUse,
    textured::{LightImage, LightPyramid, Readings, TexturedLight, TexturedReflection},
};
use ltcforge_textures::LightPicture;

/// Maximum size of a picture file.
pub(super) const PICTURE_LIMIT_BYTES: u64 = 1 << 28;
/// The tolerance of `--truth`.
const TRUTH_TOLERANCE: f64 = 1e-5;

/// A picture, and its pyramid for the shape of the last light.
pub(super) struct Picture {
    image: LightImage,
    pyramid: Option<([usize; 2], LightPyramid)>,
    number: Readings,
    form: Option<ClosedForm>,
    used: TableUse,
    fresnel: [f64; 2],
}

impl Picture {
    /// Reads the picture of `--texture`; `None` without one. An error lists all options that textured lights do not
    /// support.
    pub(super) fn of(args: &LightArgs, brdf: &BrdfModel) -> Result<Option<Self>, CommandFailure> {
        let Some(path) = &args.texture else { return Ok(None) };
        let mut faults = Vec::new();
        if args.light != LightShape::Polygon {
            faults.push(format!("needs rectangles, not {}: leave out --light", args.light));
        }
        if !args.model.has_pictures() {
            let models = LightModel::names_of(LightModel::has_pictures);
            faults.push(format!("works with models {models}, not {}", args.model));
        }
        for (name, is_given) in [("--f82", args.f82.is_some()), ("--blend", args.blend)] {
            if is_given {
                faults.push(format!("{name} does not apply to textured lights: leave it out"));
            }
        }
        if args.truth && brdf.kind() != BrdfKind::Ggx {
            faults.push(format!("--truth needs a table of brdf ggx, not {brdf}: leave it out"));
        }
        if !faults.is_empty() {
            return Err(usage(format!("--texture: {}", faults.join("; "))));
        }
        let number = args.readings.unwrap_or(Readings::ALL[0]);
        Ok(Some(Self {
            image: read_picture(path)?,
            pyramid: None,
            number,
            form: args.model.closed_form(args.rule).map(|form| form.with_cut(args.cut)),
            used: TableUse { cut: args.cut, blend: false },
            fresnel: args.f0.map_or([1.0; 2], |f0| [f0, args.f90]),
        }))
    }

    /// The reflected light of each channel, by the table or by a model without a table.
    pub(super) fn reflected(
        &mut self,
        table: Option<&Table>,
        at: &Configuration,
        light: &AnyLight,
    ) -> Result<[f64; 3], LightError> {
        let light = rectangle(light)?;
        let size = self.image.square_size(light.size());
        if self.pyramid.as_ref().is_none_or(|(known, _)| *known != size) {
            self.pyramid = Some((size, LightPyramid::new(&self.image.resampled(size))));
        }
        let Some((_, pyramid)) = &self.pyramid else { return Err(LightError::NoRectangle) };
        let found = match (table, self.form) {
            (Some(table), _) => light.by_table(table, at, pyramid, (self.used, self.number))?,
            (None, Some(form)) => light.by_form(form, at, pyramid, (self.fresnel, self.number))?,
            (None, None) => return Err(LightError::NoLtc),
        };
        Ok(self.with_fresnel(&found))
    }

    /// The true reflected light of each channel, by quadrature.
    pub(super) fn truth(&self, at: &Configuration, light: &AnyLight) -> Result<[f64; 3], LightError> {
        Ok(self.with_fresnel(&rectangle(light)?.truth(at, &self.image, TRUTH_TOLERANCE)?))
    }

    fn with_fresnel(&self, found: &TexturedReflection) -> [f64; 3] {
        found.schlick(self.fresnel[0], self.fresnel[1])
    }
}

fn rectangle(light: &AnyLight) -> Result<TexturedLight, LightError> {
    match light {
        AnyLight::Polygon(light) => TexturedLight::new(light.clone()),
        AnyLight::Shaped(_) => Err(LightError::NoRectangle),
    }
}

/// Reads a picture file.
pub(super) fn read_picture(path: &Path) -> Result<LightImage, CommandFailure> {
    let bytes = read_named(path, PICTURE_LIMIT_BYTES).map_err(|error| file_failure(path, &error))?;
    let picture = LightPicture::decode(&bytes, None).map_err(|error| file_failure(path, &error))?;
    Ok(picture.image)
}
