//! Optional functions for a shader text: their files, calls and descriptions.

use super::{Additions, Lights, LitBy, Reading};
use ltcforge_light::LightModel;

const CUT: &str = "\
LIGHT FROM BELOW
  ltc_cut_rectangle{shapes}: the same arguments,
      but the lobe ends at the surface, so no light shines through from below. Without the cut, up to a fifth of a light
      below the surface shines through.
";
const CUT_POLYGONS: &str = ", ltc_cut_polygon";
const CUT_SHAPES: &str = ", ltc_cut_polygon, ltc_cut_disk, ltc_cut_sphere, ltc_cut_tube, ltc_cut_line";

const COMPENSATION: &str = "\
ENERGY
  {call}
      once for a point and view: a factor on the reflected light of a metal with reflectance f0. It restores the energy
      that shadowing loses. White metal then reflects all light of a white sky.
";

const POLYGONS_CUT: &str =
    "    let cut = ltc_cut_rectangle(inverse, corners, true) + ltc_cut_polygon(inverse, vertices, 4u, true);
";
const RECTANGLES_CUT: &str = "    let cut = ltc_cut_rectangle(inverse, corners, true);\n";
const SHAPES_CUT: &str = "    let cut_disk = ltc_cut_disk(inverse, vertices[0], vertices[1], vertices[2], true);
    let cut_sphere = ltc_cut_sphere(inverse, vertices[0], 1.0);
    let cut_tube = ltc_cut_tube(inverse, vertices[0], vertices[1], 1.0);
    let cut_line = ltc_cut_line(inverse, vertices[0], vertices[1], 1.0);
";

/// The call of a model's compensation factor, and the files that define it.
fn compensation(model: LightModel) -> (&'static str, &'static [&'static str]) {
    match model {
        LightModel::Ltc => ("ltc_compensation(lobe, f0)", &["ltc_compensation"]),
        LightModel::LtcFormula => ("ltc_formula_compensation(lobe, f0)", &["ltc_formula_compensation"]),
        LightModel::Normals => ("normals_compensation(view, f0)", &["ltc_albedo", "normals_compensation"]),
        LightModel::Sg | LightModel::Asg => {
            ("gaussians_compensation(alpha_x, alpha_y, wo, f0)", &["ltc_albedo", "gaussians_compensation"])
        }
    }
}

impl LitBy {
    /// The files that the additions need.
    pub(super) fn added_files(self, lights: Lights) -> Vec<&'static str> {
        let Additions { cut, compensate, .. } = self.additions();
        let cut: &[&str] = match (cut, lights) {
            (false, _) => &[],
            (true, Lights::Polygons) => &["ltc_cut"],
            (true, Lights::Rectangles) => &["ltc_light", "ltc_cut"],
            (true, Lights::All) => &["ltc_cut", "ltc_cut_shapes"],
        };
        [cut, if compensate { compensation(self.model()).1 } else { &[] }].concat()
    }

    /// A fragment shader named `ltc_included` that calls every function of the shader text.
    #[must_use]
    pub fn caller(self, reading: Reading, lights: Lights) -> String {
        let Additions { cut, compensate, .. } = self.additions();
        let mut calls = match (cut, lights) {
            (false, _) => String::new(),
            (true, Lights::Polygons) => POLYGONS_CUT.to_owned(),
            (true, Lights::Rectangles) => RECTANGLES_CUT.to_owned(),
            (true, Lights::All) => [POLYGONS_CUT, SHAPES_CUT].concat(),
        };
        if compensate {
            let call = compensation(self.model()).0.replace("alpha_x, alpha_y, wo", "0.5, 0.5, vec3(0.0, 0.0, 1.0)");
            calls += &["    let factor = ", &call.replace("f0", "vec3(1.0)"), ";\n"].concat();
        }
        if self.reads_materials() {
            calls += "    let material = ltc_lookup_material(0u, vec3(0.0, 0.0, 1.0)).fresnel;\n";
        }
        calls += &self.textured_call();
        (self.shader().caller)(reading, lights).replacen("    return ", &format!("{calls}    return "), 1)
    }

    /// The comment of a shader text. The additions are described before its last part.
    #[must_use]
    pub fn explained(self, comment: &str, lights: Lights) -> String {
        let Additions { cut, compensate, .. } = self.additions();
        let mut about = String::new();
        if cut {
            let shapes = match lights {
                Lights::All => CUT_SHAPES,
                Lights::Polygons => CUT_POLYGONS,
                Lights::Rectangles => "",
            };
            about += &CUT.replace("{shapes}", shapes);
            about += "\n";
        }
        if compensate {
            about += &COMPENSATION.replace("{call}", compensation(self.model()).0);
            about += "\n";
        }
        if self.additions().textured.is_some() {
            about += &self.about_textured();
            about += "\n";
        }
        let end = ["\n// CHECK", "\n// TABLE"].iter().filter_map(|head| comment.rfind(head)).max();
        let (before, behind) = comment.split_at(end.map_or(comment.len(), |end| end + 1));
        format!("{before}{}{behind}", super::commented(&about))
    }
}
