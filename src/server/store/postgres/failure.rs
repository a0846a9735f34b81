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
        /// The database.
        database: String,
        /// The server's answer.
        reason: String,
    },
    /// The server requires TLS or does not support it, or its certificate is not trusted.
    #[error("{database}: {reason}; `sslmode` is `disable`, `prefer` or `require`; certificates are always verified")]
    Tls {
        /// The database.
        database: String,
        /// The reason, in words.
        reason: String,
    },
    /// It does not respond.
    #[error("{database} cannot be reached: {reason}")]
    Unreachable {
        /// The database.
        database: String,
        /// The reason.
        reason: String,
    },
    /// A later version of the program wrote it.
    #[error("the database has schema {found}; this program knows schemas up to {known}")]
    FromTheFuture {
        /// Its schema.
        found: usize,
        /// The newest schema that this program knows.
        known: usize,
    },
    /// An unreleased version of the program, or another program, made its schema.
    #[error(
        "the schema `ltcforge` in the database is of an unreleased version: use an empty database, or remove the schema \
         with DROP SCHEMA ltcforge CASCADE; tables are not in it"
    )]
    Other,
    /// A statement failed.
    #[error("the database: {0}")]
    Failed(String),
}

impl From<Error> for DatabaseOpenError {
    fn from(error: Error) -> Self {
        Self::Failed(text(&error))
    }
}

/// Whether the same transaction may succeed if it is retried soon: the connection was lost, the server is starting,
/// stopping or has no free connection, or two transactions conflicted.
pub(super) fn is_temporary(error: &Error) -> bool {
    let Some(code) = error.code() else {
        // The server did not answer: the connection failed, unless the client itself found the error.
        return error.is_closed() || is_io(error);
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

fn is_io(error: &Error) -> bool {
    let mut source = error.source();
    while let Some(cause) = source {
        if cause.is::<std::io::Error>() {
            return true;
        }
        source = cause.source();
    }
    false
}

impl From<Error> for StoreError {
    fn from(error: Error) -> Self {
        let text = text(&error);
        match error.code() {
            Some(code) if *code == SqlState::DISK_FULL => Self::DiskFull,
            Some(code) if *code == SqlState::INSUFFICIENT_PRIVILEGE => Self::Refused(text),
            _ if is_temporary(&error) => Self::Unavailable(text),
            _ => Self::Database(text),
        }
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
