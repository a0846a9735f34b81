//! How good the second lobes of a table are, measured as they are used.

use serde::Serialize;

use super::{Accuracy, GoOn, figures};
use crate::{Configuration, LobeFresnel, LookedUp, SecondLobe, Table, WeightedF0};

/// Plastic, whose blend is measured.
const PLASTIC: f64 = 0.04;

/// How good the second lobes of a table are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SecondReport {
    /// The reflectance, seen from above, of the material that was measured: next to 0 where second lobes are integrated by
    /// themselves, so that Schlick's fifth power is all of it; that of plastic where lobes are blended.
    pub f0: f64,
    /// Errors between nodes, at the places of the report's own. Terms are the first lobe's.
    pub between: Accuracy,
}

impl SecondReport {
    /// `None` as soon as `go_on` says no.
    pub(super) fn of(go_on: &GoOn, table: &Table, second: SecondLobe, places: &[Configuration]) -> Option<Self> {
        let f0 = match second {
            SecondLobe::Integrated => second.fitted_f0(),
            SecondLobe::Blended => PLASTIC,
        };
        let material = LobeFresnel::mix(vec![WeightedF0 { f0, weight: 1.0 }]).unwrap_or_default();
        let brdf = table.brdf.clone().with_fresnel(material);
        let found = |at: &Configuration| of_material(second, f0, table.lookup(at));
        let measured = figures::found_while(go_on, &brdf, table.lobe, places, found)?;
        Some(Self { f0, between: Accuracy::of(&measured) })
    }
}

/// The lobe of a material by what a lookup tells.
fn of_material(second: SecondLobe, f0: f64, found: LookedUp) -> LookedUp {
    let matrix = match second {
        SecondLobe::Blended => found.blended_for(f0).matrix,
        SecondLobe::Integrated => found.second.unwrap_or(found.matrix),
    };
    LookedUp { matrix, amplitude: None, fresnel: None, ..found }
}
