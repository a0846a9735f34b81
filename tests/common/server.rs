//! A running service.

use std::{
    io::{BufRead as _, BufReader, Read as _},
    path::Path,
    process::{Child, Command, Stdio},
    sync::mpsc,
    thread::{self, JoinHandle},
};

use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
use serde_json::Value;
use tempfile::TempDir;
use ureq::{Agent, Body, http::Response};

use super::{
    DEADLINE,
    command::{Run, ltcforge, signal},
    eventually, openapi,
};

/// The largest body of a response, in bytes.
const MOST_BODY: u64 = 100 << 20;

/// A service on a free port. It is killed when dropped.
#[derive(Debug)]
pub(crate) struct Server {
    child: Child,
    /// Its URL, for example `http://127.0.0.1:40000`.
    pub(crate) url: String,
    stderr: Option<JoinHandle<String>>,
    agent: Agent,
    /// The working folder of the service. It has no `ltcforge.toml`.
    _folder: TempDir,
}

/// A response, already checked against `openapi.yaml`.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    /// Header fields, with names in lower case.
    pub(crate) headers: Vec<(String, String)>,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// The value of a header field.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(other, _)| other == name).map(|(_, value)| value.as_str())
    }

    /// The body as JSON.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Checks that the response has `status`, and returns it.
    #[track_caller]
    pub(crate) fn with_status(self, status: u16) -> Self {
        assert_eq!(self.status, status, "{}", String::from_utf8_lossy(&self.body));
        self
    }
}

impl Server {
    /// Starts a service on the store in `data` with additional arguments.
    pub(crate) fn start(data: &Path, args: &[&str]) -> Self {
        let data = data.to_str().expect("a path in UTF-8");
        let fixed = ["serve", "--listen", "127.0.0.1:0", "--data", data];
        let folder = tempfile::tempdir().expect("a folder");
        let command = ltcforge(folder.path(), fixed.iter().chain(args));
        Self::of(command, folder)
    }

    /// Starts a service with additional environment variables.
    pub(crate) fn start_in(data: &Path, args: &[&str], environment: &[(String, String)]) -> Self {
        let data = data.to_str().expect("a path in UTF-8");
        let fixed = ["serve", "--listen", "127.0.0.1:0", "--data", data];
        let folder = tempfile::tempdir().expect("a folder");
        let mut command = ltcforge(folder.path(), fixed.iter().chain(args));
        command.envs(environment.iter().map(|(name, value)| (name, value)));
        Self::of(command, folder)
    }

    /// Starts a service with at most `descriptors` file descriptors.
    pub(crate) fn start_within(descriptors: u32, data: &Path, args: &[&str]) -> Self {
        let data = data.to_str().expect("a path in UTF-8");
        let folder = tempfile::tempdir().expect("a folder");
        let plain = ltcforge(folder.path(), ["serve", "--listen", "127.0.0.1:0", "--data", data].iter().chain(args));
        // Only a shell can set this limit for a single child process.
        let mut command = limited(&plain, descriptors);
        command.current_dir(folder.path());
        Self::of(command, folder)
    }

    /// Starts a service through another program with arguments `words`. The service is the child process.
    pub(crate) fn start_under(program: &str, words: &[&str], data: &Path, args: &[&str]) -> Self {
        let data = data.to_str().expect("a path in UTF-8");
        let folder = tempfile::tempdir().expect("a folder");
        let plain = ltcforge(folder.path(), ["serve", "--listen", "127.0.0.1:0", "--data", data].iter().chain(args));
        let mut under = Command::new(program);
        under.args(words);
        let mut command = wrapped(under, &plain);
        command.current_dir(folder.path());
        Self::of(command, folder)
    }

    /// Starts a service on the store in `data`. The error is the run of a service that failed to start.
    pub(crate) fn attempt(data: &Path, args: &[&str]) -> Result<Self, Run> {
        let folder = tempfile::tempdir().expect("a folder");
        let data = data.to_str().expect("a path in UTF-8");
        let command = ltcforge(folder.path(), ["serve", "--listen", "127.0.0.1:0", "--data", data].iter().chain(args));
        Self::try_of(command, folder)
    }

    /// Runs `command`, which starts a service, in `folder`.
    #[track_caller]
    fn of(command: Command, folder: TempDir) -> Self {
        Self::try_of(command, folder).unwrap_or_else(|run| panic!("the service did not start: {run:#?}"))
    }

    fn try_of(mut command: Command, folder: TempDir) -> Result<Self, Run> {
        let mut child = command.spawn().expect("the binary runs");
        let mut pipe = child.stderr.take().expect("a pipe");
        let stderr = thread::spawn(move || {
            let mut text = String::new();
            // The log is read up to the first bytes that are not UTF-8.
            let _ = pipe.read_to_string(&mut text);
            text
        });
        let mut pipe = child.stdout.take().expect("a pipe");
        let (sender, line) = mpsc::channel();
        thread::spawn(move || {
            let mut line = String::new();
            // A service that exits prints no line.
            let _ = BufReader::new(&mut pipe).read_line(&mut line);
            let _ = sender.send(line);
        });
        let line = line.recv_timeout(DEADLINE).unwrap_or_else(|_| {
            // The service hangs.
            let _ = child.kill();
            "no output in time".to_owned()
        });
        let Some(url) = line.trim().strip_prefix("listening on ") else {
            let (code, stderr) = (child.wait().expect("its end").code(), stderr.join().expect("its stderr"));
            return Err(Run { code, stdout: line, stderr });
        };
        Ok(Self { url: url.to_owned(), child, stderr: Some(stderr), agent: agent(), _folder: folder })
    }

    /// The stream of a job's events.
    #[track_caller]
    pub(crate) fn events(&self, id: &str, last_event_id: Option<&str>) -> Response<Body> {
        let mut request = self.agent.get(format!("{}/v1/jobs/{id}/events", self.url));
        if let Some(last) = last_event_id {
            request = request.header("last-event-id", last);
        }
        request.call().expect("a stream")
    }

    /// A `GET` request of a path.
    #[track_caller]
    pub(crate) fn get(&self, path: &str) -> Answer {
        self.request("GET", path, &[], None)
    }

    /// Submits a recipe document.
    #[track_caller]
    pub(crate) fn submit(&self, recipe: &str) -> Answer {
        self.request("POST", "/v1/jobs", &[("content-type", "application/json")], Some(recipe.as_bytes()))
    }

    /// Sends a request and checks the response against `openapi.yaml`.
    #[track_caller]
    pub(crate) fn request(&self, method: &str, path: &str, fields: &[(&str, &str)], body: Option<&[u8]>) -> Answer {
        let mut request = ureq::http::Request::builder().method(method).uri(format!("{}{path}", self.url));
        for (name, value) in fields {
            request = request.header(*name, *value);
        }
        let sent = match body {
            Some(body) => self.agent.run(request.body(body).expect("a request")),
            None => self.agent.run(request.body(()).expect("a request")),
        };
        let mut response = sent.unwrap_or_else(|error| panic!("{method} {path}: {error}"));
        let field = |(name, value): (&ureq::http::HeaderName, &ureq::http::HeaderValue)| {
            (name.as_str().to_owned(), value.to_str().expect("a field in ASCII").to_owned())
        };
        let answer = Answer {
            status: response.status().as_u16(),
            headers: response.headers().iter().map(field).collect(),
            body: response.body_mut().with_config().limit(MOST_BODY).read_to_vec().expect("a whole body"),
        };
        openapi::check(method, path, &answer);
        answer
    }

    /// Waits until the job `id` satisfies `is_there`, and returns it.
    pub(crate) fn job_when(&self, id: &str, is_there: impl Fn(&Value) -> bool) -> Value {
        eventually("the job's state", || {
            let job = self.get(&format!("/v1/jobs/{id}")).with_status(200).json();
            is_there(&job).then_some(job)
        })
    }

    /// Waits until the job `id` is in a final state, and returns it.
    pub(crate) fn finished(&self, id: &str) -> Value {
        self.job_when(id, |job| job["state"] != "queued" && job["state"] != "running")
    }

    /// Submits a recipe and returns the digest of its table.
    #[track_caller]
    pub(crate) fn fit(&self, recipe: &str) -> String {
        let job = self.submit(recipe).json();
        let job = self.finished(text(&job["id"]));
        assert_eq!(job["state"], "done", "{job:#}");
        text(&job["table"]).to_owned()
    }

    /// The value of a metric in `/metrics`.
    #[track_caller]
    pub(crate) fn metric(&self, name: &str) -> u64 {
        let body = self.get("/metrics").with_status(200).body;
        let text = String::from_utf8(body).expect("metrics in UTF-8");
        let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        value.unwrap_or_else(|| panic!("no {name} in\n{text}")).parse().expect("a count")
    }

    /// The number of open file descriptors.
    pub(crate) fn descriptors(&self) -> usize {
        let folder = format!("/proc/{}/fd", self.child.id());
        std::fs::read_dir(folder).expect("a running service on Linux").count()
    }

    /// The peak memory of the process, in bytes.
    pub(crate) fn most_memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).expect("Linux");
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line");
        line.split_whitespace().next().and_then(|kilobytes| kilobytes.parse::<u64>().ok()).expect("a number") * 1024
    }

    /// The number of bytes that the process has read from files and connections.
    pub(crate) fn bytes_read(&self) -> u64 {
        let io = std::fs::read_to_string(format!("/proc/{}/io", self.child.id())).expect("Linux");
        let read = io.lines().find_map(|line| line.strip_prefix("rchar: "));
        read.and_then(|bytes| bytes.parse().ok()).expect("a number")
    }

    /// Kills the process with SIGKILL.
    pub(crate) fn kill(mut self) {
        self.child.kill().expect("a running service");
        self.child.wait().expect("its end");
    }

    /// Kills the process and returns its log.
    pub(crate) fn kill_and_read(mut self) -> String {
        self.child.kill().expect("a running service");
        self.child.wait().expect("its end");
        self.stderr.take().map(|thread| thread.join().expect("its stderr")).unwrap_or_default()
    }

    /// Peak memory in MiB, since the start of the process or since [`Self::forget_peak_memory`].
    pub(crate) fn peak_memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).expect("a process on Linux");
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("its peak");
        line.split_whitespace().next().and_then(|kibibytes| kibibytes.parse::<u64>().ok()).expect("a number") >> 10
    }

    /// Resets the peak memory.
    pub(crate) fn forget_peak_memory(&self) {
        std::fs::write(format!("/proc/{}/clear_refs", self.child.id()), "5").expect("a process of ours");
    }

    /// Processor time in seconds. The process may have ended, if nothing has waited for it yet.
    pub(crate) fn processor_seconds(&self) -> f64 {
        /// `USER_HZ` of every Linux.
        const TICKS: f64 = 100.0;
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).expect("a process on Linux");
        let (_, fields) = stat.rsplit_once(')').expect("a name in parentheses");
        let fields: Vec<&str> = fields.split_whitespace().collect();
        [11, 12].map(|index| fields[index].parse::<f64>().expect("ticks")).iter().sum::<f64>() / TICKS
    }

    /// Stops the process with a signal. Returns the run, and the processor time from the signal to the end, in seconds.
    pub(crate) fn stop_and_measure(self, by: &str) -> (Run, f64) {
        let before = self.processor_seconds();
        signal(&self.child, by);
        let id = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw).expect("an id");
        // NOWAIT keeps the times of the ended process available.
        waitid(WaitId::Pid(id), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT).expect("a child");
        let seconds = self.processor_seconds() - before;
        (self.ended(), seconds)
    }

    /// Stops the process with a signal and waits for its end.
    pub(crate) fn stop(self, by: &str) -> Run {
        signal(&self.child, by);
        self.ended()
    }

    fn ended(mut self) -> Run {
        let status = self.child.wait().expect("its end");
        let stderr = self.stderr.take().map(|thread| thread.join().expect("its stderr")).unwrap_or_default();
        Run { code: status.code(), stdout: String::new(), stderr }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs `command` in a shell that limits it to `descriptors` file descriptors.
fn limited(command: &Command, descriptors: u32) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -n {descriptors} && exec \"$@\""), "sh"]);
    wrapped(shell, command)
}

/// Appends `command` as arguments to another program.
fn wrapped(mut shell: Command, command: &Command) -> Command {
    shell.arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    shell.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    shell
}

/// A client that returns every status, uses no proxy and has a timeout.
fn agent() -> Agent {
    Agent::config_builder().http_status_as_error(false).proxy(None).timeout_global(Some(DEADLINE)).build().into()
}

/// A JSON string.
#[track_caller]
pub(crate) fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("no string: {value}"))
}
