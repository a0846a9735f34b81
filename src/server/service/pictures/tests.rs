use std::{
    num::NonZeroUsize,
    ops::ControlFlow,
    path::Path,
    sync::{
        Arc,
        mpsc::{self, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use super::{
    picture::CPU,
    queue::{Outcome, PendingPicture, PictureQueue, PictureRequest},
    render_loop::{Render, Task, run},
    *,
};
use crate::service::{Config, PictureCounts, PictureLimits, Service, ServiceError};
use ltcforge_files::{container, digest::Digest, recipe_document};
use ltcforge_fit::{Plan, assemble, fit_shard};
use ltcforge_view::{
    plots::Plot,
    preview::{Adapter, Mode, Scene},
};

const SECOND: Duration = Duration::from_secs(1);
const MINUTE: Duration = Duration::from_secs(60);

/// A service with one blob, which is not a table.
fn start(folder: &Path, time: Duration) -> (Arc<Service>, Digest) {
    let service = Service::open(Config {
        data_dir: folder.to_owned(),
        workers: NonZeroUsize::MIN,
        queue_limit: 1,
        entry_limit: 100,
        job_seconds: 86_400,
        keep_ended: None,
        most_ended: None,
        store_bytes: None,
        unused_for: Duration::ZERO,
        lease_ttl: Duration::from_secs(60),
        max_attempts: 1,
        adapter: Adapter::Cpu,
        pictures: PictureLimits { time, ..PictureLimits::default() },
        brdf_limit: 1,
        light_texture_limit: 1,
        export_bytes: 0,
    });
    let service = service.expect("a service");
    let digest = service.state.tables.store.blobs.put(b"no table").expect("a blob");
    (service, digest)
}

/// A service with a table.
fn start_with_table(folder: &Path, time: Duration) -> (Arc<Service>, Digest) {
    let (service, _) = start(folder, time);
    let recipe = r#"{"preset": "draft", "resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 2},
        "fit": {"samples": 64, "directions": 4, "steps": 1}}"#;
    let recipe = recipe_document::parse(recipe.as_bytes(), 100).expect("a recipe");
    let plan = Plan::new(&recipe);
    let go_on = &mut |_: u64| ControlFlow::Continue(());
    let entries = fit_shard(&plan, 0, go_on).expect("not interrupted");
    let file = container::encode(&recipe, &assemble(&plan, &entries)).expect("a file");
    let digest = service.state.tables.store.blobs.put(&file).expect("a blob");
    (service, digest)
}

fn block_on<T>(future: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime").block_on(future)
}

fn file(pending: PendingPicture) -> Outcome {
    block_on(pending.file())
}

/// Requests a picture that is not in memory.
fn pending(service: &Service, table: Digest, subject: Subject) -> PendingPicture {
    let reply = service.picture(Some(table), subject, |_| false).expect("a reply");
    let PictureReply::Pending(pending) = reply else { panic!("it was rendered before: {reply:?}") };
    pending
}

/// A reference on so many pixels a side, with so many samples a pixel.
fn reference(size: u32, spp: u32) -> Subject {
    Subject::Scene(Box::new(Scene { mode: Mode::Reference, size, spp, ..Scene::default() }))
}

#[test]
fn no_picture_is_rendered_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let scene = || Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let first = file(pending(&service, table, scene())).expect("a picture");
    for is_known in [false, true] {
        let again = service.picture(Some(table), scene(), |_| is_known).expect("a reply");
        let PictureReply::Ready(again) = again else { panic!("it is in memory: {again:?}") };
        assert!(Arc::ptr_eq(&again.bytes, &first.bytes) && again.tag == first.tag);
    }
    // The caller has a picture that is not in memory.
    let known = service.picture(Some(table), reference(2048, 1), |_| true).expect("a reply");
    assert!(matches!(&known, PictureReply::Known { adapter, .. } if **adapter == *"cpu"), "{known:?}");
    assert_eq!(service.state.pictures.counts().done, 1);
}

#[test]
fn a_picture_that_is_not_ready_in_time_is_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), Duration::ZERO);
    let error = file(pending(&service, digest, Subject::Plot(Plot::Matrix))).expect_err("no picture");
    assert!(matches!(error, PictureError::TooSlow { limit: Duration::ZERO, .. }), "{error:?}");
    service.stop();
    let closed = service.picture(Some(digest), Subject::Plot(Plot::Matrix), |_| false);
    assert!(matches!(closed, Err(PictureError::Stopping)), "{closed:?}");
}

#[test]
fn a_blob_that_is_not_a_table_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), MINUTE);
    let error = file(pending(&service, digest, Subject::Plot(Plot::Matrix))).expect_err("no picture");
    assert!(matches!(error, PictureError::Store(ServiceError::Storage(_))), "{error:?}");
    assert!(error.to_string().contains(&digest.to_string()), "{error}");
}

#[test]
fn a_picture_of_too_many_samples_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), SECOND);
    let largest = || Subject::Scene(Box::new(Scene { mode: Mode::Strip, size: 2048, spp: 4096, ..Scene::default() }));
    let refused = service.picture(Some(table), largest(), |_| false).expect_err("a refusal");
    let PictureError::TooExpensive { samples, limit } = refused else { panic!("{refused:?}") };
    assert!(samples == 2048.0 * 2048.0 * (4096.0 + 8.0) && limit < samples, "{samples} {limit}");
    let text = refused.to_string();
    let names_both = text.contains("17213.4 million samples") && text.contains(&format!("{:.1} million;", limit / 1e6));
    assert!(names_both && text.contains("`--picture-seconds`"), "{text}");
    // A picture that the caller has already is not rendered, so it is not refused either.
    let known = service.picture(Some(table), largest(), |_| true);
    assert!(matches!(known, Ok(PictureReply::Known { .. })), "{known:?}");
    let counts = service.state.pictures.counts();
    assert_eq!(counts, PictureCounts { refused: 1, ..PictureCounts::default() });
}

#[test]
fn the_samples_that_are_accepted_depend_on_the_adapter_and_the_time() {
    let refused = |subject: &Subject, adapter: Option<&str>, time| subject.check_cost(adapter, time).is_err();
    let largest = reference(2048, 4096);
    assert!(!refused(&largest, None, 30 * SECOND) && !refused(&largest, Some("a GPU"), 30 * SECOND));
    assert!(refused(&largest, None, SECOND) && !refused(&reference(512, 64), Some("cpu"), 10 * SECOND));
    for cpu in ["cpu", "llvmpipe (LLVM 19.1.7, 256 bits)"] {
        assert!(refused(&largest, Some(cpu), SECOND) && !refused(&largest, Some(cpu), 1440 * MINUTE), "{cpu}");
    }
    let plot = Subject::Plot(Plot::error_from([]).expect("a plot"));
    assert!(plot.cost() > 0.0 && !refused(&plot, Some("cpu"), Duration::ZERO));
}

/// A queue without a thread.
fn queue(limits: PictureLimits) -> Arc<PictureQueue> {
    Arc::new(PictureQueue::new(Adapter::Any, limits))
}

/// Requests a picture, under a key of its own for each size.
fn add(queue: &PictureQueue, size: u32) -> Result<PendingPicture, PictureError> {
    let key = Digest::of(&size.to_le_bytes());
    queue.add(PictureRequest::new(key, None, reference(size, 1)), || Ok(()))
}

fn added(queue: &PictureQueue, size: u32) -> PendingPicture {
    add(queue, size).expect("room")
}

fn size(request: &PictureRequest) -> u32 {
    let Subject::Scene(scene) = &request.subject else { panic!("not a scene: {request:?}") };
    scene.size
}

fn next(queue: &PictureQueue) -> Option<u32> {
    queue.next().map(|request| size(&request))
}

/// A picture of so many bytes.
fn picture(bytes: usize) -> PictureFile {
    PictureFile { bytes: Arc::new(vec![0; bytes]), adapter: CPU.into(), tag: Digest::of(b"") }
}

#[test]
fn the_cheapest_picture_is_next() {
    let queue = queue(PictureLimits::default());
    let _waiting = [300, 100, 200, 150].map(|size| added(&queue, size));
    assert_eq!([100, 150, 200, 300], [(); 4].map(|()| next(&queue).expect("a request")));
}

#[test]
fn a_picture_that_was_overtaken_eight_times_is_next() {
    let queue = queue(PictureLimits { queue: NonZeroUsize::new(20).expect("not 0"), ..PictureLimits::default() });
    let mut waiting = vec![added(&queue, 300), added(&queue, 200)];
    for size in 100..108 {
        waiting.push(added(&queue, size));
        assert_eq!(next(&queue), Some(size));
    }
    waiting.push(added(&queue, 108));
    assert_eq!([300, 200, 108], [(); 3].map(|()| next(&queue).expect("a request")));
}

#[test]
fn a_full_queue_refuses_all_but_equal_requests_and_those_that_go_make_room() {
    let queue = queue(PictureLimits::default());
    let rendered = added(&queue, 64);
    let rendering = queue.next().expect("a request");
    let mut waiting: Vec<_> = (65..73).map(|size| added(&queue, size)).collect();
    let is_full = |size| matches!(add(&queue, size), Err(PictureError::QueueFull { limit: 9, .. }));
    assert!(is_full(73));
    let same = added(&queue, 72);
    drop(waiting.pop());
    assert!(is_full(73), "another caller waits for 72");
    drop(same);
    waiting.push(added(&queue, 73));
    assert!(is_full(74));
    queue.finish(&rendering, Ok(picture(1)));
    file(rendered).expect("a picture");
    waiting.push(added(&queue, 74));
    let counts = queue.state().counts;
    assert_eq!(counts, PictureCounts { done: 1, failed: 0, given_up: 1, refused: 3 });
}

#[test]
fn all_who_wait_for_a_picture_get_it() {
    let queue = queue(PictureLimits::default());
    let both = [added(&queue, 64), added(&queue, 64)];
    queue.finish(&queue.next().expect("a request"), Ok(picture(1)));
    for pending in both {
        file(pending).expect("a picture");
    }
}

#[test]
fn a_waiting_picture_ends_with_the_service() {
    let queue = queue(PictureLimits::default());
    let pending = added(&queue, 64);
    queue.thread_ended();
    queue.close();
    assert!(matches!(file(pending), Err(PictureError::Stopping)));
    assert!(next(&queue).is_none() && matches!(add(&queue, 64), Err(PictureError::Stopping)));
}

#[test]
fn no_more_than_so_many_bytes_are_kept() {
    let kept = |memory_bytes, pictures: &[usize]| {
        let queue = queue(PictureLimits { memory_bytes, ..PictureLimits::default() });
        for (size, bytes) in (64..).zip(pictures) {
            let _pending = added(&queue, size);
            queue.finish(&queue.next().expect("a request"), Ok(picture(*bytes)));
        }
        let keys = (64..).map(|size: u32| Digest::of(&size.to_le_bytes())).take(pictures.len());
        let kept = keys.filter_map(|key| queue.cache.get(&key)).map(|file| file.bytes.len());
        kept.collect::<Vec<_>>()
    };
    assert_eq!(kept(1000, &[100, 200, 600]), [100, 200, 600]);
    // A large picture is kept too, and others make room for it.
    assert_eq!(kept(1000, &[200, 900]), [900]);
    assert_eq!(kept(1000, &[300; 10]), [300; 3]);
    assert!(kept(1000, &[1001]).is_empty() && kept(0, &[1]).is_empty());
}

/// A renderer that calls a test's function.
struct Fake<F>(F);

impl<F: FnMut(&Task) -> Outcome + Send + 'static> Render for Fake<F> {
    fn render(&mut self, task: &Task) -> Outcome {
        (self.0)(task)
    }
}

/// Runs the loop with fake renderers, which tell the adapter that they were made with before each picture.
fn start_loop(
    queue: &Arc<PictureQueue>,
    adapter: Adapter,
    render: impl FnMut(&Task) -> Outcome + Send + Clone + 'static,
) -> mpsc::Receiver<(Adapter, u32)> {
    let (queue, (told, receiver)) = (Arc::clone(queue), mpsc::channel());
    let new_renderer = move |adapter| {
        let (told, mut render): (Sender<_>, _) = (told.clone(), render.clone());
        Fake(move |task: &Task| {
            let _ = told.send((adapter, size(&task.request)));
            render(task)
        })
    };
    thread::spawn(move || run(&queue, adapter, Duration::ZERO, new_renderer));
    receiver
}

/// Size of a picture whose renderer hangs, and of one whose renderer panics.
const HANGS: u32 = 64;
const PANICS: u32 = 65;

/// Renders pictures of these sizes, and others at once.
fn render(task: &Task) -> Outcome {
    match size(&task.request) {
        HANGS => loop {
            thread::park();
        },
        PANICS => panic!("as the test demands"),
        _ => Ok(picture(1)),
    }
}

#[test]
fn a_renderer_that_hangs_is_abandoned() {
    for (adapter, then) in [(Adapter::Any, Adapter::Cpu), (Adapter::Gpu, Adapter::Gpu)] {
        let queue = queue(PictureLimits { time: SECOND, ..PictureLimits::default() });
        let [hangs, next] = [HANGS, 100].map(|size| added(&queue, size));
        let told = start_loop(&queue, adapter, render);
        let error = file(hangs).expect_err("no picture");
        assert!(matches!(error, PictureError::TooSlow { limit: SECOND, .. }), "{error:?}");
        file(next).expect("a picture");
        assert_eq!([(adapter, HANGS), (then, 100)], [(); 2].map(|()| told.recv().expect("a renderer")));
        queue.close();
        let counts = queue.state().counts;
        assert_eq!(counts, PictureCounts { done: 1, given_up: 1, ..PictureCounts::default() });
    }
}

#[test]
fn a_panic_fails_one_picture() {
    let queue = queue(PictureLimits { time: MINUTE, ..PictureLimits::default() });
    let [panics, next] = [PANICS, 100].map(|size| added(&queue, size));
    let _told = start_loop(&queue, Adapter::Any, render);
    let error = file(panics).expect_err("no picture");
    assert!(matches!(error, PictureError::Failed(_)) && error.to_string().contains("panicked"), "{error:?}");
    file(next).expect("a picture");
    queue.close();
    let counts = queue.state().counts;
    assert_eq!(counts, PictureCounts { done: 1, failed: 1, ..PictureCounts::default() });
}

#[test]
fn the_time_of_a_picture_counts_from_its_start() {
    let limit = SECOND / 2;
    let queue = queue(PictureLimits { time: limit, ..PictureLimits::default() });
    let waiting = added(&queue, 100);
    // It waits for longer than a picture may take.
    let waited = block_on(async { tokio::time::timeout(2 * limit, std::future::pending::<()>()).await });
    assert!(waited.is_err());
    let before = Instant::now();
    let (sender, deadline) = mpsc::channel();
    let _told = start_loop(&queue, Adapter::Any, move |task| {
        let _ = sender.send(task.deadline);
        Ok(picture(1))
    });
    file(waiting).expect("a picture");
    assert!(deadline.recv().expect("a deadline") >= before + limit);
    queue.close();
}

#[test]
fn a_picture_stops_once_nobody_waits_for_it() {
    let queue = queue(PictureLimits { time: MINUTE, ..PictureLimits::default() });
    let pending = added(&queue, 100);
    let told = start_loop(&queue, Adapter::Any, |task| {
        while !task.is_stopped() {
            thread::yield_now();
        }
        Err(task.queue.stopped())
    });
    told.recv().expect("a renderer");
    drop(pending);
    // The next one is rendered long before the first is late.
    let pending = added(&queue, 101);
    assert_eq!(told.recv_timeout(MINUTE / 2).expect("a renderer").1, 101);
    assert_eq!(queue.state().counts.given_up, 1);
    queue.close();
    assert!(matches!(file(pending), Err(PictureError::Stopping)));
}
