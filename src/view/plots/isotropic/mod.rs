//! How isotropic lobes are fitted by three numbers in the frame of their mean direction: the numbers over a table, what
//! either shear does to a lobe, and where searches start.

mod fits;
mod maps;
mod order;
mod shears;

use crate::picture::Picture;
use ltcforge_fit::{Shear, named_list};

named_list! {
    /// A picture of such fits.
    pub enum IsotropicFigure {
        /// The three numbers, the mean direction, and the matrix and its inverse that they make.
        Numbers = "numbers",
        /// A clamped cosine and lobes with shear x.
        ShearX = "shear_x",
        /// The same with shear z.
        ShearZ = "shear_z",
        /// The skew of every entry, from searches that start by themselves and from those that start from a neighbour.
        Starts = "starts",
        /// The order in which searches start from each other.
        Order = "order",
    }
}

impl IsotropicFigure {
    /// Fits what the picture needs, on the current rayon pool, whose size changes nothing, and draws it.
    #[must_use]
    pub fn draw(self) -> Picture {
        match self {
            Self::Numbers => maps::numbers(),
            Self::ShearX => shears::draw(Shear::X),
            Self::ShearZ => shears::draw(Shear::Z),
            Self::Starts => maps::starts(),
            Self::Order => order::draw(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Those that fit no whole table.
    #[test]
    fn pictures_differ_and_come_again() {
        let figures = [IsotropicFigure::ShearX, IsotropicFigure::ShearZ, IsotropicFigure::Order];
        let drawn = figures.map(IsotropicFigure::draw);
        assert!(drawn == figures.map(IsotropicFigure::draw), "not the same again");
        assert!(drawn[0] != drawn[1] && drawn[0].rgb.len() > 100_000);
    }
}
