//! The interface of the module: one session, and requests through its memory.
//!
//! A page reserves memory with [`input`], writes a request and the bytes that belong to it there,
//! and calls [`call`]. The answer is a JSON object at the address returned, of [`answer_length`]
//! bytes: `value` with `arrays`, each `[name, type, address, length]`; or `error`. Text and arrays
//! are valid until the next call.
//!
//! No operation here is unsafe: functions are marked as exports, and those of the page as imports.

#![expect(unsafe_code, reason = "marks of exported and imported functions")]

use std::cell::RefCell;
use std::panic;

use fairing_watch::{Progress, Watch};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::session::Session;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Shows the name of a stage and its progress; `of` is 0 if unknown.
    safe fn progress(name: *const u8, length: usize, done: f64, of: f64);
    /// Takes the message of a panic, after which the module must not be called.
    safe fn panicked(message: *const u8, length: usize);
}

#[derive(Default)]
struct State {
    session: Session,
    input: Vec<u8>,
    /// Owns the arrays that the page reads.
    answer: Option<Answer>,
    text: Vec<u8>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::new(State::default());
}

/// Reserves memory for a request of this many bytes.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn input(length: usize) -> *mut u8 {
    STATE.with_borrow_mut(|state| {
        state.input = vec![0; length];
        state.input.as_mut_ptr()
    })
}

/// Answers a request: the first `length` bytes of the input are its object, the others belong to
/// it. Returns the address of the answer.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn call(length: usize) -> *const u8 {
    panic::set_hook(Box::new(|info| {
        let message = info.to_string();
        panicked(message.as_ptr(), message.len());
    }));
    STATE.with_borrow_mut(|state| {
        state.answer = None;
        let input = std::mem::take(&mut state.input);
        let (request, bytes) = input.split_at(length.min(input.len()));
        let session = &mut state.session;
        let found = Watch::with_listener(show).run(|| session.call(request, bytes));
        let text = match found {
            Ok(Ok(answer)) => described(state.answer.insert(answer)),
            Ok(Err(error)) => json!({ "error": format!("{error:#}") }),
            Err(cancelled) => json!({ "error": cancelled.to_string() }),
        };
        state.text = text.to_string().into_bytes();
        state.text.as_ptr()
    })
}

/// The number of bytes of the answer.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer_length() -> usize {
    STATE.with_borrow(|state| state.text.len())
}

fn described(answer: &Answer) -> Value {
    let arrays = answer.arrays.iter();
    let arrays: Vec<Value> = arrays
        .map(|(name, array)| json!([name, array.kind(), array.address(), array.len()]))
        .collect();
    json!({ "value": answer.value, "arrays": arrays })
}

fn show(now: Progress) {
    progress(now.stage.as_ptr(), now.stage.len(), now.done as f64, now.of as f64);
}
