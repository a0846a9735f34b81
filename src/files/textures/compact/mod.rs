//! A table in its compact form: the bytes alone, a module of JavaScript that has them and decodes them, or one of
//! WGSL that decodes them.

#[cfg(test)]
#[allow(unreachable_pub, clippy::pedantic, reason = "a module that stands alone in other crates")]
mod decoder;
mod wgsl;

use base64::{Engine as _, prelude::BASE64_STANDARD};

use super::{about::About, file::TextureFile, rounding::RoundingError};
use crate::{
    files::compact::{CompactError, encode},
    fit::{Table, named_list::named_list},
};

named_list! {
    /// A file that holds a table's compact form.
    pub enum CompactContainer {
        /// The bytes, as [`crate::files::compact`] describes them.
        Bytes = "compact",
        /// An ES module: the bytes in base64, and what makes textures of them.
        JavaScript = "compact-js",
        /// The bytes, and a module of Rust that decodes them, without a crate.
        Rust = "compact-rust",
        /// The bytes, and a module of WGSL that decodes them on the GPU.
        Wgsl = "compact-wgsl",
    }
}

/// What decodes the bytes, in JavaScript.
const DECODER: &str = include_str!("decoder.js");

/// What decodes the bytes, in Rust.
const RUST_DECODER: &str = include_str!("decoder.rs");

/// The module's own functions.
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
    /// The file, whose name begins with `stem`.
    ///
    /// # Errors
    /// When the table has no compact form.
    pub fn files(self, stem: &str, table: &Table, about: &About) -> Result<Vec<TextureFile>, CompactError> {
        let bytes = encode(table)?;
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
                     decode(include_bytes!(\"{stem}.compact\"))\n}}\n\n{RUST_DECODER}",
                    about.comment()
                );
                vec![file("compact", bytes), file("compact.rs", text.into_bytes())]
            }
            Self::Wgsl => {
                let module = wgsl::module(&bytes, about)?;
                vec![file("compact", bytes), file("compact.wgsl", module.into_bytes())]
            }
        })
    }

    /// What to do with the file, a sentence each.
    #[must_use]
    pub fn steps(self, stem: &str) -> Vec<String> {
        match self {
            Self::Bytes => vec![format!(
                "Read {stem}.compact with ltcforge::files::compact::decode, or with the decoder of the container compact-js."
            )],
            Self::JavaScript => vec![format!(
                "import {{ createTextures }} from './{stem}.compact.js'; each texture has name, width, height, depth and RGBA data in 32 bits."
            )],
            Self::Rust => vec![format!(
                "Include {stem}.compact.rs by #[path = \"{stem}.compact.rs\"] mod ltc; and call ltc::textures() once at load."
            )],
            Self::Wgsl => vec![format!(
                "Bind {stem}.compact as {stem}.compact.wgsl says, and run its two passes once: its texels are the textures."
            )],
        }
    }
}

#[cfg(test)]
mod tests;
