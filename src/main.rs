//! The `afmsweep` program; everything it does is in the library, and in its module `cli`.

mod elementary_functions;

/// A searched sweep makes and frees very many states of some kilobytes, which the C library's allocator is slow at.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    keep_memory();
    silence_device_select();
    afmsweep::cli::main(std::env::args_os()).into()
}

/// Memory that is free stays with the program, for what comes next. Given back to the system after a while, as is usual, it
/// is taken anew for the next block of a sweep, page by page and each filled with zeros first: a run with
/// MIMALLOC_PURGE_DELAY=10 shows what that costs.
fn keep_memory() {
    /// How long free memory is kept, ms; -1: for good. The crate has no name for it (`mi_option_purge_delay` of mimalloc.h).
    const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;
    // SAFETY: it sets a number, and only this thread runs yet. What the user says (MIMALLOC_PURGE_DELAY) holds.
    unsafe { libmimalloc_sys::mi_option_set_default(PURGE_DELAY, -1) };
}

/// Mesa's layer that sorts Vulkan devices by the display they drive complains on standard error where there
/// is no display session. Nothing here draws, and the adapter is chosen by its kind: the layer can stay away,
/// unless the user set it up.
fn silence_device_select() {
    let set = |name| std::env::var_os(name).is_some();
    if !["XDG_RUNTIME_DIR", "NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT"].into_iter().any(set) {
        // SAFETY: no thread but this one runs yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
