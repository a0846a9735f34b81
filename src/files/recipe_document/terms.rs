//! The terms in a recipe.

use serde_json::Value;

use super::reader::{Faults, Object, echo, listed};
use ltcforge_fit::{BrdfKind, LobeModel, StoredTerms};

/// Reads the terms to store: `true`, `false`, or "f82", which is for metals with microfacets.
pub(super) fn read_terms(root: &Object, brdf: BrdfKind, lobe: LobeModel, faults: &mut Faults) -> StoredTerms {
    match root.get("terms") {
        None | Some(Value::Bool(true)) => return StoredTerms::Schlick,
        Some(Value::Bool(false)) => return StoredTerms::None,
        Some(Value::String(name)) if name == StoredTerms::F82_NAME => {}
        Some(other) => {
            let detail = format!("{} is neither true, false nor \"{}\"", echo(other), StoredTerms::F82_NAME);
            faults.note(root.pointer("terms"), detail);
            return StoredTerms::Schlick;
        }
    }
    if !brdf.has_fresnel() {
        let others = listed(BrdfKind::ALL, BrdfKind::has_fresnel);
        let detail = format!("brdf \"{brdf}\" has no Fresnel factor for F82: choose true, or brdf {others}");
        faults.note(root.pointer("terms"), detail);
    }
    if lobe.gaussian().is_some() {
        let ltc = LobeModel::ALL[0];
        let detail = format!("\"f82\" needs lobe \"{ltc}\", not \"{lobe}\": choose true, or lobe \"{ltc}\"");
        faults.note(root.pointer("terms"), detail);
    }
    StoredTerms::F82
}
