//! What PostgreSQL's errors mean.

use std::{error::Error as _, fmt::Write as _};

use tokio_postgres::{Error, error::SqlState};

use crate::store::StoreError;

/// Why a database cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum DatabaseOpenError {
    /// The URL cannot be read.
    #[error("the URL of the database cannot be read: {0}; it is postgres://USER:PASSWORD@HOST:PORT/NAME?sslmode=MODE")]
    BadUrl(String),
    /// The password, or the user, is refused.
    #[error("{database} refuses the user or the password: {reason}")]
    Refused {
        /// Which database.
        database: String,
        /// The server's answer.
        reason: String,
    },
    /// TLS is asked for and not to be had, or its certificate is not trusted.
    #[error(
        "{database}: {reason}; `sslmode` of the URL is `disable`, `prefer` or `require`, and certificates are always verified"
    )]
    Tls {
        /// Which database.
        database: String,
        /// What failed.
        reason: String,
    },
    /// It does not answer.
    #[error("{database} cannot be reached: {reason}")]
    Unreachable {
        /// Which database.
        database: String,
        /// Why.
        reason: String,
    },
    /// A later version of the program wrote it.
    #[error("the database has schema {found}; this program knows schemas up to {known}")]
    FromTheFuture {
        /// Its schema.
        found: usize,
        /// The newest schema this program knows.
        known: usize,
    },
    /// Its schema was made by another program.
    #[error("migration {0} differs from the one that was applied to the database")]
    Changed(usize),
    /// A statement failed.
    #[error("the database: {0}")]
    Failed(String),
}

impl From<tokio_postgres::Error> for DatabaseOpenError {
    fn from(error: tokio_postgres::Error) -> Self {
        Self::Failed(text(&error))
    }
}

/// Whether the same transaction may succeed if it is tried again soon: the connection was lost, the server is starting or
/// stopping, or two transactions stood in each other's way.
pub(super) fn is_passing(error: &Error) -> bool {
    let Some(code) = error.code() else {
        // No answer of the server's: the connection failed, except where the client itself refuses.
        return error.is_closed() || io_error(error).is_some();
    };
    let passing = [
        SqlState::ADMIN_SHUTDOWN,
        SqlState::CRASH_SHUTDOWN,
        SqlState::CANNOT_CONNECT_NOW,
        SqlState::DATABASE_DROPPED,
        SqlState::TOO_MANY_CONNECTIONS,
        SqlState::T_R_SERIALIZATION_FAILURE,
        SqlState::T_R_DEADLOCK_DETECTED,
        // A standby before it is promoted.
        SqlState::READ_ONLY_SQL_TRANSACTION,
        SqlState::QUERY_CANCELED,
        SqlState::LOCK_NOT_AVAILABLE,
    ];
    passing.contains(code) || code.code().starts_with("08")
}

fn io_error(error: &Error) -> Option<&std::io::Error> {
    let mut source = error.source();
    while let Some(cause) = source {
        if let Some(found) = cause.downcast_ref() {
            return Some(found);
        }
        source = cause.source();
    }
    None
}

/// The error for the users of the store.
pub(super) fn store_error(error: &Error) -> StoreError {
    if error.code() == Some(&SqlState::DISK_FULL) {
        return StoreError::DiskFull;
    }
    let text = text(error);
    if is_passing(error) { StoreError::Unavailable(text) } else { StoreError::Database(text) }
}

/// The error in one line: the server's own words if it has answered, otherwise all causes.
pub(super) fn text(error: &Error) -> String {
    if let Some(answer) = error.as_db_error() {
        return answer.message().replace('\n', " ");
    }
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            // Writing to a String cannot fail.
            let _ = write!(text, ": {cause_text}");
        }
        source = cause.source();
    }
    text.replace('\n', " ")
}
