//! A shader text for light by an isotropic table without textures: the code contains the table's polynomials.

use std::fmt::Write as _;

use super::{PortError, translation::translate_functions};
use ltcforge_fit::{IsotropicFunction, Layout};
use ltcforge_shaders::{
    Additions, Language, Lights, LitBy, Namespace, Reading, commented, functions_of, head, stamped, without_textures,
};

/// The licences of the text and of a table's numbers.
const LICENCE: &str = "(MIT OR Apache-2.0) AND CC0-1.0";

/// The revision. It is raised when the light of a table changes.
const REVISION: u32 = 1;

/// The first part of the comment: description, functions and use.
const ABOUT: &str = "\
Linearly Transformed Cosines: area lights on isotropic surfaces, without a texture.

FUNCTIONS
  ltc_lookup(alpha_x, alpha_y, wo)  M, amplitude and fresnel. Pass the same GGX roughness twice. wo is the view
      direction in the tangent frame, normal +z, of unit length. M maps the clamped cosine to the lobe, in this frame.
{lights}
USE
  Call ltc_lookup and ltc_inverse once for a point and view, then one function for each light. Diffuse light is the
  albedo times the part covered with ltc_inverse of the unit matrix. There are no bindings.

TABLE
";

/// The functions in `language`, with the coefficients of `function`. The comment at the top ends with the lines
/// `about`, which describe the table. `namespace` avoids name conflicts between the texts of several tables in one
/// shader. There are no bindings.
///
/// # Errors
/// [`PortError`] for SPIR-V, which has no text to include, or for a defect of the shaders or of naga.
pub fn include_function(
    language: Language,
    function: &IsotropicFunction,
    about: &[String],
    lights: Lights,
    additions: Additions,
    namespace: &Namespace,
) -> Result<String, PortError> {
    // The shader text looks up the matrix, amplitude and Fresnel term of this layout.
    let lit_by = LitBy::from(Layout::Reflected).with(additions);
    let lit_by = lit_by.map_err(|error| PortError { language, reason: error.to_string() })?;
    let caller = lit_by.caller(Reading::default(), lights);
    let source = format!("{}{caller}", without_textures(&smooth_at(function), lights, lit_by));
    let text = translate_functions(language, &source, None)?;
    let lines = about.join("\n  ");
    let about = head(LICENCE, REVISION) + &ABOUT.replace("{lights}", functions_of(lights));
    let header = lit_by.explained(&commented(&format!("{about}  {lines}")), lights);
    let [header, text] = [&header, &text].map(|part| namespace.named(part, Layout::Reflected.into()));
    Ok(stamped(&header, &text))
}

/// The part of the shader that depends on the table: the ranges of the polynomials, and their coefficients in multiples
/// of a step.
pub(crate) fn smooth_at(function: &IsotropicFunction) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_smooth_at(&mut out, function);
    out
}

fn write_smooth_at(out: &mut String, function: &IsotropicFunction) -> std::fmt::Result {
    let ends = function.ends();
    let pair = |of: fn([f64; 2]) -> f64| ends.map(|ends| format!("{:?}", of(ends) as f32)).join(", ");
    writeln!(out, "/// Start of sqrt(alpha) and of 1 - sqrt(cos theta), and one over the length of each range.")?;
    writeln!(out, "const LTC_FUNCTION_START = vec2<f32>({});", pair(|[low, _]| low))?;
    writeln!(out, "const LTC_FUNCTION_SCALE = vec2<f32>({});\n", pair(|[low, high]| 1.0 / (high - low)))?;
    writeln!(out, "struct LtcSmooth {{\n    shape: vec3<f32>,\n    terms: vec3<f32>,\n}}\n")?;
    writeln!(out, "/// The table's numbers, from polynomials of the roughness (x) and of the view (y).")?;
    writeln!(out, "fn ltc_smooth_at(x: LtcChebyshev, y: LtcChebyshev) -> LtcSmooth {{")?;
    let steps = IsotropicFunction::steps();
    for (name, first) in [("shape", 0), ("terms", 3)] {
        writeln!(out, "    var {name} = vec3<f32>(0.0);")?;
        for (i, row) in function.coefficients().iter().enumerate() {
            let columns = row.map(|c| format!("{}.0, {}.0, {}.0", c[first], c[first + 1], c[first + 2]));
            let product = |(part, columns): (&str, &[String])| {
                format!("mat{}x3({}) * y.{part}", columns.len(), columns.join(", "))
            };
            let sums = ["low", "middle", "high"].into_iter().zip(columns.chunks(4)).map(product);
            writeln!(out, "    {name} += x.{} * ({});", place(i), sums.collect::<Vec<_>>().join(" + "))?;
        }
    }
    let scale =
        |first: usize| steps[first..first + 3].iter().map(|step| format!("{step:?}")).collect::<Vec<_>>().join(", ");
    writeln!(out, "    return LtcSmooth(shape * vec3({}), terms * vec3({}));\n}}", scale(0), scale(3))
}

/// The component of `LtcChebyshev` that holds the polynomial of a degree.
fn place(degree: usize) -> String {
    format!("{}.{}", ["low", "middle", "high"][degree / 4], ["x", "y", "z", "w"][degree % 4])
}

#[cfg(test)]
mod tests;
