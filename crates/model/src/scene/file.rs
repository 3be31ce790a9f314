//! The bytes of a scene file: that there is one, that it is text, and whose it may be.

use super::Scene;
use super::scene_error::{Checked, Fault, SceneError, line_column};
use super::scene_reader::parse;
use crate::suggestion::nearest;
use std::io::Read;
use std::path::Path;

/// More than any scene needs, but a list of a million samples fits; a device file or a video does not.
const LARGEST_FILE: u64 = 256 << 20;

/// Reads the file and then its text.
pub(super) fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = read_bytes(path).map_err(|fault| fault.in_file(path, ""))?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let offset = error.utf8_error().valid_up_to();
            let bytes = error.into_bytes();
            let text = String::from_utf8_lossy(&bytes);
            return Err(not_utf8(&bytes, &text, offset).in_file(path, &text));
        }
    };
    parse(path, &text, None)
}

fn read_bytes(path: &Path) -> Checked<Vec<u8>> {
    let refuse = |error: std::io::Error| {
        let help = match error.kind() {
            std::io::ErrorKind::NotFound => return missing(path),
            std::io::ErrorKind::PermissionDenied => "check the file's permissions",
            std::io::ErrorKind::IsADirectory => "give the scene file inside it",
            _ => "give a readable TOML file",
        };
        Fault::whole(format!("cannot read the scene {}: {error}", path.display())).help(help)
    };
    let file = std::fs::File::open(path).map_err(refuse)?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(refuse)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(Fault::whole(format!("the scene file is larger than {} MiB", LARGEST_FILE >> 20))
            .help("give a TOML scene; large designs are best written as [sweep] axes"));
    }
    Ok(bytes)
}

/// No file of that name: perhaps one of the folder was meant.
fn missing(path: &Path) -> Box<Fault> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names: Vec<String> = entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .collect();
    let wanted = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let near = nearest(&wanted, names.iter().map(String::as_str));
    Fault::whole(format!("cannot read the scene {}: there is no such file", path.display()))
        .help("check the name and the folder; `afmsweep init > lever.toml` writes a scene to begin with")
        .maybe_help(near.map(|name| format!("did you mean {}?", path.with_file_name(name).display())))
}

/// The first bytes of HDF5 files.
const HDF5: [u8; 4] = *b"\x89HDF";

fn not_utf8(bytes: &[u8], text: &str, offset: usize) -> Box<Fault> {
    if bytes.starts_with(&HDF5) {
        return Fault::whole("this is a results file, not a scene")
            .expected("a TOML file")
            .help("`afmsweep report` and `afmsweep check` take results files");
    }
    let (line, column) = line_column(text, offset);
    let byte = bytes.get(offset).copied().unwrap_or_default();
    let help = if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        "this looks like UTF-16: save the file as UTF-8"
    } else {
        "save the file as UTF-8; a micro sign may also be written u, as in \"um\""
    };
    Fault::at(offset..offset + char::REPLACEMENT_CHARACTER.len_utf8(), "the scene file is not UTF-8 text")
        .label(format!("found byte 0x{byte:02X} at offset {offset} (line {line}, column {column})"))
        .expected("UTF-8 text")
        .help(help)
}
