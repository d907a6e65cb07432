//! Runs a kernel compiled for the widest vectors of this processor.

/// A kernel. Its `call` and all functions it calls must be `#[inline(always)]`, which closures
/// cannot be: a function that is not inlined is compiled for the oldest processor, where a fused
/// multiply-add is a function call.
pub(crate) use pulp::NullaryFnOnce as Kernel;

/// Calls the kernel with the processor's vector instructions enabled.
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    pulp::Arch::new().dispatch(kernel)
}

/// `a b + c`, rounded once; in WebAssembly, which has no instruction for it, rounded twice, a
/// hundred times as fast as an emulation.
#[cfg(feature = "solvers")]
#[inline(always)]
pub(crate) fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_arch = "wasm32") { a * b + c } else { a.mul_add(b, c) }
}
