//! Errors of PostgreSQL, and which of them are temporary.

use std::{error::Error as _, fmt::Write as _};

use tokio_postgres::{Error, error::SqlState};

use crate::store::StoreError;

/// Why a database cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum DatabaseOpenError {
    /// The URL is invalid.
    #[error("the database URL is invalid: {0}; use postgres://USER:PASSWORD@HOST:PORT/NAME?sslmode=MODE")]
    BadUrl(String),
    /// The server refuses the user or the password.
    #[error("{database} refuses the user or the password: {reason}")]
    Refused {
        /// Which database.
        database: String,
        /// The server's answer.
        reason: String,
    },
    /// The server requires TLS or does not support it, or its certificate is not trusted.
    #[error("{database}: {reason}; `sslmode` is `disable`, `prefer` or `require`; certificates are always verified")]
    Tls {
        /// Which database.
        database: String,
        /// The reason, in words.
        reason: String,
    },
    /// It does not respond.
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
    /// It has not the schema of this program, and this operation changes nothing.
    #[error(
        "the database has schema {found}, and nothing is changed here to make it {needed}: start `ltcforge serve` or \
         `ltcforge work` of this version on it once"
    )]
    Older {
        /// Its schema; 0 without one.
        found: usize,
        /// That of this program.
        needed: usize,
    },
    /// Another program made its schema.
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

/// Whether the server has as many connections as it may have, as a whole, of the role or to the database.
pub(super) fn is_without_room(error: &Error) -> bool {
    error.code() == Some(&SqlState::TOO_MANY_CONNECTIONS)
}

/// Whether the same transaction may succeed if it is retried soon: the connection was lost, the server is starting or
/// stopping, or two transactions conflicted.
pub(super) fn is_temporary(error: &Error) -> bool {
    let Some(code) = error.code() else {
        // The server did not answer: the connection failed, unless the client itself found the error.
        return error.is_closed() || io_error(error).is_some();
    };
    let temporary = [
        SqlState::ADMIN_SHUTDOWN,
        SqlState::CRASH_SHUTDOWN,
        SqlState::CANNOT_CONNECT_NOW,
        SqlState::DATABASE_DROPPED,
        SqlState::TOO_MANY_CONNECTIONS,
        SqlState::T_R_SERIALIZATION_FAILURE,
        SqlState::T_R_DEADLOCK_DETECTED,
        // A standby that is not promoted yet.
        SqlState::READ_ONLY_SQL_TRANSACTION,
        SqlState::QUERY_CANCELED,
        SqlState::LOCK_NOT_AVAILABLE,
        SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT,
    ];
    temporary.contains(code) || code.code().starts_with("08")
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

impl From<Error> for StoreError {
    fn from(error: Error) -> Self {
        if error.code() == Some(&SqlState::DISK_FULL) {
            return Self::DiskFull;
        }
        let text = text(&error);
        if error.code() == Some(&SqlState::INSUFFICIENT_PRIVILEGE) {
            return Self::Refused(text);
        }
        if is_temporary(&error) { Self::Unavailable(text) } else { Self::Database(text) }
    }
}

/// The error in one line: the server's message if it has answered, otherwise all causes.
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
