//! Functions that a text to include has only where they are chosen.

use ltcforge_light::LightModel;

/// What is added to the text of a model of light; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Additions {
    /// For tables of LTCs: the same lights without what shines through from below the surface.
    pub cut: bool,
    /// The factor by which metals reflect more than one bounce tells.
    pub compensate: bool,
}

/// Why a model's text has no such addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("--cut is of model ltc: by model {0} nothing shines through from below the surface")]
pub struct NothingBelow(pub LightModel);

impl Additions {
    /// Whether the text of a model can have them.
    ///
    /// # Errors
    /// [`NothingBelow`] for a model that nothing shines through.
    pub fn check(self, model: LightModel) -> Result<(), NothingBelow> {
        if self.cut && model != LightModel::Ltc { Err(NothingBelow(model)) } else { Ok(()) }
    }
}
