//! Functions that a text to include has only where they are chosen.

use super::Lights;
use ltcforge_light::LightModel;

/// What is added to the text of a model of light; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Additions {
    /// For tables of LTCs: the same lights without what shines through from below the surface.
    pub cut: bool,
}

/// Why a model's text has no such addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("--cut is of model ltc: by model {0} nothing shines through from below the surface")]
pub struct NothingBelow(pub LightModel);

const CUT: &str = "\
LIGHT FROM BELOW
  ltc_cut_rectangle, ltc_cut_polygon{shapes} take the same arguments
      and let the lobe end at the surface: nothing shines through from below. Without them an LTC lets through up to a
      fifth of a light that lies below.
";
const CUT_SHAPES: &str = ", ltc_cut_disk, ltc_cut_sphere, ltc_cut_tube, ltc_cut_line";

const POLYGONS_CUT: &str =
    "    let cut = ltc_cut_rectangle(inverse, corners, true) + ltc_cut_polygon(inverse, vertices, 4u, true);
";
const SHAPES_CUT: &str = "    let cut_disk = ltc_cut_disk(inverse, vertices[0], vertices[1], vertices[2], true);
    let cut_sphere = ltc_cut_sphere(inverse, vertices[0], 1.0);
    let cut_tube = ltc_cut_tube(inverse, vertices[0], vertices[1], 1.0);
    let cut_line = ltc_cut_line(inverse, vertices[0], vertices[1], 1.0);
";

impl Additions {
    /// Whether the text of a model can have them.
    ///
    /// # Errors
    /// [`NothingBelow`] for a model that nothing shines through.
    pub fn check(self, model: LightModel) -> Result<(), NothingBelow> {
        if self.cut && model != LightModel::Ltc { Err(NothingBelow(model)) } else { Ok(()) }
    }

    /// The files of the functions.
    pub(super) fn files(self, lights: Lights) -> &'static [&'static str] {
        match (self.cut, lights) {
            (false, _) => &[],
            (true, Lights::Polygons) => &["ltc_cut"],
            (true, Lights::All) => &["ltc_cut", "ltc_cut_shapes"],
        }
    }

    /// The caller of a text's functions that calls these too.
    #[must_use]
    pub fn called(self, caller: &str, lights: Lights) -> String {
        let calls = match (self.cut, lights) {
            (false, _) => String::new(),
            (true, Lights::Polygons) => POLYGONS_CUT.to_owned(),
            (true, Lights::All) => [POLYGONS_CUT, SHAPES_CUT].concat(),
        };
        caller.replacen("    return ", &format!("{calls}    return "), 1)
    }

    /// The comment of a text with what these functions are, before its last part.
    #[must_use]
    pub fn explained(self, comment: &str, lights: Lights) -> String {
        let about = if self.cut {
            let shapes = if lights == Lights::All { CUT_SHAPES } else { "" };
            super::commented(&CUT.replace("{shapes}", shapes))
        } else {
            String::new()
        };
        let end = ["\n// CHECK", "\n// TABLE"].iter().filter_map(|head| comment.rfind(head)).max();
        let (before, behind) = comment.split_at(end.map_or(comment.len(), |end| end + 1));
        let gap = if about.is_empty() { "" } else { "//\n" };
        format!("{before}{about}{gap}{behind}")
    }
}
