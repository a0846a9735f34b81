//! The light from a table of Linearly Transformed Cosines. It is exact for the fitted lobes.

mod cone;
mod cut;
mod shapes;
mod table;

pub use cone::Cone;
pub use cut::AboveSurface;
pub use shapes::CosineSpace;
pub(crate) use table::covered;
pub use table::{TableUse, by_blend, by_table, by_table_as, edge_by_table};

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
