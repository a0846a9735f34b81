//! What a program does with a table in memory.

use super::Error;
use ltcforge_files::{
    container::{TableFile, TableFileError, decode, encode},
    manifest::{manifest_json_with, table_report},
    tabulated,
};
use ltcforge_fit::Report;

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

    /// Gives a table that was fitted to a tabulated BRDF the bytes of its file, which no table's file has and which measuring
    /// needs. A table that was just fitted has them.
    ///
    /// # Errors
    /// [`Error::Tabulated`] for bytes that are no tabulated BRDF, [`Error::Table`] for those of another one.
    pub fn attach_brdf(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let file = tabulated::decode(bytes)?;
        Ok(self.find_brdf(&|_| Ok(file.clone()))?)
    }

    /// How good the table is: the report of its manifest. Runs on the current rayon pool.
    ///
    /// # Errors
    /// [`Error::Table`] for a table of a tabulated BRDF whose file is not attached.
    pub fn measure(&self) -> Result<Report, Error> {
        if !self.table.model().is_complete() {
            return Err(TableFileError::Brdf("attach its file first".to_owned()).into());
        }
        Ok(table_report(&self.table, &self.recipe))
    }

    /// The manifest as JSON.
    ///
    /// # Errors
    /// As [`TableFile::to_bytes`] and [`TableFile::measure`].
    pub fn manifest(&self) -> Result<String, Error> {
        let file = self.table.model().file().filter(|file| file.data().is_some());
        let find = |_: &str| file.cloned().ok_or_else(|| vec!["attach its file first".to_owned()]);
        Ok(manifest_json_with(&self.to_bytes()?, &find)?)
    }
}
