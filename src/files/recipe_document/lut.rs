//! Recipe documents of lookup tables: documents whose field `table` is not `"ltc"`.

use std::ops::RangeInclusive;

use serde_json::Value;

use super::{
    document::{named, read_fitter},
    fault::Fault,
    reader::{Faults, Object, echo},
};
use ltcforge_fit::{
    BrdfKind,
    albedo::{AxisParameter, DfgForm, LutAxes, LutKind, LutPrecision, LutRecipe, LutResolution, Texels},
};

const FIELDS: [&str; 8] = ["preset", "fitter", "table", "brdf", "form", "resolution", "axes", "precision"];
/// The name of tables of linearly transformed cosines, the default.
const LTC: &str = "ltc";
/// The largest number of texels on an axis, for tables of two, three and four axes.
const MOST_TEXELS: [u32; 3] = [1024, 64, 16];

/// The default number of texels on an axis.
fn default_texels(table: LutKind, axis: &str) -> u32 {
    match (table, axis) {
        (LutKind::Albedo, _) => 64,
        (LutKind::Transmission, _) | (LutKind::AnisotropicDfg, "theta") => 16,
        (LutKind::AnisotropicDfg, "alpha") => 12,
        (LutKind::AnisotropicDfg, _) => 8,
        _ => 32,
    }
}

/// The kind of lookup table that a document asks for, by its field `table` or by a preset with the name of a table.
/// `None` for other documents.
pub(super) fn kind(document: &Value, faults: &mut Faults) -> Option<LutKind> {
    let preset = document.get("preset").and_then(Value::as_str).and_then(LutKind::from_name);
    let Some(table) = document.get("table") else { return preset };
    if table.as_str() == Some(LTC) {
        return None;
    }
    let kind = table.as_str().and_then(LutKind::from_name);
    if kind.is_none() {
        let names: Vec<String> = LutKind::ALL.iter().map(|kind| format!("\"{kind}\"")).collect();
        faults.note("/table", format!("{} is not one of \"{LTC}\", {}", echo(table), names.join(", ")));
    }
    kind
}

/// Reads the recipe of a lookup table.
pub(super) fn read(
    document: &Value,
    kind: LutKind,
    entry_limit: u64,
    fitters: RangeInclusive<u32>,
) -> Result<LutRecipe, Vec<Fault>> {
    let mut faults = Faults::default();
    let root = Object::root(document, &FIELDS, &mut faults);
    root.choice("preset", &[(kind.name(), ())], (), &mut faults);
    let brdf = first_of(&root, "brdf", kind.brdfs(), BrdfKind::name, &mut faults);
    let form = kind.has_forms().then(|| first_of(&root, "form", DfgForm::ALL, DfgForm::name, &mut faults));
    if form.is_none() {
        absent(&root, "form", &format!("table \"{kind}\" has no forms"), &mut faults);
    }
    let size = root.object("resolution", kind.axes(), &mut faults);
    let most = MOST_TEXELS[kind.axes().len() - 2];
    let resolution =
        LutResolution::new(kind, |axis| size.integer32(axis, 2, most, default_texels(kind, axis), &mut faults));
    let axes = read_axes(&root, kind, &mut faults);
    let precision = first_of(&root, "precision", LutPrecision::ALL, LutPrecision::name, &mut faults);
    let fitter = read_fitter(&root, fitters, &mut faults);
    let recipe = LutRecipe { fitter, table: kind, brdf, form, resolution, axes, precision };
    if recipe.entries() > entry_limit {
        let detail = format!("{} texels; at most {entry_limit} are allowed (`--entry-limit`)", recipe.entries());
        faults.note("/resolution", detail);
    }
    if faults.0.is_empty() { Ok(recipe) } else { Err(faults.0) }
}

/// The parameters of the texels; `None` for tables with those of layout `reflected`.
fn read_axes(root: &Object<'_>, kind: LutKind, faults: &mut Faults) -> Option<LutAxes> {
    if kind == LutKind::AnisotropicDfg {
        absent(root, "axes", &format!("table \"{kind}\" has the axes of layout \"reflected\""), faults);
        return None;
    }
    let axes = root.object("axes", &["roughness", "cos_theta", "texels"], faults);
    Some(LutAxes {
        roughness: first_of(&axes, "roughness", &AxisParameter::ROUGHNESS, AxisParameter::name, faults),
        cos_theta: first_of(&axes, "cos_theta", &AxisParameter::COS_THETA, AxisParameter::name, faults),
        texels: first_of(&axes, "texels", Texels::ALL, Texels::name, faults),
    })
}

/// A choice from a list. The first item is the default.
fn first_of<T: Copy>(
    object: &Object<'_>,
    field: &str,
    all: &[T],
    name: fn(T) -> &'static str,
    faults: &mut Faults,
) -> T {
    object.choice(field, &named(all, name), all[0], faults)
}

/// Notes a fault if the object has this field.
fn absent(object: &Object<'_>, field: &str, reason: &str, faults: &mut Faults) {
    if let Some(value) = object.get(field) {
        faults.note(object.pointer(field), format!("{reason}, got {}: leave this field out", echo(value)));
    }
}
