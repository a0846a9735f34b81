//! The field `fresnel`: the materials to whose lobes the table is fitted.

use serde_json::Value;

use super::reader::{Faults, Object, echo, listed};
use ltcforge_fit::{BrdfKind, LobeFresnel, LobeModel, SecondLobe, WeightedF0};

/// The smallest usable F0. Below it, samples near the normal have almost no weight, and few samples determine the lobe.
const LEAST_F0: f64 = 1e-3;
/// Maximum number of materials in a mix.
const MOST_MATERIALS: usize = 64;
/// The largest weight of a material.
const MOST_WEIGHT: f64 = 1e9;

/// Reads the materials: "one", a list of weighted F0, or a name for two lobes.
pub(super) fn read_fresnel(root: &Object, brdf: BrdfKind, faults: &mut Faults) -> LobeFresnel {
    let value = match root.get("fresnel") {
        None => return LobeFresnel::One,
        Some(Value::String(name)) if name == "one" => return LobeFresnel::One,
        Some(value) => value,
    };
    let pointer = root.pointer("fresnel");
    if !brdf.has_fresnel() {
        let others = listed(BrdfKind::ALL, BrdfKind::has_fresnel);
        let detail = format!("brdf \"{brdf}\" has no Fresnel factor: leave this field out, or choose brdf {others}");
        faults.note(&*pointer, detail);
    }
    let second = SecondLobe::ALL.into_iter().find(|second| value.as_str() == Some(second.name()));
    if let Some(second) = second {
        return LobeFresnel::Two(second);
    }
    let Value::Array(parts) = value else {
        let [two, blended] = SecondLobe::ALL.map(SecondLobe::name);
        let detail = format!(
            "{} is neither \"one\", \"{two}\" nor \"{blended}\", nor a list of materials like {{\"f0\": 0.04, \"weight\": 1}}",
            echo(value)
        );
        faults.note(pointer, detail);
        return LobeFresnel::One;
    };
    if parts.is_empty() || parts.len() > MOST_MATERIALS {
        faults.note(&*pointer, format!("{} materials; 1 to {MOST_MATERIALS} are allowed", parts.len()));
        return LobeFresnel::One;
    }
    let before = faults.0.len();
    let part = |(index, part): (usize, &Value)| {
        let object = Object::item(format!("{pointer}/{index}"), part, &["f0", "weight"], faults);
        if part.is_object() && object.get("f0").is_none() {
            faults.note(object.pointer("f0"), "missing: give the reflectance at normal incidence, 0 to 1");
        }
        WeightedF0 {
            f0: object.number("f0", [0.0, 1.0], 1.0, faults),
            weight: object.number("weight", [0.0, MOST_WEIGHT], 1.0, faults),
        }
    };
    let parts: Vec<WeightedF0> = parts.iter().enumerate().map(part).collect();
    if faults.0.len() > before {
        return LobeFresnel::One;
    }
    match LobeFresnel::mix(parts) {
        None => faults.note(pointer, "all weights are 0: at least one must be above zero"),
        Some(LobeFresnel::Mix(parts)) if parts.iter().all(|part| part.f0 < LEAST_F0) => {
            let detail =
                format!("at least one material needs an f0 of {LEAST_F0} or more, to reflect at normal incidence");
            faults.note(pointer, detail);
        }
        Some(fresnel) => return fresnel,
    }
    LobeFresnel::One
}

/// Checks that two lobes are LTCs with terms, which give the weight of each lobe.
pub(super) fn check_second(root: &Object, fresnel: &LobeFresnel, lobe: LobeModel, terms: bool, faults: &mut Faults) {
    let Some(second) = fresnel.second() else { return };
    let name = second.name();
    if lobe.gaussian().is_some() {
        let others = listed(LobeModel::ALL, |lobe| lobe.gaussian().is_none());
        let detail = format!("\"{name}\" needs LTCs, not lobe \"{lobe}\"; choose lobe {others}");
        faults.note(root.pointer("fresnel"), detail);
    }
    if !terms {
        let detail = format!("\"{name}\" needs the terms as weights: leave this field out, or choose true");
        faults.note(root.pointer("terms"), detail);
    }
}
