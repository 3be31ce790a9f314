//! A second software adapter beside the first: a copy of its driver, which the Vulkan loader takes for another one.

use std::fs;
use std::path::{Path, PathBuf};

/// Where the loader looks for manifests.
const FOLDERS: [&str; 4] = [
    "/usr/share/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/local/etc/vulkan/icd.d",
];

/// Variables by which somebody has chosen the drivers already.
const CHOSEN: [&str; 3] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES"];

/// Tells the loader of a copy of Mesa's software driver, where there is one; else there is no twin.
///
/// # Safety
/// Other threads must not read or write the environment meanwhile.
pub unsafe fn add() {
    if CHOSEN.iter().any(|name| std::env::var_os(name).is_some()) {
        return;
    }
    if let Some(manifest) = copy() {
        // SAFETY: the caller's.
        unsafe { std::env::set_var("VK_ADD_DRIVER_FILES", manifest) };
    }
}

/// The manifest of the copy.
fn copy() -> Option<PathBuf> {
    let files = FOLDERS.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let lavapipe =
        |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_icd"));
    let manifest = files.map(|file| file.path()).find(lavapipe)?;
    let mut text: serde_json::Value = serde_json::from_str(&fs::read_to_string(&manifest).ok()?).ok()?;
    let library = manifest.parent()?.join(text["ICD"]["library_path"].as_str()?);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("twin");
    fs::create_dir_all(&folder).ok()?;
    // Of this process alone: another may have its own open.
    let name = format!("lavapipe-{}", std::process::id());
    let (twin, told) = (folder.join(format!("{name}.so")), folder.join(format!("{name}.json")));
    fs::copy(library, &twin).ok()?;
    text["ICD"]["library_path"] = twin.to_str()?.into();
    fs::write(&told, text.to_string()).ok()?;
    Some(told)
}

/// Takes the copy away again.
pub fn remove() {
    if let Some(manifest) = std::env::var_os("VK_ADD_DRIVER_FILES").map(PathBuf::from)
        && manifest.starts_with(env!("CARGO_TARGET_TMPDIR"))
    {
        let _ = fs::remove_file(manifest.with_extension("so"));
        let _ = fs::remove_file(manifest);
    }
}
