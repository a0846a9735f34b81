//! The Gaussians that there are.

use crate::named_list;

named_list! {
    /// The Gaussian that stands for a lobe.
    pub enum Gaussian {
        /// A spherical Gaussian: round, of the peak and the integral of the stretched one.
        Sg = "sg",
        /// An anisotropic spherical Gaussian: stretched as the warp stretches it.
        Asg = "asg",
    }
}
