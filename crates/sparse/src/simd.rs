//! Runs a kernel compiled for the widest vectors of this processor.

/// A kernel. Its `call` and all it calls must be `#[inline(always)]`, closures included (so there
/// are none): what is not inlined is compiled for the oldest processor, where a fused multiply-add
/// is a function call.
pub(crate) use pulp::NullaryFnOnce as Kernel;

/// Calls the kernel with the processor's vector instructions enabled.
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    pulp::Arch::new().dispatch(kernel)
}
