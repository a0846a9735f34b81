//! Converts errors of PostgreSQL, and decides which errors are temporary.

use std::{error::Error as _, fmt::Write as _, iter::successors};

use tokio_postgres::{Error, error::SqlState};

use crate::store::{ConnectError, StoreError};

impl From<Error> for ConnectError {
    fn from(error: Error) -> Self {
        Self(format!("the database: {}", text(&error)))
    }
}

/// Whether a transaction may succeed if it is retried soon. Examples: the connection was lost, two transactions
/// conflicted, or the server is starting, stopping or has no free connection.
pub(super) fn is_temporary(error: &Error) -> bool {
    let Some(code) = error.code() else {
        // Without a code, the error is not from the server. It is temporary if the connection failed.
        return error.is_closed() || causes(error).any(<dyn std::error::Error + 'static>::is::<std::io::Error>);
    };
    let temporary = [
        SqlState::ADMIN_SHUTDOWN,
        SqlState::CRASH_SHUTDOWN,
        SqlState::CANNOT_CONNECT_NOW,
        SqlState::DATABASE_DROPPED,
        SqlState::TOO_MANY_CONNECTIONS,
        SqlState::T_R_SERIALIZATION_FAILURE,
        SqlState::T_R_DEADLOCK_DETECTED,
        // The server is a standby that is not promoted yet.
        SqlState::READ_ONLY_SQL_TRANSACTION,
        SqlState::QUERY_CANCELED,
        SqlState::LOCK_NOT_AVAILABLE,
        SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT,
    ];
    temporary.contains(code) || code.code().starts_with("08")
}

fn causes(error: &Error) -> impl Iterator<Item = &(dyn std::error::Error + 'static)> {
    successors(error.source(), |cause: &&(dyn std::error::Error + 'static)| (*cause).source())
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

/// The text of an error in one line: the server's message if there is one, otherwise the error with all its causes.
pub(super) fn text(error: &Error) -> String {
    if let Some(answer) = error.as_db_error() {
        return answer.message().replace('\n', " ");
    }
    let mut text = error.to_string();
    for cause in causes(error) {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            // Writing to a String cannot fail.
            let _ = write!(text, ": {cause_text}");
        }
    }
    text.replace('\n', " ")
}
