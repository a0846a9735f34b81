//! An S3 server for tests: moto, a Python program. It keeps its objects in memory.

use std::{
    net::{SocketAddr, TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use crate::common::{eventually, report_skipped};

/// A running server with the bucket `tables`. It is killed when dropped.
pub(crate) struct S3 {
    child: Child,
    pub(crate) address: SocketAddr,
}

impl S3 {
    /// Starts the server. Prints a message and returns `None` if moto is not installed.
    pub(crate) fn start() -> Option<Self> {
        let Some(python) = python() else {
            report_skipped("there is no Python with moto[server] here; `make cluster` installs it");
            return None;
        };
        // The port is free now, and it is unlikely that another process takes it.
        let free = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = free.local_addr().expect("its address");
        drop(free);
        let mut command = Command::new(python);
        command.args(["-m", "moto.server", "-H", "127.0.0.1", "-p", &address.port().to_string()]);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("Python");
        let server = Self { child, address };
        eventually("the S3 server", || TcpStream::connect(address).ok());
        let made = ureq::put(format!("http://{address}/tables")).send_empty().expect("a bucket");
        assert!(made.status().is_success());
        Some(server)
    }

    /// Environment variables for a process that uses the server at `address`, which can be the address of a proxy.
    pub(crate) fn environment(address: SocketAddr) -> Vec<(String, String)> {
        let variable = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
        let mut all: Vec<_> = [
            ("AWS_ACCESS_KEY_ID", "test"),
            ("AWS_SECRET_ACCESS_KEY", "hunter2hunter2"),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ALLOW_HTTP", "true"),
        ]
        .map(variable)
        .into();
        all.push(variable(("AWS_ENDPOINT", &format!("http://{address}"))));
        all
    }
}

impl Drop for S3 {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A Python with moto: from `make cluster`, or from `PATH`.
fn python() -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_BIN_EXE_ltcforge")).ancestors().nth(2)?;
    let has_moto = |python: &PathBuf| {
        let mut command = Command::new(python);
        command.args(["-c", "import moto.server, moto.s3"]).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    [target.join("s3/bin/python"), PathBuf::from("python3")].into_iter().find(has_moto)
}
