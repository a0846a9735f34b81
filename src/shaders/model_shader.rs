//! The parts of the shader of a model of light.

use super::{Language, Lights, Namespace, Reading};
use ltcforge_fit::Layout;

/// The shader of a model of light.
pub struct ModelShader {
    /// The beginning of its names.
    pub(super) prefix: &'static str,
    /// The files of its functions, beside those that all models share and those that read tables.
    pub(super) functions: fn(Lights) -> &'static [&'static str],
    /// The file of the program that shows how to call them, and the name of its entry point.
    pub example: &'static str,
    /// A fragment shader that calls every function, named `ltc_included`.
    pub caller: fn(Reading, Lights) -> String,
    /// The comment at the top of the program, in lines that begin with `//`; of a formula it is the same for all
    /// layouts.
    pub(super) program_comment: fn(Language, Layout) -> String,
    /// The comment at the top of the text to include, likewise.
    pub(super) include_comment: fn(Language, Layout, Reading, Lights, &Namespace) -> String,
}

/// A fragment shader that looks up what `lookup` says, and goes on as `calls` say with the vertices of a light.
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
