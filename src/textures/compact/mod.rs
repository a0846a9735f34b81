//! A table in its compact form: only the bytes, or with a decoder in JavaScript, Rust or WGSL.

// The decoder that the container `compact-rust` writes, compiled into this program for tests.
#[cfg(test)]
#[allow(unreachable_pub, clippy::pedantic, dead_code, reason = "other crates compile this module on its own")]
#[path = "../../files/compact/decoder.rs"]
mod coded;
#[cfg(test)]
#[allow(unreachable_pub, clippy::pedantic, reason = "other crates compile this module on its own")]
mod decoder;
mod wgsl;

use base64::{Engine as _, prelude::BASE64_STANDARD};

use super::{about::About, file::TextureFile, recipe::recipe_like, rounding::RoundingError};
use ltcforge_files::compact::{self, CompactError, LAYOUTS, check_lobes, encode_lobes};
use ltcforge_fit::{Layout, Table, named_list};

named_list! {
    /// A container for a table's compact form.
    pub enum CompactContainer {
        /// The bytes that `ltcforge_files::compact` describes.
        Bytes = "compact",
        /// An ES module: the bytes in base64, and functions that create textures from them.
        JavaScript = "compact-js",
        /// The bytes, and a Rust module that decodes them without other crates.
        Rust = "compact-rust",
        /// The bytes, and a WGSL module that decodes them on the GPU.
        Wgsl = "compact-wgsl",
    }
}

/// The table has no files of this kind.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompactFileError {
    /// The layout has no compact form, or the decoder cannot create textures from it.
    #[error(
        "{container} supports layouts {allowed}, but the table has layout {layout}; this recipe gives a supported table: \
         {recipe}"
    )]
    Layout {
        /// The container's name.
        container: &'static str,
        /// The layouts that the container supports.
        allowed: String,
        /// The table's layout.
        layout: Layout,
        /// A recipe whose table has a supported layout.
        recipe: String,
    },
    /// The numbers of the table have no compact form.
    #[error(transparent)]
    Form(#[from] CompactError),
}

/// The decoder in JavaScript.
const DECODER: &str = include_str!("decoder.js");

/// The Rust code that creates textures from the bytes. It uses [`compact::DECODER`].
const RUST_DECODER: &str = include_str!("decoder.rs");

/// The functions of the module itself.
const MODULE: &str = "
// The textures of this module's table, and the table itself.
export function createTextures() {

	return texturesOf( createTable() );

}

export function createTable() {

	return decodeTable( Uint8Array.from( atob( DATA ), c => c.charCodeAt( 0 ) ) );

}

";

impl CompactContainer {
    /// The layouts that the container supports.
    fn layouts(self) -> &'static [Layout] {
        match self {
            Self::Bytes | Self::JavaScript => &LAYOUTS,
            Self::Rust | Self::Wgsl => &[Layout::Reflected, Layout::Ltc2017],
        }
    }

    /// Checks that the container supports the layout of a table.
    pub(super) fn check(self, table: &Table) -> Result<(), CompactFileError> {
        let (layout, layouts) = (table.layout(), self.layouts());
        check_lobes(table)?;
        if layouts.contains(&layout) {
            return Ok(());
        }
        let usual = if layout.only_ranges().is_some() {
            (Layout::Ltc2017, r#"{"layout": "ltc2017"}"#)
        } else {
            (Layout::Reflected, r#"{"layout": "reflected"}"#)
        };
        Err(CompactFileError::Layout {
            container: self.name(),
            allowed: layouts.iter().map(|layout| layout.name()).collect::<Vec<_>>().join(", "),
            layout,
            recipe: recipe_like(usual.1, usual.0, true, table),
        })
    }

    /// The files of a table. Their names start with `stem`.
    ///
    /// # Errors
    /// The table has no compact form.
    pub fn files(self, stem: &str, table: &Table, about: &About) -> Result<Vec<TextureFile>, CompactFileError> {
        self.check(table)?;
        let forms = encode_lobes(table)?.into_iter().map(|encoded| encoded.bytes).collect();
        self.files_of_lobes(stem, forms, about)
    }

    /// The files for the compact forms of a table's lobes. Names for the second lobe start with `stem` and `_2`.
    pub(super) fn files_of_lobes(
        self,
        stem: &str,
        forms: Vec<Vec<u8>>,
        about: &About,
    ) -> Result<Vec<TextureFile>, CompactFileError> {
        let second = format!("{stem}_2");
        let files = [stem, &second].into_iter().zip(forms).map(|(stem, bytes)| self.files_of(stem, bytes, about));
        Ok(files.collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// The files for one compact form in this container.
    fn files_of(self, stem: &str, bytes: Vec<u8>, about: &About) -> Result<Vec<TextureFile>, CompactFileError> {
        let file = |ending: &str, bytes: Vec<u8>| TextureFile {
            path: format!("{stem}.{ending}"),
            bytes,
            rounding: RoundingError::default(),
        };
        Ok(match self {
            Self::Bytes => vec![file("compact", bytes)],
            Self::JavaScript => {
                let data = BASE64_STANDARD.encode(bytes);
                let text = format!("{}\nconst DATA = '{data}';\n{MODULE}{DECODER}", about.comment());
                vec![file("compact.js", text.into_bytes())]
            }
            Self::Rust => {
                let text = format!(
                    "{}\n/// The textures of this module's table.\n///\n/// # Errors\n/// Damaged bytes.\n\
                     pub fn textures() -> Result<Vec<Texture>, &'static str> {{\n    \
                     decode(include_bytes!(\"{stem}.compact\"))\n}}\n\npub use decoder::{{Texture, decode}};\n\n\
                     mod decoder {{\n{RUST_DECODER}}}\n\nmod coded {{\n{}}}\n",
                    about.comment(),
                    compact::DECODER
                );
                vec![file("compact", bytes), file("compact.rs", text.into_bytes())]
            }
            Self::Wgsl => {
                let module = wgsl::module(&bytes, about)?;
                vec![file("compact", bytes), file("compact.wgsl", module.into_bytes())]
            }
        })
    }

    /// Instructions for the files. Each is one sentence.
    #[must_use]
    pub fn steps(self, stem: &str) -> Vec<String> {
        match self {
            Self::Bytes => vec![format!(
                "Read {stem}.compact with ltcforge::files::compact::decode, or with the decoder of compact-js, compact-rust or \
                 compact-wgsl."
            )],
            Self::JavaScript => vec![format!(
                "import {{ createTextures }} from './{stem}.compact.js'; each texture has name, width, height, depth and RGBA \
                 data in 32 bits."
            )],
            Self::Rust => vec![format!(
                "Include {stem}.compact.rs with #[path = \"{stem}.compact.rs\"] mod ltc; and call ltc::textures() once at load."
            )],
            Self::Wgsl => vec![format!(
                "Bind {stem}.compact as {stem}.compact.wgsl describes, and run its two passes once. The output buffer holds the textures."
            )],
        }
    }
}

#[cfg(test)]
mod tests;
