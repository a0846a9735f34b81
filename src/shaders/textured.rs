//! The shader text for lights with pictures: the reads, which all models share under different names, and a model's
//! lobe.

use super::{Additions, Bound, LitBy, Reading, additions::pictured, namespace::prefixed};
use ltcforge_light::{LightModel, textured::Readings};

/// The description in the text to include.
const ABOUT: &str = "\
PICTURES ON LIGHTS
  {own}_textured_rectangle({view}, corners, two_sided, picture, base)
      {result}
      The picture's upper left is at the first corner; rows run to the second corner, columns to the fourth. All four are
      read. picture is a layer of {own}_pictures, a 2D array with all levels from ltcforge light-texture. base is
      log2(sqrt(width height)) - 1 of the first level; its texels should be square on the light.
      {own}_picture_sampler is linear between texels and levels and clamps to the edge.
      The constant {constant} is the number of readings of a picture: {number}.
  {own}_profile_rectangle({view}, corners, two_sided, picture)
      the same for a lamp with an IES profile, whose radiance depends on the direction. picture is a layer with all
      levels from ltcforge light-texture for the profile. Angles around the lamp's axis run from the side towards the
      second corner to the side towards the fourth.
";

/// The bindings of the pictures and their sampler. They follow the bindings of the table.
fn bindings(lit_by: LitBy, reading: Reading) -> [u32; 2] {
    let first = match (lit_by.layout(), reading.bound) {
        (None, _) => 0,
        (Some(_), Bound::Array) => 3,
        (Some(_), Bound::Volumes) => 5,
    };
    [first, first + 1]
}

impl LitBy {
    /// The text for pictures on lights. Empty if pictures are not selected.
    pub(super) fn textured(self, reading: Reading) -> String {
        let (Some(number), Some([own, lobe])) = (self.additions().textured, pictured(self.model())) else {
            return String::new();
        };
        let [pictures, sampler] = bindings(self, reading);
        let shared = ltcforge_wgsl::TEXTURED
            .replace("@binding(0)", &format!("@binding({pictures})"))
            .replace("@binding(1)", &format!("@binding({sampler})"))
            .replace("TEXTURED_READINGS: u32 = 4u", &format!("TEXTURED_READINGS: u32 = {number}u"))
            .replace("TexturedLobe", lobe);
        let shared = prefixed(&shared, "textured", own);
        let of_model = match self.model() {
            LightModel::Normals => ltcforge_wgsl::NORMALS_TEXTURED.to_owned(),
            _ if self.additions().cut => {
                ltcforge_wgsl::LTC_TEXTURED.replace("= ltc_rectangle(", "= ltc_cut_rectangle(")
            }
            _ => ltcforge_wgsl::LTC_TEXTURED.to_owned(),
        };
        format!("\n{shared}\n{of_model}")
    }

    /// The text for pictures in the preview. The preview declares textures, sampler and number of texture reads for all
    /// models.
    pub(super) fn previewed_pictures(self) -> String {
        let additions = Additions { textured: Some(Readings::ALL[0]), ..Additions::default() };
        let (Some([own, _]), Ok(lit_by)) = (pictured(self.model()), self.with(additions)) else { return String::new() };
        let text = lit_by.textured(Reading::default());
        let declares = |line: &&str| line.starts_with("@group") || line.starts_with("const ");
        let text: Vec<&str> = text.lines().filter(|line| !declares(line)).collect();
        [("_pictures", "light_pictures"), ("_picture_sampler", "light_picture_sampler")]
            .into_iter()
            .fold(text.join("\n"), |text, (name, shared)| text.replace(&format!("{own}{name}"), shared))
            .replace(&format!("{}_READINGS", own.to_uppercase()), "light_readings")
    }

    /// Calls of the added functions.
    pub(super) fn textured_call(self) -> String {
        let (Some(_), Some([own, _])) = (self.additions().textured, pictured(self.model())) else {
            return String::new();
        };
        let of = if self.model().is_of_ltcs() { "inverse" } else { "view" };
        format!(
            "    let textured = {own}_textured_rectangle({of}, corners, true, 0u, 8.0);
    let lamp = {own}_profile_rectangle({of}, corners, true, 1u);\n"
        )
    }

    /// The description in the comment of a shader text.
    pub(super) fn about_textured(self) -> String {
        let (Some(number), Some([own, _])) = (self.additions().textured, pictured(self.model())) else {
            return String::new();
        };
        let (of, result) = match self.model() {
            LightModel::Ltc | LightModel::LtcFormula => {
                ("inverse", "covered, as from ltc_rectangle, and colour, to use as the radiance of the light.")
            }
            _ => ("view", "parts, as from normals_rectangle, and colour, to use as the radiance of the light."),
        };
        ABOUT
            .replace("{own}", own)
            .replace("{view}", of)
            .replace("{result}", result)
            .replace("{constant}", &format!("{}_READINGS", own.to_uppercase()))
            .replace("{number}", Readings::name(number))
    }
}
