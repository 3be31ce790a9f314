//! Names of files in a report's Markdown: whatever they hold, they stay names.

use crate::common::{SCENE, grid};
use afmsweep::report::{self, ViewRequest};
use afmsweep::store::Writer;
use std::fs;

/// Truth: CommonMark, where a code span ends at as many backticks as it began with.
#[test]
fn no_name_of_a_file_leaves_its_place_in_the_markdown() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a.h5");
    let mut writer = Writer::create(&file, SCENE, true).unwrap();
    writer.write(&grid()).unwrap();
    writer.finish().unwrap();
    for name in ["a`<script>alert(1)<b>.h5", "``b`.h5", "c\n# Heading.h5", "d\u{202e}5h.h5"] {
        let nasty = home.path().join(name);
        fs::copy(&file, &nasty).unwrap();
        let folder = home.path().join("page");
        report::write(&nasty, Some(&folder), &ViewRequest::default()).unwrap();
        let text = fs::read_to_string(folder.join("report.md")).unwrap();
        let line = text.lines().find_map(|line| line.strip_prefix("From ")).unwrap();
        let fence: String = line.chars().take_while(|c| *c == '`').collect();
        let inside = &line[fence.len()..];
        let end = inside
            .match_indices(&fence)
            .map(|(at, _)| at)
            .find(|at| !inside[..*at].ends_with('`') && !inside[at + fence.len()..].starts_with('`'));
        let inside = &inside[..end.unwrap_or_else(|| panic!("the span has no end: {line}"))];
        assert!(inside.trim_end().ends_with(".h5"), "{line}");
        assert!(!text.contains("\n# Heading") && !text.contains('\u{202e}'), "{text}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
