//! The `ltcforge` command. Only this file handles signals and reads the environment.

use std::{
    env,
    io::{self, IsTerminal as _},
    process::{self, ExitCode},
    time::Duration,
};

use ltcforge_cli::{self as cli, Cli, CommandFailure, Context, Exit, Interrupt, OnInterrupt, without_passwords};
#[cfg(unix)]
use tokio::signal::unix::{Signal, SignalKind, signal};
#[cfg(not(unix))]
use tokio::signal::windows::{CtrlC as Signal, ctrl_c};
use tokio::sync::watch;
use tracing_subscriber::{Layer as _, filter::Targets, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// How long an interrupted command may take to clean up.
const CLEAN_UP: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let cli = match Cli::from_args(env::args_os()) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            let text = error.render().to_string();
            let shown = without_passwords(&text);
            if env::args_os().any(|argument| argument == "--json") {
                let message = shown.trim_end();
                let message = message.strip_prefix("error: ").unwrap_or(message);
                return fail(&CommandFailure::new(Exit::Usage, message), true);
            }
            // Clap prints errors with colours.
            if shown == text {
                error.exit();
            }
            eprint!("{shown}");
            return Exit::Usage.into();
        }
        Err(error) => error.exit(),
    };
    let json = cli.json;
    #[cfg(unix)]
    if cli.command.opens_vulkan() {
        keep_vulkan_from_looking_for_a_display();
    }
    let on_interrupt = cli.command.on_interrupt();
    log_to_stderr(cli.command.log_level());

    let runtime = match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return fail(&CommandFailure::new(Exit::Failed, error.to_string()), json),
    };
    let (sender, interrupt) = Interrupt::channel();
    if let Err(error) = listen_to_signals(&runtime, sender, on_interrupt) {
        return fail(&CommandFailure::new(Exit::Failed, format!("signals: {error}")), json);
    }
    let mut context = Context {
        stdout: &mut io::stdout(),
        json,
        stdout_is_terminal: io::stdout().is_terminal(),
        draws_progress: io::stderr().is_terminal(),
        interrupt,
        runtime: runtime.handle().clone(),
    };
    let exit = match cli::run(cli, &mut context) {
        Ok(exit) => exit.into(),
        Err(failure) => fail(&failure, json),
    };
    // An aborted request may still be in a blocking call.
    runtime.shutdown_background();
    exit
}

/// Restarts this program in the same process, with an environment in which Mesa does not look for a display.
///
/// wgpu enables the surface extensions of every instance. If `XDG_RUNTIME_DIR` is not an absolute path, Mesa's
/// device-select layer then makes libwayland print a warning to standard error. `NODEVICE_SELECT` turns the layer off.
/// A process cannot change its own environment without unsafe code.
#[cfg(unix)]
fn keep_vulkan_from_looking_for_a_display() {
    use std::os::unix::process::CommandExt as _;

    const SWITCH: &str = "NODEVICE_SELECT";
    let is_found = env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| std::path::Path::new(&folder).is_absolute());
    if is_found || env::var_os(SWITCH).is_some() {
        return;
    }
    if let Ok(program) = env::current_exe() {
        // This returns only when it fails. Then Mesa's warning is printed.
        let _ = process::Command::new(program).args(env::args_os().skip(1)).env(SWITCH, "1").exec();
    }
}

/// Prints to standard error why the command failed: as lines, or as one JSON document.
fn fail(failure: &CommandFailure, json: bool) -> ExitCode {
    if !json {
        for line in failure.message.lines() {
            eprintln!("ltcforge: {line}");
        }
    } else if !failure.message.is_empty() {
        eprintln!("{}", failure.json());
    }
    failure.exit.into()
}

/// Logs to standard error. `LTCFORGE_LOG` selects the targets and levels, such as `debug` or
/// `ltcforge_server::http=trace`. With `LTCFORGE_LOG_FORMAT=json`, each line is a JSON document.
fn log_to_stderr(default: &str) {
    let wanted = env::var("LTCFORGE_LOG").ok().and_then(|targets| targets.parse().ok());
    let targets: Targets = wanted.unwrap_or_else(|| default.parse().expect("the default is a level"));
    let log = fmt::layer().with_writer(io::stderr);
    let log = if env::var("LTCFORGE_LOG_FORMAT").is_ok_and(|format| format == "json") {
        log.json().flatten_event(true).with_span_list(false).boxed()
    } else {
        log.with_ansi(io::stderr().is_terminal()).boxed()
    };
    tracing_subscriber::registry().with(log.with_filter(targets)).init();
}

/// The first SIGINT, and for a server the first SIGTERM, interrupts the command as `on_interrupt` states. The second
/// signal ends the process.
fn listen_to_signals(
    runtime: &tokio::runtime::Runtime,
    sender: watch::Sender<bool>,
    on_interrupt: OnInterrupt,
) -> io::Result<()> {
    let _inside = runtime.enter();
    let (mut interrupts, mut terminations) = signals(on_interrupt)?;
    runtime.spawn(async move {
        either(&mut interrupts, &mut terminations).await;
        sender.send_replace(true);
        match on_interrupt {
            OnInterrupt::Ends => {}
            OnInterrupt::Notified => {
                tokio::select! {
                    () = either(&mut interrupts, &mut terminations) => {}
                    () = tokio::time::sleep(CLEAN_UP) => {}
                }
            }
            OnInterrupt::Finishes => either(&mut interrupts, &mut terminations).await,
        }
        process::exit(Exit::Interrupted as i32);
    });
    Ok(())
}

/// SIGINT, and for a server also SIGTERM, which ends other commands at once.
#[cfg(unix)]
fn signals(on_interrupt: OnInterrupt) -> io::Result<(Signal, Option<Signal>)> {
    let terminations = match on_interrupt {
        OnInterrupt::Finishes => Some(signal(SignalKind::terminate())?),
        OnInterrupt::Ends | OnInterrupt::Notified => None,
    };
    Ok((signal(SignalKind::interrupt())?, terminations))
}

/// Only Ctrl-C.
#[cfg(not(unix))]
fn signals(_: OnInterrupt) -> io::Result<(Signal, Option<Signal>)> {
    Ok((ctrl_c()?, None))
}

async fn either(interrupts: &mut Signal, terminations: &mut Option<Signal>) {
    let terminated = async {
        match terminations {
            Some(signal) => signal.recv().await,
            None => std::future::pending().await,
        }
    };
    tokio::select! {
        _ = interrupts.recv() => {}
        _ = terminated => {}
    }
}
