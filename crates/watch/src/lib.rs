#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! A [`Watch`] is created and kept by the program and never passed as an argument: work started
//! with [`Watch::run`] finds it by [`current`]. Long loops of the libraries call [`check`] every
//! few milliseconds; once the watch is [cancelled](Watch::cancel) from another thread, the next
//! check ends the work. Watching does not change the bits of a result. Without a watch, a check
//! costs one read of an empty thread-local.
//!
//! Cancelled work unwinds instead of returning an error: no function has failed, and no caller
//! could handle it. [`Watch::run`] catches the unwinding and returns `Err(Cancelled)`; no message
//! is printed. A program built with `panic = "abort"` must not cancel.
//!
//! The program reads [`Watch::progress`] whenever it wants to show it; the computation never waits.
//! A program without a second thread, such as a page, passes a function to
//! [`Watch::with_listener`].
//!
//! # Threads
//!
//! The watch belongs to the thread that called [`Watch::run`]. Closures for a thread pool capture
//! its [`Handle`], as in the example.
//!
//! Call [`Watch::run`] on a thread outside the pool, or in a pool that does no other work: while a
//! thread of a shared pool waits, it may take over work of others and would cancel it as well.

pub mod parallel;

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

/// Progress of the work under a watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Progress {
    /// Name of the stage; empty before the first.
    pub stage: &'static str,
    /// Parts of the stage that are done, at most `of` if that is known.
    pub done: u64,
    /// Number of parts; 0 if unknown.
    pub of: u64,
}

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    done: AtomicU64,
    stage: Mutex<(&'static str, u64)>,
    listener: Option<fn(Progress)>,
}

/// Cancels work and reports its progress, from any thread.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<Shared>);

thread_local! {
    static CURRENT: RefCell<Option<Watch>> = const { RefCell::new(None) };
}

/// Restores the previous watch, even on unwind.
struct Restore(Option<Watch>);

impl Drop for Restore {
    fn drop(&mut self) {
        CURRENT.with(|current| *current.borrow_mut() = self.0.take());
    }
}

impl Watch {
    /// Creates a watch; no work runs under it yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A watch that calls a function after each change of its progress, on the thread that made the
    /// change. The work waits for the function, which may be called many times a millisecond.
    pub fn with_listener(listener: fn(Progress)) -> Self {
        Self(Arc::new(Shared { listener: Some(listener), ..Shared::default() }))
    }

    /// Cancels work that runs or will run under this watch, at its next check.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns true once [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    /// The current stage and its progress.
    pub fn progress(&self) -> Progress {
        let (stage, of) = *self.0.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let done = self.0.done.load(Ordering::Relaxed);
        Progress { stage, done: if of > 0 { done.min(of) } else { done }, of }
    }

    fn tell(&self) {
        if let Some(listener) = self.0.listener {
            listener(self.progress());
        }
    }

    /// Runs work under this watch. If it is cancelled, its partial results are dropped.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if a check found the watch cancelled. Work without a later check completes.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
        let before = CURRENT.with(|current| current.borrow_mut().replace(self.clone()));
        let _restore = Restore(before);
        catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
            if payload.is::<Cancelled>() { Cancelled } else { resume_unwind(payload) }
        })
    }
}

/// The watch of a thread, if any, for closures that run on other threads.
#[derive(Debug, Clone, Default)]
pub struct Handle(Option<Watch>);

impl Handle {
    /// Unwinds if the watch was cancelled.
    #[inline]
    pub fn check(&self) {
        if let Some(watch) = &self.0
            && watch.is_cancelled()
        {
            resume_unwind(Box::new(Cancelled));
        }
    }

    /// Begins a stage of `of` parts, 0 if unknown, and [checks](Self::check).
    pub fn stage(&self, name: &'static str, of: u64) {
        if let Some(watch) = &self.0 {
            let shared = &watch.0;
            {
                let mut stage = shared.stage.lock().unwrap_or_else(PoisonError::into_inner);
                *stage = (name, of);
                shared.done.store(0, Ordering::Relaxed);
            }
            watch.tell();
        }
        self.check();
    }

    /// Sets the number of parts done to at least `done`, and [checks](Self::check).
    pub fn reach(&self, done: u64) {
        if let Some(watch) = &self.0 {
            watch.0.done.fetch_max(done, Ordering::Relaxed);
            watch.tell();
        }
        self.check();
    }

    /// Counts parts of the stage as done and [checks](Self::check).
    #[inline]
    pub fn advance(&self, parts: u64) {
        if let Some(watch) = &self.0 {
            watch.0.done.fetch_add(parts, Ordering::Relaxed);
            watch.tell();
        }
        self.check();
    }
}

/// The watch of this thread.
pub fn current() -> Handle {
    Handle(CURRENT.with(|current| current.borrow().clone()))
}

/// Unwinds if the watch of this thread was cancelled.
pub fn check() {
    let cancelled =
        CURRENT.with(|current| current.borrow().as_ref().is_some_and(Watch::is_cancelled));
    if cancelled {
        resume_unwind(Box::new(Cancelled));
    }
}

/// [`Handle::stage`] on this thread.
pub fn stage(name: &'static str, of: u64) {
    current().stage(name, of);
}

/// [`Handle::reach`] of the work of this thread.
pub fn reach(done: u64) {
    current().reach(done);
}

/// [`Handle::advance`] on this thread.
pub fn advance(parts: u64) {
    current().advance(parts);
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn work_without_a_watch_completes() {
        check();
        stage("nothing", 1);
        advance(1);
        assert!(current().0.is_none());
    }

    #[test]
    fn a_cancelled_watch_ends_only_its_own_work() {
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
    fn other_panics_propagate() {
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

    #[test]
    fn a_listener_is_told_each_change() {
        thread_local! {
            static TOLD: RefCell<Vec<(u64, u64)>> = const { RefCell::new(vec![]) };
        }
        let tell = |now: Progress| TOLD.with_borrow_mut(|told| told.push((now.done, now.of)));
        let work = || {
            stage("sweeps", 10);
            advance(3);
            reach(5);
        };
        Watch::with_listener(tell).run(work).unwrap();
        assert_eq!(TOLD.take(), [(0, 10), (3, 10), (5, 10)]);
    }
}
