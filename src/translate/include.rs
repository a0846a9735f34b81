//! The shader as text to include: functions and bindings, but no program.

use super::{PortError, translation::translate_functions};
use ltcforge_shaders::{GivenAxes, Language, Lights, LitBy, Namespace, Reading, functions, stamped};

/// The functions in `language`. A comment at the top explains calls, bindings, and values to check a port against.
///
/// `reading` selects how entries of a table are read. Models without a table ignore it. In WGSL, the constant
/// `ltc_hardware_filter` selects the interpolation, so the text is the same for both filters. `namespace` avoids
/// conflicts between several texts in one shader. Texts of different models need no namespace. `lights` selects the
/// shapes of lights for tables of LTCs. Other models ignore it.
///
/// # Errors
/// [`PortError`] for SPIR-V, which has no text to include, or for a defect of the shaders or of naga.
pub fn include(
    language: Language,
    lit_by: impl Into<LitBy>,
    reading: Reading,
    lights: Lights,
    namespace: &Namespace,
) -> Result<String, PortError> {
    let lit_by = lit_by.into();
    let reading = lit_by.layout().map(|_| reading);
    let read = reading.unwrap_or_default();
    let header = lit_by.include_comment(language, read, lights, namespace);
    made(language, lit_by, reading, lights, namespace, &functions(lit_by, read, lights), &header)
}

/// The functions that read a table with listed nodes. The lines `about` describe the table. Otherwise like
/// [`include()`].
///
/// # Errors
/// Like [`include()`].
pub fn include_given(
    language: Language,
    lit_by: LitBy,
    given: &GivenAxes,
    about: &[String],
    reading: Reading,
    lights: Lights,
    namespace: &Namespace,
) -> Result<String, PortError> {
    let header = given.comment(language, reading, lights, namespace, about);
    let functions = given.functions(lit_by, reading, lights);
    made(language, lit_by, Some(reading), lights, namespace, &functions, &header)
}

fn made(
    language: Language,
    lit_by: LitBy,
    reading: Option<Reading>,
    lights: Lights,
    namespace: &Namespace,
    functions: &str,
    header: &str,
) -> Result<String, PortError> {
    let caller = lit_by.caller(reading.unwrap_or_default(), lights);
    let source = format!("{functions}{caller}");
    let text = translate_functions(language, &source, reading.map(|reading| reading.filter))?;
    let header = lit_by.explained(header, lights);
    let [header, text] = [header, namespace.bound(&text, language)].map(|part| namespace.named(&part, lit_by));
    Ok(stamped(&header, &text))
}

#[cfg(test)]
mod tests;
