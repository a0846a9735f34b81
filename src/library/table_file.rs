//! What a program does with a table in memory.

use super::Error;
use crate::{
    files::{
        container::{TableFile, decode, encode},
        manifest::{manifest_json, table_report},
    },
    fit::Report,
};

impl TableFile {
    /// Reads a canonical file.
    ///
    /// # Errors
    /// [`Error::Table`] for bytes that are not one.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        Ok(decode(bytes)?)
    }

    /// The canonical file.
    ///
    /// # Errors
    /// [`Error::Table`] for a table that its recipe does not describe.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        Ok(encode(&self.recipe, &self.table)?)
    }

    /// How good the table is: the report of its manifest. Runs on the current rayon pool.
    #[must_use]
    pub fn measure(&self) -> Report {
        table_report(&self.table, &self.recipe)
    }

    /// The manifest as JSON.
    ///
    /// # Errors
    /// As [`TableFile::to_bytes`].
    pub fn manifest(&self) -> Result<String, Error> {
        Ok(manifest_json(&self.to_bytes()?)?)
    }
}
