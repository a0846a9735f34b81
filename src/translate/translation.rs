//! Translates WGSL: naga validates it and writes SPIR-V, and `printer` writes the other languages.

use naga::{
    Module, ShaderStage,
    back::spv,
    compact::{KeepUnused, compact},
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

use super::{
    PortError,
    printer::{Form, printed},
    wgsl::folded,
};
use ltcforge_shaders::{Filter, Language, LitBy, ported, stamped};

/// The pipeline constant that selects how entries are interpolated.
const FILTER: &str = "ltc_hardware_filter";

/// A program in a printed language. Errors come from naga, or have line and column.
pub(super) fn program(language: Language, lit_by: LitBy) -> Result<String, String> {
    let source = exact(lit_by)?;
    validated(&source)?;
    printed(language, &source, lit_by.shader().example, Form::Program)
}

/// A program as SPIR-V words in little-endian order. It contains its source, with the comment `header`.
pub(super) fn spirv_program(lit_by: LitBy, header: &str) -> Result<Vec<u8>, String> {
    let source = stamped(header, &exact(lit_by)?);
    spirv(validated(&source)?, lit_by.shader().example, &source)
}

/// The WGSL program in which the shader interpolates the entries of a table.
fn exact(lit_by: LitBy) -> Result<String, String> {
    with_filter(&ported(lit_by), lit_by.layout().map(|_| Filter::Exact))
}

/// The fragment shader that calls every function of a shader text. The text itself does not contain it.
const CALLER: &str = "ltc_included";

/// The functions of a WGSL module in `language`, without the fragment shader that calls them. `filter` is only for
/// shaders that read a table.
pub(super) fn translate_functions(
    language: Language,
    source: &str,
    filter: Option<Filter>,
) -> Result<String, PortError> {
    let text = match language {
        Language::Wgsl => validated(source).and_then(|_| without_entry(source)),
        Language::Spirv => Err("SPIR-V has no text to include".to_owned()),
        _ => with_filter(source, filter)
            .and_then(|source| validated(&source).and_then(|_| printed(language, &source, CALLER, Form::Include))),
    };
    text.map_err(|reason| PortError { language, reason })
}

/// The text above the entry point. The entry point is last.
fn without_entry(whole: &str) -> Result<String, String> {
    let end = whole.rfind("@fragment\n").ok_or_else(|| format!("no {CALLER} in the text"))?;
    Ok(format!("{}\n", whole[..end].trim_end()))
}

/// The text with the filter constant replaced, for a shader that reads a table.
fn with_filter(source: &str, filter: Option<Filter>) -> Result<String, String> {
    match filter {
        None => Ok(source.to_owned()),
        Some(filter) => folded(source, FILTER, filter == Filter::Hardware).map_err(|fault| fault.message(source)),
    }
}

/// Parses and validates a module.
fn validated(source: &str) -> Result<Module, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    validate(&module)?;
    Ok(module)
}

fn validate(module: &Module) -> Result<ModuleInfo, String> {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map_err(|error| format!("{:?}", error.into_inner()))
}

/// The declarations that the entry point uses, in SPIR-V.
fn spirv(mut module: Module, entry: &str, source: &str) -> Result<Vec<u8>, String> {
    compact(&mut module, KeepUnused::No);
    let info = validate(&module)?;
    // Many validators do not support WGSL as a source language yet.
    let language = spv::SourceLanguage::Unknown;
    let debug_info = spv::DebugInfo { source_code: source, file_name: "ltc.wgsl", language };
    let options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::DEBUG,
        debug_info: Some(debug_info),
        force_loop_bounding: false,
        ..Default::default()
    };
    let pipeline = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: entry.to_owned() };
    let words = spv::write_vec(&module, &info, &options, Some(&pipeline)).map_err(|error| error.to_string())?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
