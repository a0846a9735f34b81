//! What the shader of each model of light is made of.

use super::{
    Language, Lights, LitBy, Place, Reading, gaussians_header, gaussians_table_header, header, normals_header,
};
use ltcforge_fit::Layout;
use ltcforge_light::LightModel;

/// The shader of a model of light.
pub struct ModelShader {
    /// What its names begin with.
    pub(super) prefix: &'static str,
    /// The files of its functions, beside those that all models share and those that read tables.
    pub(super) functions: fn(Lights) -> &'static [&'static str],
    /// The file of the program that shows how to call them, and the name of its entry point.
    pub example: &'static str,
    /// A fragment shader that calls every function, named `ltc_included`.
    pub caller: fn(Lights) -> String,
    /// The comment at its top.
    pub(super) comment: Comment,
}

/// The comment at the top of a program and of a text to include, in lines that begin with `//`.
pub(super) enum Comment {
    /// Of a formula.
    Formula { program: fn(Language) -> String, included: fn() -> String },
    /// Of what reads tables of a layout.
    Table { program: fn(Language, Layout) -> String, included: fn(Language, Layout, Reading, Lights, &Place) -> String },
}

impl LitBy {
    /// What the shader is made of.
    #[must_use]
    pub fn shader(self) -> &'static ModelShader {
        match (self.model(), self.layout()) {
            (LightModel::Ltc, _) => &header::SHADER,
            (LightModel::Normals, _) => &normals_header::SHADER,
            (LightModel::Sg | LightModel::Asg, None) => &gaussians_header::SHADER,
            (LightModel::Sg | LightModel::Asg, Some(_)) => &gaussians_table_header::SHADER,
        }
    }

    /// The comment at the top of the program in `language`.
    #[must_use]
    pub fn comment(self, language: Language) -> String {
        match (&self.shader().comment, self.layout()) {
            (Comment::Formula { program, .. }, _) => program(language),
            (Comment::Table { program, .. }, Some(layout)) => program(language, layout),
            (Comment::Table { .. }, None) => unreachable!("{} reads a table without a layout", self.model()),
        }
    }

    /// The comment at the top of the text to include.
    #[must_use]
    pub fn include_comment(self, language: Language, reading: Reading, lights: Lights, place: &Place) -> String {
        match (&self.shader().comment, self.layout()) {
            (Comment::Formula { included, .. }, _) => included(),
            (Comment::Table { included, .. }, Some(layout)) => included(language, layout, reading, lights, place),
            (Comment::Table { .. }, None) => unreachable!("{} reads a table without a layout", self.model()),
        }
    }
}
