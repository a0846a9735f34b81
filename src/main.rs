//! The `ltcforge` command. It alone handles signals and reads the environment.

use std::{
    io::{self, IsTerminal as _},
    process::{self, ExitCode},
    time::Duration,
};

use clap::Parser as _;
use ltcforge::cli::{self, Cli, Context, Exit, Interrupt, OnInterrupt};
use tokio::{
    signal::unix::{Signal, SignalKind, signal},
    sync::watch,
};
use tracing_subscriber::EnvFilter;

/// How long an interrupted command may take to clean up.
const CLEAN_UP: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let cli = Cli::parse();
    let on_interrupt = cli.command.on_interrupt();
    log_to_stderr(if on_interrupt == OnInterrupt::Finishes { "info" } else { "warn" });

    let runtime = match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return fail(Exit::Failed, &error.to_string()),
    };
    let (tell, interrupt) = Interrupt::channel();
    if let Err(error) = listen_to_signals(&runtime, tell, on_interrupt) {
        return fail(Exit::Failed, &format!("signals: {error}"));
    }
    let mut context = Context {
        stdout: &mut io::stdout(),
        stdout_is_terminal: io::stdout().is_terminal(),
        draws_progress: io::stderr().is_terminal(),
        interrupt,
        runtime: runtime.handle().clone(),
    };
    let exit = match cli::run(cli, &mut context) {
        Ok(exit) => exit.into(),
        Err(failure) => fail(failure.exit, &failure.message),
    };
    // A request that was cut off may still be in a blocking call.
    runtime.shutdown_background();
    exit
}

fn fail(exit: Exit, message: &str) -> ExitCode {
    for line in message.lines() {
        eprintln!("ltcforge: {line}");
    }
    exit.into()
}

/// Logs to standard error what `LTCFORGE_LOG` asks for, such as `debug` or `ltcforge::server::http=trace`.
fn log_to_stderr(default: &str) {
    let filter = EnvFilter::try_from_env("LTCFORGE_LOG").unwrap_or_else(|_| EnvFilter::new(default));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal())
        .init();
}

/// The first SIGINT, and for a server SIGTERM, does what the command asks for; the second ends the process.
fn listen_to_signals(
    runtime: &tokio::runtime::Runtime,
    tell: watch::Sender<bool>,
    on_interrupt: OnInterrupt,
) -> io::Result<()> {
    let _inside = runtime.enter();
    let mut interrupts = signal(SignalKind::interrupt())?;
    // Only a server handles SIGTERM; other commands are ended by it.
    let mut terminations = match on_interrupt {
        OnInterrupt::Finishes => Some(signal(SignalKind::terminate())?),
        OnInterrupt::Ends | OnInterrupt::Told => None,
    };
    runtime.spawn(async move {
        either(&mut interrupts, &mut terminations).await;
        tell.send_replace(true);
        match on_interrupt {
            OnInterrupt::Ends => {}
            OnInterrupt::Told => {
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
