//! The overhead of the service over a plain fit and a plain download.
//!
//! `cargo bench -p ltcforge-benches --bench service`. The bench compares the processor time of a job with that of a fit
//! of the same recipe, which is encoded and measured without a service. It compares a download with a download from a
//! bare server that reads, hashes and sends the same file over the same kind of connection. Both sides take turns, so a
//! busy machine slows both.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{SocketAddr, TcpListener, TcpStream},
    ops::ControlFlow,
    path::Path,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use ltcforge::{
    files::{
        container,
        digest::Digest,
        manifest::manifest_json,
        recipe_document::{self, DEFAULT_ENTRY_LIMIT},
    },
    fit::{Plan, fit_plan},
    server::{
        http::{Options, serve},
        service::Service,
    },
};

mod default_config;

use default_config::config;

/// Turns for each side of a comparison.
const JOBS: u32 = 7;
const DOWNLOADS: u32 = 15;
/// Downloads per turn.
const REPEATED: u32 = 100;

/// A recipe for the default table. It was not fitted before.
fn recipe(seed: u32) -> String {
    format!(r#"{{"preset":"draft","fit":{{"seed":{seed}}}}}"#)
}

/// The processor time of this process, in seconds.
fn processor_seconds() -> f64 {
    /// `USER_HZ` on every Linux.
    const TICKS: f64 = 100.0;
    let stat = fs::read_to_string("/proc/self/stat").expect("Linux");
    let (_, fields) = stat.rsplit_once(')').expect("a name in parentheses");
    let fields: Vec<&str> = fields.split_whitespace().collect();
    [11, 12].map(|index| fields[index].parse::<f64>().expect("ticks")).iter().sum::<f64>() / TICKS
}

/// A client with one connection.
struct Client(BufReader<TcpStream>);

impl Client {
    fn new(address: SocketAddr) -> Self {
        let tcp = TcpStream::connect(address).expect("a connection");
        tcp.set_nodelay(true).expect("a socket");
        Self(BufReader::new(tcp))
    }

    /// Sends a request and returns the body of the response.
    fn ask(&mut self, method: &str, path: &str, body: &str) -> Vec<u8> {
        let tcp = self.0.get_mut();
        let host = tcp.peer_addr().expect("an address");
        let head = format!("{method} {path} HTTP/1.1\r\nhost: {host}\r\ncontent-length: {}\r\n\r\n{body}", body.len());
        tcp.write_all(head.as_bytes()).expect("a service");
        let mut length = 0;
        loop {
            let mut line = String::new();
            self.0.read_line(&mut line).expect("a head");
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().expect("a length");
            }
            if line.trim().is_empty() {
                break;
            }
        }
        self.read(length)
    }

    fn read(&mut self, length: usize) -> Vec<u8> {
        let mut body = vec![0; length];
        self.0.read_exact(&mut body).expect("a whole body");
        body
    }

    /// Submits a recipe, waits for the job, and returns the table's digest.
    fn fit(&mut self, recipe: &str) -> String {
        let job = self.ask("POST", "/v1/jobs", recipe);
        let id = text(&job, "id");
        loop {
            let job = self.ask("GET", &format!("/v1/jobs/{id}"), "");
            match text(&job, "state").as_str() {
                "done" => return text(&job, "table"),
                "queued" | "running" => thread::sleep(Duration::from_millis(20)),
                other => panic!("the job is {other}"),
            }
        }
    }
}

/// The text of a field in a JSON object from the service.
fn text(json: &[u8], name: &str) -> String {
    let json = String::from_utf8_lossy(json);
    let (_, rest) = json.split_once(&format!("\"{name}\":\"")).unwrap_or_else(|| panic!("no {name} in {json}"));
    rest.split('"').next().unwrap_or_default().to_owned()
}

/// The work of `ltcforge fit`, without its output.
fn fit_directly(pool: &rayon::ThreadPool, recipe: &str) -> usize {
    let recipe = recipe_document::parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe");
    pool.install(|| {
        let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
        let file = container::encode(&recipe, &table).expect("a file");
        manifest_json(&file).expect("a manifest").len()
    })
}

/// A server that responds to each byte with the contents of the file. It reads and hashes the file again each time.
fn bare_server(path: &Path) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let (address, path) = (listener.local_addr().expect("an address"), path.to_owned());
    thread::spawn(move || {
        let (mut tcp, _) = listener.accept().expect("a client");
        tcp.set_nodelay(true).expect("a socket");
        let mut request = [0];
        while tcp.read_exact(&mut request).is_ok() {
            let bytes = fs::read(&path).expect("a file");
            assert!(path.ends_with(Digest::of(&bytes).hex()), "the file is damaged");
            tcp.write_all(&bytes).expect("a client");
        }
    });
    address
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Prints the times of both sides, and the overhead of the service in per cent.
fn compare(name: &str, unit: &str, [plain, service]: [Vec<f64>; 2]) {
    let ratios = plain.iter().zip(&service).map(|(plain, service)| service / plain).collect();
    let part = 100.0 * (median(ratios) - 1.0);
    let least_part = 100.0 * (least(&service) / least(&plain) - 1.0);
    let [plain, service] = [plain, service].map(|values| (least(&values), median(values)));
    println!(
        "{name}: {:.4} {unit} without the service, {:.4} with it (medians; least {:.4}, {:.4})",
        plain.1, service.1, plain.0, service.0
    );
    println!("{name}: {part:+.1} % from the median of the turns, {least_part:+.1} % from the least of each side");
}

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let workers = thread::available_parallelism().expect("cores");
    let service = Service::open(config(folder.path(), workers.get()));
    let service = service.expect("a service");
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let listener = runtime.block_on(tokio::net::TcpListener::bind("127.0.0.1:0")).expect("a port");
    let address = listener.local_addr().expect("an address");
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let shutdown = async {
        // The service stops when the sender is dropped at the end.
        let _ = stopped.await;
    };
    let serving = runtime.spawn(serve(listener, Arc::clone(&service), Options::default(), shutdown));
    let mut client = Client::new(address);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(workers.get()).build().expect("threads");

    let mut digest = client.fit(&recipe(0));
    fit_directly(&pool, &recipe(0));
    let mut times = [vec![], vec![]];
    for turn in 1..=JOBS {
        let recipe = recipe(turn);
        let start = processor_seconds();
        fit_directly(&pool, &recipe);
        let middle = processor_seconds();
        digest = client.fit(&recipe);
        times[0].push(middle - start);
        times[1].push(processor_seconds() - middle);
    }
    compare("a job", "s of processor time", times);

    let hex = digest.trim_start_matches("sha256:");
    let blob = folder.path().join("blobs").join(&hex[..2]).join(hex);
    let bytes = fs::metadata(&blob).expect("a table").len() as usize;
    let mut bare = Client::new(bare_server(&blob));
    let mut times = [vec![], vec![]];
    for turn in 0..=DOWNLOADS {
        let start = Instant::now();
        for _ in 0..REPEATED {
            bare.0.get_mut().write_all(b"x").expect("a server");
            assert_eq!(bare.read(bytes).len(), bytes);
        }
        let middle = Instant::now();
        for _ in 0..REPEATED {
            assert_eq!(client.ask("GET", &format!("/v1/tables/{digest}"), "").len(), bytes);
        }
        // The first turn is a warm-up.
        if turn > 0 {
            let each = |time: Duration| 1e3 * time.as_secs_f64() / f64::from(REPEATED);
            times[0].push(each(middle - start));
            times[1].push(each(middle.elapsed()));
        }
    }
    compare(&format!("a download of {bytes} bytes"), "ms", times);

    drop((client, stop));
    runtime.block_on(serving).expect("the end of the service").expect("it was served");
    service.stop();
}
