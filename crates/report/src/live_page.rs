//! The page of `afmsweep live`: one file with all that it needs, the engine for WebAssembly among it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

/// A file of the live page.
macro_rules! page_file {
    ($name:literal) => {
        include_str!(concat!("../../web/page/", $name))
    };
}
pub(super) use page_file;

/// The page's own scripts, which share one scope; each needs only those before it to be read.
const SCRIPTS: &[&str] = &[
    page_file!("units.js"),
    page_file!("toml.js"),
    page_file!("scene.js"),
    page_file!("quantities.js"),
    page_file!("state.js"),
    page_file!("link.js"),
    page_file!("engine.js"),
    page_file!("plots.js"),
    page_file!("curve.js"),
    page_file!("curveview.js"),
    page_file!("motion.js"),
    page_file!("surface.js"),
    page_file!("map.js"),
    page_file!("mapview.js"),
    page_file!("controls.js"),
    page_file!("work.js"),
    page_file!("refresh.js"),
    page_file!("told.js"),
    page_file!("save.js"),
    page_file!("tours.js"),
    page_file!("tour.js"),
    page_file!("page.js"),
];

/// The page that begins with `start`: its `title`, the `base` scene, and makers' `levers` (crates/web/page/scene.js reads them).
/// `engine` is the library for WebAssembly, packed by zstd.
pub fn live_page(start: &Value, engine: &[u8]) -> String {
    let parts = [("/*ENGINE*/", STANDARD.encode(engine)), ("/*WORKER*/", WORKER.to_owned())];
    assembled(page_file!("page.html"), SCRIPTS, start, &parts)
}

/// The script of the workers that the engine runs in.
pub(super) const WORKER: &str = page_file!("worker.js");

/// A page of one file: the frame with the style, the scripts, what it starts with and other parts in the places of their marks.
pub(super) fn assembled(frame: &str, scripts: &[&str], start: &Value, more: &[(&str, String)]) -> String {
    let style = [page_file!("page.css"), page_file!("vendor/uplot/uPlot.min.css")].concat();
    // Their licences ask to travel with them. A semicolon ends the last statement of each.
    let libraries = [
        (page_file!("vendor/uplot/LICENSE"), page_file!("vendor/uplot/uPlot.iife.min.js")),
        (page_file!("vendor/fzstd/LICENSE"), page_file!("vendor/fzstd/fzstd.umd.min.js")),
    ]
    .map(|(licence, script)| format!("/*\n{licence}*/\n{script};"))
    .join("\n");
    let scripts = format!("{libraries}\n(() => {{\n'use strict';\n{}\n}})();", scripts.join("\n"));
    // No text of a scene may end the element that it stands in.
    let start = start.to_string().replace('<', "\\u003c");
    let own = [("/*STYLE*/", style), ("/*SCRIPTS*/", scripts), ("/*START*/", start)];
    let parts: Vec<&(&str, String)> = own.iter().chain(more).collect();
    // From piece to piece: what was put in is not looked through again.
    let mut page = String::new();
    let mut rest = frame;
    while let Some((at, (mark, text))) =
        parts.iter().filter_map(|part| Some((rest.find(part.0)?, part))).min_by_key(|(at, _)| *at)
    {
        page += &rest[..at];
        page += text;
        rest = &rest[at + mark.len()..];
    }
    page + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Truth: the parts themselves, each once, and no text that could leave its element.
    #[test]
    fn every_part_stands_in_the_page_once() {
        let page = live_page(&json!({ "title": "</script>/*ENGINE*/" }), b"an engine");
        assert_eq!(page.matches(&STANDARD.encode(b"an engine")).count(), 1);
        assert!(page.contains(r#"{"title":"\u003c/script>/*ENGINE*/"}"#));
        for script in SCRIPTS {
            assert_eq!(page.matches(script.trim_end()).count(), 1, "{script}");
        }
        for mark in ["STYLE", "SCRIPTS", "WORKER", "START"] {
            assert!(!page.contains(&format!("/*{mark}*/")), "{mark}");
        }
        for outside in ["src=", "@import", "url(", "<link"] {
            assert!(!page.contains(outside), "{outside}: the page is one file");
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/page");
        let scripts = std::fs::read_dir(folder)
            .unwrap()
            .filter_map(|entry| entry.unwrap().path().to_str()?.strip_suffix(".js").map(|_| ()));
        assert_eq!(scripts.count(), SCRIPTS.len() + 1, "each script, and the worker's");
    }
}
