//! The light from a table of Linearly Transformed Cosines. It is exact for the fitted lobes.

mod cone;
mod cut;
pub mod formula;
mod shapes;
mod table;

pub use cone::Cone;
pub use cut::AboveSurface;
pub use formula::FormulaLobe;
pub use shapes::CosineSpace;
pub use table::{TableUse, by_blend, by_table, by_table_as, edge_by_table};
pub(crate) use table::{covered, covered_in};

use super::rules::ModelOfLight;
use ltcforge_fit::LobeModel;

/// The model as an item of [`crate::LightModel`].
pub(super) struct LtcModel;

impl ModelOfLight for LtcModel {
    fn lobe(&self) -> Option<LobeModel> {
        Some(LobeModel::Ltc)
    }

    fn table_cost(&self) -> u32 {
        8
    }
}
