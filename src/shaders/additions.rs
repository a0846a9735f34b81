//! Optional functions of a text to include.

use ltcforge_light::{LightModel, textured::Readings};

/// The additions to the text of a light model; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Additions {
    /// For tables of LTCs: functions whose lobes end at the surface, so no light shines through from below.
    pub cut: bool,
    /// The factor by which metals gain the energy of multiple bounces.
    pub compensate: bool,
    /// Rectangles with pictures, and the number of readings of each.
    pub textured: Option<Readings>,
}

/// The model's text does not have this addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AdditionError {
    /// No light shines through from below.
    #[error("--cut needs model ltc: model {0} lets no light through from below the surface")]
    NothingBelow(LightModel),
    /// The model has no functions for pictures.
    #[error("--textured needs model normals or ltc: model {0} has no lights with pictures")]
    NoPictures(LightModel),
}

/// The prefix of a model's names and the type of its lobe, for models with pictures on rectangles.
pub(super) fn pictured(model: LightModel) -> Option<[&'static str; 2]> {
    match model {
        LightModel::Normals => Some(["normals", "NormalsView"]),
        LightModel::Ltc => Some(["ltc", "LtcInverse"]),
        LightModel::Sg | LightModel::Asg => None,
    }
}

impl Additions {
    /// Checks that the text of a model can have these additions.
    ///
    /// # Errors
    /// [`AdditionError`] for `cut` with a model other than LTCs, and for `textured` with a model without pictures.
    pub fn check(self, model: LightModel) -> Result<(), AdditionError> {
        if self.cut && model != LightModel::Ltc {
            return Err(AdditionError::NothingBelow(model));
        }
        if self.textured.is_some() && pictured(model).is_none() {
            return Err(AdditionError::NoPictures(model));
        }
        Ok(())
    }
}
