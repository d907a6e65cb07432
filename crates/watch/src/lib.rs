//! Cancelling long computations, and seeing how far they are.
//!
//! A [`Watch`] is made by a program, which keeps it, and passed to nobody: work
//! that is started with [`Watch::run`] finds it by [`current`]. Long loops of
//! the libraries call [`check`] every few milliseconds, and that ends the work
//! of a watch that was [cancelled](Watch::cancel) from another thread. Nothing
//! else changes: work that is watched takes the same way to the same bits, and
//! work that is not pays for a look at an empty thread-local.
//!
//! Cancelled work is left by unwinding, not through the error types of each
//! function: it is no failure of theirs, and their callers can do nothing
//! about it. [`Watch::run`] is where it ends, as
//! `Err(Cancelled)`. No message is printed. A program built with
//! `panic = "abort"` must not cancel.
//!
//! Progress is looked up ([`Watch::progress`]) whenever the program wants to
//! show it; the computation never waits for that.
//!
//! # Threads
//!
//! The watch belongs to the thread that called [`Watch::run`]. Closures that
//! run on the threads of a pool take it along:
//!
//! ```
//! use fairing_watch::{Watch, current};
//! use rayon::prelude::*;
//!
//! let squares = |n: u64| -> Vec<u64> {
//!     let watch = current();
//!     (0..n).into_par_iter().map(|i| { watch.check(); i * i }).collect()
//! };
//! let watch = Watch::new();
//! assert_eq!(watch.run(|| squares(3)), Ok(vec![0, 1, 4]));
//! watch.cancel();
//! assert!(watch.run(|| squares(3)).is_err());
//! ```
//!
//! Call [`Watch::run`] on a thread outside of the pool, or inside of a pool that
//! does this work only: a thread of a pool that others use may take over their
//! work while it waits, and would end it with its own.

use std::cell::RefCell;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The work was cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("cancelled")
    }
}

impl std::error::Error for Cancelled {}

/// How far work is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Progress {
    /// What is being done; empty before the first stage.
    pub stage: &'static str,
    /// How much of it is done, never more than there is.
    pub done: u64,
    /// How much there is to do; 0 where nobody knows.
    pub of: u64,
}

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    done: AtomicU64,
    stage: Mutex<(&'static str, u64)>,
}

/// Cancels work and tells how far it is, from any thread.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<Shared>);

thread_local! {
    static CURRENT: RefCell<Option<Watch>> = const { RefCell::new(None) };
}

/// Puts the watch of before back, also when the work unwinds.
struct Restore(Option<Watch>);

impl Drop for Restore {
    fn drop(&mut self) {
        CURRENT.with(|current| *current.borrow_mut() = self.0.take());
    }
}

impl Watch {
    /// A watch over nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the work that is or will be run under this watch, at its next check.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    /// How far the work is.
    pub fn progress(&self) -> Progress {
        let (stage, of) = *self.0.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let done = self.0.done.load(Ordering::Relaxed);
        Progress { stage, done: if of > 0 { done.min(of) } else { done }, of }
    }

    /// Runs work under this watch. What the work leaves half done is dropped.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if a check found that the watch was cancelled. Work that
    /// makes no check after that ends as usual.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
        let before = CURRENT.with(|current| current.borrow_mut().replace(self.clone()));
        let _restore = Restore(before);
        catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
            if payload.is::<Cancelled>() { Cancelled } else { resume_unwind(payload) }
        })
    }
}

/// The watch over some work, if there is one, for closures that run on other
/// threads.
#[derive(Debug, Clone, Default)]
pub struct Handle(Option<Watch>);

impl Handle {
    /// Ends the work if its watch was cancelled.
    #[inline]
    pub fn check(&self) {
        if let Some(watch) = &self.0
            && watch.is_cancelled()
        {
            resume_unwind(Box::new(Cancelled));
        }
    }

    /// Begins a stage of `of` parts, 0 where nobody knows; then as
    /// [`check`](Self::check).
    pub fn stage(&self, name: &'static str, of: u64) {
        if let Some(Watch(shared)) = &self.0 {
            let mut stage = shared.stage.lock().unwrap_or_else(PoisonError::into_inner);
            *stage = (name, of);
            shared.done.store(0, Ordering::Relaxed);
        }
        self.check();
    }

    /// Raises the parts done to `done` if fewer were; then as [`check`](Self::check).
    pub fn reach(&self, done: u64) {
        if let Some(Watch(shared)) = &self.0 {
            shared.done.fetch_max(done, Ordering::Relaxed);
        }
        self.check();
    }

    /// Counts parts of the stage as done; then as [`check`](Self::check).
    #[inline]
    pub fn advance(&self, parts: u64) {
        if let Some(Watch(shared)) = &self.0 {
            shared.done.fetch_add(parts, Ordering::Relaxed);
        }
        self.check();
    }
}

/// The watch over the work of this thread.
pub fn current() -> Handle {
    Handle(CURRENT.with(|current| current.borrow().clone()))
}

/// Ends the work of this thread if its watch was cancelled.
pub fn check() {
    let cancelled =
        CURRENT.with(|current| current.borrow().as_ref().is_some_and(Watch::is_cancelled));
    if cancelled {
        resume_unwind(Box::new(Cancelled));
    }
}

/// [`Handle::stage`] of the work of this thread.
pub fn stage(name: &'static str, of: u64) {
    current().stage(name, of);
}

/// [`Handle::reach`] of the work of this thread.
pub fn reach(done: u64) {
    current().reach(done);
}

/// [`Handle::advance`] of the work of this thread.
pub fn advance(parts: u64) {
    current().advance(parts);
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn work_that_nobody_watches_goes_on() {
        check();
        stage("nothing", 1);
        advance(1);
        assert!(current().0.is_none());
    }

    #[test]
    fn a_cancelled_watch_ends_its_work_and_no_other() {
        let (one, other) = (Watch::new(), Watch::new());
        one.cancel();
        let inner = other.run(|| {
            assert_eq!(one.run(check), Err(Cancelled));
            check();
            7
        });
        assert_eq!(inner, Ok(7));
        check();
    }

    #[test]
    fn closures_on_other_threads_are_ended() {
        let watch = Watch::new();
        let found = watch.run(|| {
            let handle = current();
            (0..100_000u64).into_par_iter().for_each(|i| {
                if i == 5000 {
                    watch.cancel();
                }
                handle.advance(1);
            });
        });
        assert_eq!(found, Err(Cancelled));
        assert!(watch.progress().done < 100_000);
    }

    #[test]
    fn other_panics_go_on() {
        let watch = Watch::new();
        let panicked = catch_unwind(|| watch.run(|| resume_unwind(Box::new("mine"))));
        assert_eq!(panicked.unwrap_err().downcast_ref(), Some(&"mine"));
        assert!(current().0.is_none());
    }

    #[test]
    fn progress_can_be_seen() {
        let watch = Watch::new();
        watch
            .run(|| {
                stage("sweeps", 10);
                advance(3);
            })
            .unwrap();
        assert_eq!(watch.progress(), Progress { stage: "sweeps", done: 3, of: 10 });
    }
}
