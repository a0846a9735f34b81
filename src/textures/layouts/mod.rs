//! Texture layouts: the axes, texels and channels of a table's textures.
//!
//! The description of a layout determines its textures. A new layout needs a source file and a line in
//! [`TextureLayout`].

mod error;
mod isotropic;
mod published;
mod rules;
mod volumes;

use ltcforge_fit::{Layout, Precision, Table, named_list};

use super::{
    halves::{Halves, halved},
    recipe::recipe_like,
    rounding::round,
    texture::Texture,
};

pub use error::NoTextures;
pub(crate) use rules::TextureRules;
pub use rules::{TextureAxis, TextureSampling, TexturesOf};

named_list! {
    /// How a table is arranged in textures.
    pub enum TextureLayout: TextureRules {
        /// Three 3D textures of layout `reflected`, in the form that the shader of `ltcforge shader` reads.
        Reflected = "reflected" => volumes::REFLECTED,
        /// Three 3D textures of layout `kt2022`.
        Kt2022 = "kt2022" => volumes::KT2022,
        /// The three textures of layout `reflected` as one 2D array.
        ReflectedArray = "reflected-array" => volumes::REFLECTED_ARRAY,
        /// The three textures of layout `kt2022` as one 2D array.
        Kt2022Array = "kt2022-array" => volumes::KT2022_ARRAY,
        /// The 3D texture for the demo of KT et al. 2022.
        Kt2022Volume = "kt2022-volume" => published::Kt2022Volume,
        /// Two 2D textures of layout `ltc2017`.
        Ltc2017 = "ltc2017" => isotropic::LTC2017,
        /// Two 2D textures of layout `ltc2016`.
        Ltc2016 = "ltc2016" => isotropic::LTC2016,
        /// Two 2D textures of layout `godot`.
        Godot = "godot" => isotropic::GODOT,
        /// One 2D texture of layout `hdrp`.
        Hdrp = "hdrp" => isotropic::HDRP,
        /// Three 3D textures of layout `ltc2017`, in the form that the shader of `ltcforge shader` reads.
        Ltc2017In3d = "ltc2017-3d" => volumes::LTC2017,
        /// Three 3D textures of layout `ltc2016`.
        Ltc2016In3d = "ltc2016-3d" => volumes::LTC2016,
        /// Three 3D textures of layout `godot`.
        GodotIn3d = "godot-3d" => volumes::GODOT,
        /// Three 3D textures of layout `hdrp`.
        HdrpIn3d = "hdrp-3d" => volumes::HDRP,
        /// Three 3D textures of layout `inverse`, which has no other textures.
        InverseIn3d = "inverse-3d" => volumes::INVERSE,
        /// Three 3D textures of layout `matrix33`, which has no other textures.
        Matrix33In3d = "matrix33-3d" => volumes::MATRIX33,
        /// Three 3D textures of layout `materials`, with one slice per material.
        Materials = "materials" => volumes::MATERIALS,
        /// The three textures of layout `materials` as one 2D array.
        MaterialsArray = "materials-array" => volumes::MATERIALS_ARRAY,
    }
}

impl TextureLayout {
    /// The layout with this name.
    ///
    /// # Errors
    /// There is no layout with this name.
    pub fn named(name: &str) -> Result<Self, NoTextures> {
        Self::from_name(name)
            .ok_or_else(|| NoTextures::UnknownLayout { name: name.to_owned(), known: layout_names().join(", ") })
    }

    /// The axes and channels of the textures, and the scale of the matrix.
    #[must_use]
    pub fn sampling(self) -> TextureSampling {
        self.rules().sampling()
    }

    /// The three 3D textures of a layout, in the form that our shader reads.
    #[must_use]
    pub fn of_shader(layout: Layout) -> Self {
        match layout {
            Layout::Reflected => Self::Reflected,
            Layout::Materials => Self::Materials,
            Layout::Kt2022 => Self::Kt2022,
            Layout::Ltc2017 => Self::Ltc2017In3d,
            Layout::Ltc2016 => Self::Ltc2016In3d,
            Layout::Godot => Self::GodotIn3d,
            Layout::Hdrp => Self::HdrpIn3d,
            Layout::Inverse => Self::InverseIn3d,
            Layout::Matrix33 => Self::Matrix33In3d,
        }
    }

    /// Whether the shader of `ltcforge shader` reads these textures.
    pub(super) fn is_for_shader(self) -> bool {
        self.rules().is_for_shader()
    }

    /// The textures of a table, with halves that were rounded together for each matrix.
    ///
    /// # Errors
    /// The table has another layout, or lacks something that these textures need. The error names a recipe for a table
    /// with these textures.
    pub fn textures(self, table: &Table) -> Result<Vec<Texture>, NoTextures> {
        self.check(table)?;
        let mut textures = self.rules().textures(table)?;
        let (halved, displacement) = halved(table);
        for (texture, halved) in textures.iter_mut().zip(self.rules().textures(&halved)?) {
            let numbers = round(&halved.texels, Precision::F16).numbers;
            texture.halves = Some(Halves { numbers, displacement });
        }
        Ok(textures)
    }

    /// Checks that the table has these textures.
    pub(super) fn check(self, table: &Table) -> Result<(), NoTextures> {
        let TextureSampling { table: needed, recipe, .. } = self.sampling();
        let is_kept = self.rules().takes(table.brdf());
        let two = self.is_for_shader();
        let recipe = || if is_kept { recipe_like(recipe, needed, two, table) } else { recipe.to_owned() };
        if table.layout != needed {
            return Err(NoTextures::OtherLayout { table: table.layout, asked: self.name(), recipe: recipe() });
        }
        let lacking = if table.second.is_some() && !two {
            Some("one lobe per entry, but the table has two lobes".to_owned())
        } else {
            self.rules().lacks(table)
        };
        lacking.map_or(Ok(()), |lacking| Err(NoTextures::Lacking { asked: self.name(), lacking, recipe: recipe() }))
    }
}

/// The names of all layouts.
#[must_use]
pub fn layout_names() -> Vec<&'static str> {
    TextureLayout::ALL.iter().map(|layout| layout.name()).collect()
}

/// The textures of a table in the layout with this name.
///
/// # Errors
/// There is no such layout; otherwise see [`TextureLayout::textures`].
pub fn textures_of(table: &Table, layout: &str) -> Result<Vec<Texture>, NoTextures> {
    TextureLayout::named(layout)?.textures(table)
}

/// A description, for people, of how to sample these textures: axes, channels, and the nodes if they are unevenly
/// spaced.
#[must_use]
pub fn sampling_of(table: &Table, layout: TextureLayout) -> Vec<String> {
    let TextureSampling { axes, textures, normalisation, .. } = layout.sampling();
    let mut lines = vec![format!("layout {layout}: {normalisation}")];
    lines.extend(axes.iter().map(|axis| format!("{}: {}", axis.axis, axis.coordinate)));
    lines.extend(textures.iter().map(|of| format!("{}: {}: {}", of.name, of.channels.join(" "), of.meaning)));
    if table.second.is_some() {
        lines.push(
            "two lobes per entry: in each texture, the layers of the second lobes follow those of the first lobes"
                .to_owned(),
        );
    }
    if table.layout.only_ranges().is_none() {
        let nodes = |nodes: &[f64]| nodes.iter().map(|x| (*x as f32).to_string()).collect::<Vec<_>>().join(" ");
        lines.extend(table.axes.named().map(|(name, axis)| format!("nodes of {name}: {}", nodes(axis))));
    }
    lines
}

#[cfg(test)]
mod tests;
