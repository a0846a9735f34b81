//! The fit of isotropic lobes by three numbers in the frame of their mean direction. The figures show the numbers over
//! a table, the effect of both shears on a lobe, and the starts of searches. Fits run on the current rayon pool, whose
//! size does not change the results.

mod fits;
mod maps;
mod order;
mod shears;

pub(super) use maps::{numbers, starts};
pub(super) use order::draw as order;
pub(super) use shears::draw as shears;
