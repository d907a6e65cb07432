//! Computations without the interpreter lock, with progress and cancellation.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, OnceLock};
use std::time::Duration;

use fairing_watch::{Progress, Watch};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::error::{Error, Result};

/// Interval between two checks of signals and progress.
const TICK: Duration = Duration::from_millis(20);
/// Time for cancelled work to end before it is abandoned.
const PATIENCE: Duration = Duration::from_millis(40);
/// Stack size of a worker thread, that of a main thread.
const STACK: usize = 8 << 20;

/// Settings of a call: the number of threads and the progress callback.
#[derive(Default)]
pub(crate) struct Call {
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
}

impl<'py> FromPyObject<'_, 'py> for Call {
    type Error = PyErr;

    /// Converts `(threads, progress)`.
    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (threads, progress): (Option<usize>, Option<Py<PyAny>>) = object.extract()?;
        if threads == Some(0) {
            return Err(PyValueError::new_err("threads is 0, but must be 1 or more"));
        }
        Ok(Self { threads, progress })
    }
}

/// The process that first used the global pool: the pool's threads do not exist in forked
/// processes.
static HOME: OnceLock<u32> = OnceLock::new();

impl Call {
    /// Runs the work on its own thread and waits for it.
    ///
    /// The calling thread handles signals meanwhile. An exception of a signal handler or of the
    /// progress callback cancels the work and is raised; work that does not end at once is
    /// abandoned and ends at its next check.
    pub(crate) fn run<T: Send + 'static>(
        self,
        py: Python<'_>,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) -> PyResult<T> {
        let watch = Watch::new();
        let (sender, receiver) = channel();
        let (watched, threads) = (watch.clone(), self.threads);
        let body = move || {
            let result = catch_unwind(AssertUnwindSafe(|| in_pool(threads, &watched, work)));
            let tell = move || {
                // Nobody waits for abandoned work.
                let _ = sender.send(result);
            };
            Box::new(tell) as Last
        };
        py.detach(move || {
            on_worker(Box::new(body))?;
            let mut shown = Progress::default();
            loop {
                match receiver.recv_timeout(TICK) {
                    Ok(Ok(result)) => {
                        let result = result?;
                        self.show_end(&watch, &shown)?;
                        return Ok(result);
                    }
                    Ok(Err(panic)) => return Err(defect(&*panic).into()),
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(
                            Error::Internal("the work ended without a result".into()).into()
                        );
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
                if let Err(exception) = self.look(&watch, &mut shown) {
                    watch.cancel();
                    // A late result is dropped.
                    let _ = receiver.recv_timeout(PATIENCE);
                    return Err(exception);
                }
            }
        })
    }

    /// Handles signals and reports progress.
    fn look(&self, watch: &Watch, shown: &mut Progress) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let Some(callback) = &self.progress else { return Ok(()) };
            let now = watch.progress();
            if now == *shown || now.stage.is_empty() {
                return Ok(());
            }
            *shown = now;
            tell(py, callback, now)
        })
    }

    /// Reports the end of the last stage, if its begin was reported.
    fn show_end(&self, watch: &Watch, shown: &Progress) -> PyResult<()> {
        let Some(callback) = &self.progress else { return Ok(()) };
        let last = watch.progress();
        if last.stage.is_empty() || last == *shown {
            return Ok(());
        }
        Python::attach(|py| tell(py, callback, last))
    }
}

fn tell(py: Python<'_>, callback: &Py<PyAny>, now: Progress) -> PyResult<()> {
    let of = (now.of > 0).then_some(now.of);
    callback.call1(py, (now.stage, now.done, of)).map(|_| ())
}

/// Last action of a job, after its worker is free again.
type Last = Box<dyn FnOnce() + Send>;
type Job = Box<dyn FnOnce() -> Last + Send>;

/// The process and its idle threads: a thread reuses the memory of its earlier work.
static IDLE: Mutex<(u32, Vec<Sender<Job>>)> = Mutex::new((0, vec![]));

/// Runs the job on an idle thread, or else on a new one.
fn on_worker(mut job: Job) -> Result<()> {
    let here = std::process::id();
    // A lock held by another thread during a fork is never released.
    let worker = IDLE.try_lock().ok().and_then(|mut idle| {
        if idle.0 != here {
            // The threads of the parent do not exist here.
            *idle = (here, vec![]);
        }
        idle.1.pop()
    });
    if let Some(worker) = worker {
        match worker.send(job) {
            Ok(()) => return Ok(()),
            Err(returned) => job = returned.0,
        }
    }
    let (sender, receiver) = channel::<Job>();
    let serve = move || {
        let mut last = job();
        loop {
            let waits = IDLE.try_lock().is_ok_and(|mut idle| {
                idle.1.push(sender.clone());
                true
            });
            last();
            match if waits { receiver.recv().ok() } else { None } {
                Some(job) => last = job(),
                None => return,
            }
        }
    };
    let thread = std::thread::Builder::new().name("pyfairing".into()).stack_size(STACK);
    let started = thread.spawn(serve);
    started
        .map(|_| ())
        .map_err(|error| Error::Internal(format!("no thread can be started: {error}")))
}

/// Runs the work under the watch, with the requested number of threads.
fn in_pool<T: Send>(
    threads: Option<usize>,
    watch: &Watch,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let watched = || {
        watch
            .run(work)
            .unwrap_or_else(|_| Err(Error::Internal("the work was cancelled".to_owned())))
    };
    let here = std::process::id();
    let forked = *HOME.get_or_init(|| here) != here;
    if threads.is_none() && !forked {
        return watched();
    }
    // A private pool: a waiting thread takes over no other work.
    let count = threads.unwrap_or_else(default_threads);
    let pool = ThreadPoolBuilder::new().num_threads(count).build();
    let pool =
        pool.map_err(|e| Error::option(format!("{count} threads cannot be started: {e}")))?;
    pool.install(watched)
}

/// The size of the global pool.
fn default_threads() -> usize {
    std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0)
}

fn defect(panic: &(dyn Any + Send)) -> Error {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    Error::Internal(format!("a defect of pyfairing, please report it: {}", text.unwrap_or("panic")))
}
