//! The shader of each light model.

use super::{
    Language, Lights, LitBy, ModelShader, Namespace, Reading, formula_header, gaussians_header, gaussians_table_header,
    header, normals_header,
};
use ltcforge_fit::Layout;
use ltcforge_light::{LightModel, NormalsRule};

impl LitBy {
    /// The parts of the shader.
    #[must_use]
    pub fn shader(self) -> &'static ModelShader {
        match (self.model(), self.layout()) {
            (LightModel::Ltc, _) => &header::SHADER,
            (LightModel::LtcFormula, _) => &formula_header::SHADER,
            (LightModel::Normals, _) => normals_header::shader(self.rule().unwrap_or(NormalsRule::ALL[0])),
            (LightModel::Sg | LightModel::Asg, None) => &gaussians_header::SHADER,
            (LightModel::Sg | LightModel::Asg, Some(_)) => &gaussians_table_header::SHADER,
        }
    }

    /// The comment at the top of the program in `language`.
    #[must_use]
    pub fn comment(self, language: Language) -> String {
        (self.shader().program_comment)(language, self.layout().unwrap_or(Layout::ALL[0]))
    }

    /// The comment at the top of the shader text.
    #[must_use]
    pub fn include_comment(
        self,
        language: Language,
        reading: Reading,
        lights: Lights,
        namespace: &Namespace,
    ) -> String {
        let layout = self.layout().unwrap_or(Layout::ALL[0]);
        (self.shader().include_comment)(language, layout, reading, lights, namespace)
    }
}
