//! The number formats of stored tables.

use crate::named_list;

named_list! {
    /// Number format of a stored table.
    pub enum Precision {
        /// IEEE 754 binary32.
        F32 = "f32",
        /// IEEE 754 binary16, as in half-float textures.
        F16 = "f16",
    }
}
