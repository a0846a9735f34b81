//! Optional functions in a shader text.

use ltcforge_light::{LightModel, textured::Readings};

/// The additions to the shader text of a light model. The default has no additions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Additions {
    /// For tables of LTCs: functions for lobes that end at the surface. No light shines through from below.
    pub cut: bool,
    /// The factor that restores the energy of multiple bounces in metals.
    pub compensate: bool,
    /// Rectangles with pictures, and the number of texture reads per rectangle.
    pub textured: Option<Readings>,
}

/// The shader text of the model does not support this addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AdditionError {
    /// The model has nothing to cut, because no light shines through from below.
    #[error("--cut needs model ltc or ltc-formula: model {0} lets no light through from below the surface")]
    NothingBelow(LightModel),
    /// The model has no functions for pictures.
    #[error("--textured needs model normals, ltc or ltc-formula: model {0} has no lights with pictures")]
    NoPictures(LightModel),
}

/// For models with pictures on rectangles: the prefix of the model's names, and the type of its lobe.
pub(super) fn pictured(model: LightModel) -> Option<[&'static str; 2]> {
    match model {
        LightModel::Normals => Some(["normals", "NormalsView"]),
        LightModel::Ltc | LightModel::LtcFormula => Some(["ltc", "LtcInverse"]),
        LightModel::Sg | LightModel::Asg => None,
    }
}

impl Additions {
    /// Checks that the model supports these additions.
    ///
    /// # Errors
    /// [`AdditionError`] for `cut` with a model other than LTCs, and for `textured` with a model without pictures.
    pub fn check(self, model: LightModel) -> Result<(), AdditionError> {
        if self.cut && !model.is_of_ltcs() {
            return Err(AdditionError::NothingBelow(model));
        }
        if self.textured.is_some() && pictured(model).is_none() {
            return Err(AdditionError::NoPictures(model));
        }
        Ok(())
    }
}
