//! Methods of a table in memory.

use super::{TableFile, TableFileError, decode, encode};
use crate::{
    manifest::{manifest_json_with, table_report},
    tabulated,
};
use ltcforge_fit::Report;

impl TableFile {
    /// Reads a canonical file.
    ///
    /// # Errors
    /// [`TableFileError`] for bytes that are not a canonical file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableFileError> {
        decode(bytes)
    }

    /// Encodes the canonical file.
    ///
    /// # Errors
    /// [`TableFileError`] for a table that its recipe does not describe.
    pub fn to_bytes(&self) -> Result<Vec<u8>, TableFileError> {
        encode(&self.recipe, &self.table)
    }

    /// Attaches the file of a tabulated BRDF to its table. Measuring needs this file, and the table's file does not
    /// contain it. A table that was just fitted has it already.
    ///
    /// # Errors
    /// [`TableFileError::Brdf`] for bytes that are not a tabulated BRDF, or not the BRDF of this table.
    pub fn attach_brdf(&mut self, bytes: &[u8]) -> Result<(), TableFileError> {
        let file = tabulated::decode(bytes).map_err(|error| TableFileError::Brdf(error.to_string()))?;
        self.find_brdf(&|_| Ok(file.clone()))
    }

    /// The accuracy of the table: the report of its manifest. Runs on the current rayon pool.
    ///
    /// # Errors
    /// [`TableFileError`] for a table of a tabulated BRDF whose file is not attached.
    pub fn measure(&self) -> Result<Report, TableFileError> {
        if !self.table.model().is_complete() {
            return Err(TableFileError::Brdf("attach the BRDF file first".to_owned()));
        }
        Ok(table_report(&self.table, &self.recipe))
    }

    /// The manifest as JSON.
    ///
    /// # Errors
    /// Like [`TableFile::to_bytes`] and [`TableFile::measure`].
    pub fn manifest(&self) -> Result<String, TableFileError> {
        let file = self.table.model().file().filter(|file| file.data().is_some());
        let find = |_: &str| file.cloned().ok_or_else(|| vec!["attach the BRDF file first".to_owned()]);
        manifest_json_with(&self.to_bytes()?, &find)
    }
}
