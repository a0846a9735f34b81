//! Measures the second lobes of a table in the way renderers use them.

use serde::Serialize;

use super::{Accuracy, GoOn, figures};
use crate::{Configuration, LobeFresnel, LookedUp, SecondLobe, Table, WeightedF0};

/// The F0 of plastic, the material for which blended lobes are measured.
const PLASTIC: f64 = 0.04;

/// The errors of the second lobes of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SecondReport {
    /// The reflectance at normal incidence of the measured material. It is close to 0 for integrated second lobes,
    /// which leaves only Schlick's fifth power. For blended lobes it is the reflectance of plastic.
    pub f0: f64,
    /// Errors between nodes, at the configurations of the report. Terms belong to the first lobe and are not measured.
    pub between: Accuracy,
}

impl SecondReport {
    /// Measures the second lobes; `None` as soon as `go_on` returns false.
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

/// The lobe of a material, computed from a lookup.
fn of_material(second: SecondLobe, f0: f64, found: LookedUp) -> LookedUp {
    let matrix = match second {
        SecondLobe::Blended => found.blended_for(f0).matrix,
        SecondLobe::Integrated => found.second.unwrap_or(found.matrix),
    };
    LookedUp { matrix, amplitude: None, fresnel: None, ..found }
}
