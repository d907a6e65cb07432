//! Progress on a terminal, and the end of a run by Ctrl-C.

use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use fairing::mesh::io::discard_unfinished;
use fairing::watch::{Progress, Watch};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::context::Context;

/// Runs shorter than this show no progress.
const DELAY: Duration = Duration::from_millis(500);
/// Interval between updates of the progress.
const TICK: Duration = Duration::from_millis(100);
/// Time for cancelled work to unwind before the process ends.
const PATIENCE: Duration = Duration::from_millis(50);
/// The exit code after Ctrl-C, as shells give it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Runs `work` and shows its progress. Ctrl-C cancels the work and ends the process within 100 ms,
/// without temporary files.
pub(crate) fn run<T>(context: &Context, work: impl FnOnce() -> T) -> T {
    let watch = context.watch.clone();
    let shown = !context.quiet && stderr().is_terminal();
    let (unwound, until_unwound) = channel();
    end_on_interrupt(watch.clone(), until_unwound, shown);
    let result = thread::scope(|scope| {
        let (finished, until_finished) = channel();
        if shown {
            scope.spawn(|| show(&context.bar, &watch, until_finished));
        }
        let result = watch.run(work);
        drop(finished);
        result
    });
    if let Ok(result) = result {
        context.bar.finish_and_clear();
        return result;
    }
    drop(unwound);
    loop {
        // The thread of the signal ends the process.
        thread::park();
    }
}

/// Makes Ctrl-C cancel the work and end the process, at the latest [`PATIENCE`] later.
fn end_on_interrupt(watch: Watch, until_unwound: Receiver<()>, shown: bool) {
    let handler = move || {
        watch.cancel();
        // Disconnected or timed out: the process ends in both cases.
        let _ = until_unwound.recv_timeout(PATIENCE);
        discard_unfinished();
        // The bar is erased without its lock, which printing into a full pipe may hold.
        let erase = if shown { "\r\x1b[2K" } else { "" };
        let _ = writeln!(stderr(), "{erase}interrupted");
        std::process::exit(INTERRUPTED);
    };
    on_interrupt(handler);
}

/// Calls `handler` on a thread of its own when Ctrl-C is pressed. If no handler can be set, the
/// system ends the process.
#[cfg(unix)]
fn on_interrupt(handler: impl FnOnce() + Send + 'static) {
    use signal_hook::{consts::SIGINT, iterator::Signals};

    if let Ok(mut signals) = Signals::new([SIGINT]) {
        thread::spawn(move || {
            if signals.forever().next().is_some() {
                handler();
            }
        });
    }
}

/// The system ends the process.
#[cfg(not(unix))]
fn on_interrupt(_: impl FnOnce() + Send + 'static) {}

/// Shows the stage of the work, and its percentage if known, until the work has ended.
fn show(bar: &ProgressBar, watch: &Watch, until_finished: Receiver<()>) {
    let style = |template| ProgressStyle::with_template(template).ok();
    let counted = style("{spinner} {msg} [{bar:30}] {percent:>3} %  {elapsed}");
    let uncounted = style("{spinner} {msg}  {elapsed}");
    let mut wait = DELAY;
    while until_finished.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
        if watch.is_cancelled() {
            return;
        }
        let Progress { stage, done, of, .. } = watch.progress();
        if let Some(style) = if of > 0 { &counted } else { &uncounted } {
            bar.set_style(style.clone());
        }
        bar.set_length(of);
        bar.set_position(done);
        bar.set_message(stage);
        if wait == DELAY {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            wait = TICK;
        }
        bar.tick();
    }
}
