//! How isotropic lobes are fitted by three numbers in the frame of their mean direction: the numbers over a table, what
//! either shear does to a lobe, and where searches start. Fits run on the current rayon pool, whose size changes nothing.

mod fits;
mod maps;
mod order;
mod shears;

pub(super) use maps::{numbers, starts};
pub(super) use order::draw as order;
pub(super) use shears::draw as shears;
