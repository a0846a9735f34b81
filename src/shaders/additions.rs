//! Functions that a text to include has only where they are chosen.

use ltcforge_light::{LightModel, textured::Readings};

/// What is added to the text of a model of light; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Additions {
    /// For tables of LTCs: the same lights without what shines through from below the surface.
    pub cut: bool,
    /// The factor by which metals reflect more than one bounce tells.
    pub compensate: bool,
    /// Rectangles with pictures, each read so often.
    pub textured: Option<Readings>,
}

/// Why a model's text has no such addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AdditionError {
    /// Nothing shines through from below.
    #[error("--cut is of model ltc: by model {0} nothing shines through from below the surface")]
    NothingBelow(LightModel),
    /// No kernel of its lobe is known.
    #[error("--textured is of models normals and ltc: model {0} lights by no pictures")]
    NoPictures(LightModel),
}

/// The beginning of a model's names, and the type of its lobe, where rectangles with pictures can be lit by it.
pub(super) fn pictured(model: LightModel) -> Option<[&'static str; 2]> {
    match model {
        LightModel::Normals => Some(["normals", "NormalsView"]),
        LightModel::Ltc => Some(["ltc", "LtcInverse"]),
        LightModel::Sg | LightModel::Asg => None,
    }
}

impl Additions {
    /// Whether the text of a model can have them.
    ///
    /// # Errors
    /// [`AdditionError`] for a model that nothing shines through, and for one that lights by no pictures.
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
