//! From WGSL to the other languages, by naga.

mod cut;
mod fold;
mod zeros;

use std::fmt::Display;

use naga::{
    Module, ResourceBinding, ShaderStage,
    back::{PipelineConstants, glsl, hlsl, msl, pipeline_constants::process_overrides, spv},
    compact::{KeepUnused, compact},
    proc::BoundsCheckPolicies,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

use cut::without_entry;
use ltcforge_shaders::{Bound, Filter, Language, LitBy, Reading};

/// Where a resource goes in languages without groups: what OpenGL calls its binding and Metal its index.
type Slot = (ResourceBinding, u8, Resource);

/// The slots of a shader that reads a table.
const TABLE_SLOTS: [Slot; 6] = [
    (ResourceBinding { group: 0, binding: 0 }, 0, Resource::Buffer),
    (ResourceBinding { group: 0, binding: 1 }, 0, Resource::Texture),
    (ResourceBinding { group: 0, binding: 2 }, 1, Resource::Texture),
    (ResourceBinding { group: 0, binding: 3 }, 2, Resource::Texture),
    (ResourceBinding { group: 1, binding: 0 }, 1, Resource::Buffer),
    (ResourceBinding { group: 1, binding: 1 }, 2, Resource::WrittenBuffer),
];

/// The slots of a shader that reads none.
const TABLELESS_SLOTS: [Slot; 2] = [
    (ResourceBinding { group: 0, binding: 0 }, 0, Resource::Buffer),
    (ResourceBinding { group: 0, binding: 1 }, 1, Resource::WrittenBuffer),
];

/// Metal's buffer of the lengths of arrays.
const SIZES_SLOT: u8 = 4;

/// The use of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Resource {
    Buffer,
    WrittenBuffer,
    Texture,
    Sampler,
}

/// The slots of a table's resources in a text to include, each a number of its own.
const INCLUDED_SLOTS: [Slot; 5] = [
    (ResourceBinding { group: 0, binding: 0 }, 0, Resource::Buffer),
    (ResourceBinding { group: 0, binding: 1 }, 1, Resource::Texture),
    (ResourceBinding { group: 0, binding: 2 }, 2, Resource::Texture),
    (ResourceBinding { group: 0, binding: 3 }, 3, Resource::Texture),
    (ResourceBinding { group: 0, binding: 4 }, 4, Resource::Sampler),
];

/// The same of a table in one array.
const INCLUDED_ARRAY_SLOTS: [Slot; 3] = [
    (ResourceBinding { group: 0, binding: 0 }, 0, Resource::Buffer),
    (ResourceBinding { group: 0, binding: 1 }, 1, Resource::Texture),
    (ResourceBinding { group: 0, binding: 2 }, 2, Resource::Sampler),
];

/// The start of a translation: the function that keeps all others in it, and where resources go.
struct Entry<'a> {
    stage: ShaderStage,
    name: &'a str,
    slots: &'a [Slot],
}

/// The WGSL program `source` in `language`, as UTF-8 or as the words of SPIR-V; the error is naga's.
pub(super) fn translate(language: Language, lit_by: LitBy, source: &str) -> Result<Vec<u8>, String> {
    let (slots, filter): (&[Slot], _) = match lit_by.layout() {
        Some(_) => (&TABLE_SLOTS, Some(Filter::Exact)),
        None => (&TABLELESS_SLOTS, None),
    };
    let entry = Entry { stage: ShaderStage::Compute, name: lit_by.shader().example, slots };
    let (module, info) = prepared(source, &entry, filter)?;
    match language {
        Language::Wgsl => Ok(source.into()),
        Language::Glsl => glsl(&module, &info, glsl::Version::Desktop(450), &entry).map(String::into_bytes),
        Language::Glsl330 => Err("GLSL 3.30 has no compute shaders".to_owned()),
        Language::GlslEs => {
            let version = glsl::Version::Embedded { version: 310, is_webgl: false };
            glsl(&module, &info, version, &entry).map(String::into_bytes)
        }
        Language::Hlsl => hlsl(&module, &info, &entry).map(String::into_bytes),
        Language::Msl => msl(&module, &info, &entry).map(String::into_bytes),
        Language::Spirv => spirv(&module, &info, &entry, source),
    }
}

/// The input of a translation: WGSL with a fragment shader that calls every function, which is then cut off.
pub(super) struct Included<'a> {
    pub(super) source: &'a str,
    pub(super) entry: &'a str,
    /// How the entries of a table are read.
    pub(super) reading: Option<Reading>,
}

/// The functions of the WGSL module `source` in `language`, without the fragment shader that calls them all.
pub(super) fn translate_functions(language: Language, included: &Included<'_>) -> Result<String, String> {
    let bound = included.reading.unwrap_or_default().bound;
    let slots: &[Slot] = match bound {
        Bound::Volumes => &INCLUDED_SLOTS,
        Bound::Array => &INCLUDED_ARRAY_SLOTS,
    };
    let entry = Entry { stage: ShaderStage::Fragment, name: included.entry, slots };
    let (module, info) = prepared(included.source, &entry, included.reading.map(|reading| reading.filter))?;
    let whole = match language {
        Language::Wgsl => Ok(included.source.to_owned()),
        Language::Glsl => glsl(&module, &info, glsl::Version::Desktop(450), &entry),
        Language::Glsl330 => glsl(&module, &info, glsl::Version::Desktop(330), &entry),
        Language::GlslEs => glsl(&module, &info, glsl::Version::Embedded { version: 300, is_webgl: true }, &entry),
        Language::Hlsl => hlsl(&module, &info, &entry),
        Language::Msl => msl(&module, &info, &entry),
        Language::Spirv => Err("SPIR-V has no text to include".to_owned()),
    }?;
    without_entry(language, bound, &whole, included.entry)
        .ok_or_else(|| format!("no {} in the translation", included.entry))
}

/// The module with constants put in, and nothing in it that its entry point does not reach.
fn prepared(source: &str, entry: &Entry<'_>, filter: Option<Filter>) -> Result<(Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let info = validate(&module)?;
    let constant = |filter| ("ltc_hardware_filter".to_owned(), if filter == Filter::Hardware { 1.0 } else { 0.0 });
    let constants = PipelineConstants::from_iter(filter.map(constant));
    let stage = Some((entry.stage, entry.name));
    let (module, _) = process_overrides(&module, &info, stage, &constants).map_err(text)?;
    let mut module = module.into_owned();
    fold::known_branches(&mut module);
    compact(&mut module, KeepUnused::No);
    let info = validate(&module)?;
    Ok((module, info))
}

fn text(error: impl Display) -> String {
    error.to_string()
}

fn validate(module: &Module) -> Result<ModuleInfo, String> {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map_err(|error| format!("{:?}", error.into_inner()))
}

fn glsl(module: &Module, info: &ModuleInfo, version: glsl::Version, entry: &Entry<'_>) -> Result<String, String> {
    let options = glsl::Options {
        version,
        binding_map: entry.slots.iter().map(|(binding, slot, _)| (*binding, *slot)).collect(),
        ..Default::default()
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.to_owned(), multiview: None };
    let mut out = String::new();
    let mut writer =
        glsl::Writer::new(&mut out, module, info, &options, &pipeline, BoundsCheckPolicies::default()).map_err(text)?;
    writer.write().map_err(text)?;
    Ok(out)
}

fn hlsl(module: &Module, info: &ModuleInfo, entry: &Entry<'_>) -> Result<String, String> {
    // Without a map a binding's group is its space and its number the register's, which is what the header tells.
    let options = hlsl::Options { restrict_indexing: false, force_loop_bounding: false, ..Default::default() };
    let pipeline = hlsl::PipelineOptions { entry_point: Some((entry.stage, entry.name.to_owned())) };
    let mut out = String::new();
    hlsl::Writer::new(&mut out, &options, &pipeline).write(module, info, None).map_err(text)?;
    Ok(zeros::listed(&out))
}

fn msl(module: &Module, info: &ModuleInfo, entry: &Entry<'_>) -> Result<String, String> {
    let target = |slot: u8, kind: Resource| msl::BindTarget {
        buffer: matches!(kind, Resource::Buffer | Resource::WrittenBuffer).then_some(slot),
        texture: (kind == Resource::Texture).then_some(slot),
        sampler: (kind == Resource::Sampler).then_some(msl::BindSamplerTarget::Resource(slot)),
        mutable: kind == Resource::WrittenBuffer,
        ..Default::default()
    };
    let resources = msl::EntryPointResources {
        resources: entry.slots.iter().map(|(binding, slot, kind)| (*binding, target(*slot, *kind))).collect(),
        // Metal does not know the length of an array; naga needs it wherever that is not fixed.
        sizes_buffer: Some(SIZES_SLOT),
        ..Default::default()
    };
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: [(entry.name.to_owned(), resources)].into(),
        fake_missing_bindings: false,
        force_loop_bounding: false,
        ..Default::default()
    };
    let pipeline =
        msl::PipelineOptions { entry_point: Some((entry.stage, entry.name.to_owned())), ..Default::default() };
    let (out, translation) = msl::write_string(module, info, &options, &pipeline).map_err(text)?;
    // The writer leaves out a function whose bindings are missing, without an error.
    translation.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>().map_err(text)?;
    Ok(out)
}

fn spirv(module: &Module, info: &ModuleInfo, entry: &Entry<'_>, source: &str) -> Result<Vec<u8>, String> {
    // Many validators do not know the number of WGSL among the source languages yet.
    let language = spv::SourceLanguage::Unknown;
    let debug_info = spv::DebugInfo { source_code: source, file_name: "ltc.wgsl", language };
    let options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::DEBUG,
        debug_info: Some(debug_info),
        force_loop_bounding: false,
        ..Default::default()
    };
    let pipeline = spv::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.to_owned() };
    let words = spv::write_vec(module, info, &options, Some(&pipeline)).map_err(text)?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
