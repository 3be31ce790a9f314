//! The `afmsweep` program; everything it does is in the library and in `cli`.

mod cli;

/// A searched sweep makes and frees very many states of some kilobytes, which the C library's allocator is slow at.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    silence_device_select();
    cli::main()
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
