//! The shader against the CPU, on whatever GPU adapter there is: whole runs (`agree_gpu`), slopes of periods (`slopes_gpu`),
//! searches that begin near their states (`strides_gpu`, `stride_faults_gpu`) or far from them (`newton_gpu`, `newton_faults_gpu`), each law's kick by itself (`kicks_gpu`), and
//! what the comparison of bits is worth (`faults_gpu`); and runs on several devices (`several_gpu`), for which a software
//! driver gets a twin (`twin`).
//!
//! Tests that the adapters found cannot run list themselves as ignored.

mod agree_gpu;
// Shared with the other tests, which use the rest of it.
#[allow(dead_code)]
#[path = "../checks/mod.rs"]
mod checks;
mod faults_gpu;
mod kicks_gpu;
mod newton_faults_gpu;
mod newton_gpu;
#[allow(dead_code)]
#[path = "../program/mod.rs"]
mod program;
mod several_gpu;
mod shader;
mod slopes_gpu;
mod stride_faults_gpu;
mod strides_gpu;
#[allow(dead_code)]
#[path = "../support/mod.rs"]
mod support;
mod twin;

use libtest_mimic::Arguments;

/// Prints where a thread was when its memory access failed. A driver compiles and runs shaders in this process, on threads of its
/// own: without this a crash there leaves no trace.
#[cfg(unix)]
extern "C" fn print_crash(signal: libc::c_int) {
    eprintln!("signal {signal}\n{}", std::backtrace::Backtrace::force_capture());
    // SAFETY: back to the default, by which the access that is tried again ends the process.
    unsafe { libc::signal(signal, libc::SIG_DFL) };
}

fn main() {
    #[cfg(unix)]
    // SAFETY: no other thread runs yet. Rust's own handler, which this replaces, tells overflows of the stack alone.
    unsafe {
        libc::signal(libc::SIGSEGV, print_crash as *const () as usize);
    }
    let arguments = Arguments::from_args();
    let found = shader::found();
    let tests = [
        agree_gpu::tests(&found),
        faults_gpu::tests(&found),
        kicks_gpu::tests(&found),
        newton_gpu::tests(&found),
        newton_faults_gpu::tests(&found),
        several_gpu::tests(&found),
        slopes_gpu::tests(&found),
        strides_gpu::tests(&found),
        stride_faults_gpu::tests(&found),
    ];
    let conclusion = libtest_mimic::run(&arguments, tests.into_iter().flatten().collect());
    twin::remove();
    conclusion.exit();
}
