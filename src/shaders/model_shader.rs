//! The parts of a light model's shader.

use super::{Language, Lights, Namespace, Reading};
use ltcforge_fit::Layout;

/// The shader of a light model.
pub struct ModelShader {
    /// The prefix of the shader's names.
    pub(super) prefix: &'static str,
    /// The files of its functions. Files that all models share and files that read tables are not included.
    pub(super) functions: fn(Lights) -> &'static [&'static str],
    /// The file of the example program. It has the same name as the entry point.
    pub example: &'static str,
    /// A fragment shader named `ltc_included` that calls every function.
    pub caller: fn(Reading, Lights) -> String,
    /// The comment at the top of the program, in lines that start with `//`. Models without tables ignore the layout.
    pub(super) program_comment: fn(Language, Layout) -> String,
    /// The comment at the top of the shader text, in lines that start with `//`.
    pub(super) include_comment: fn(Language, Layout, Reading, Lights, &Namespace) -> String,
}

/// A fragment shader: the statements `lookup`, the vertices of a light, and the statements `calls`.
pub(super) fn caller(lookup: &str, calls: &str) -> String {
    format!(
        "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {{
    {lookup}
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
{calls}}}
"
    )
}
