//! What a page tells of the place below the pointer: values of points and of cells, as data beside the picture.

use serde_json::json;

/// More cells than this in a picture are not told one by one: the data would be larger than the page.
const MOST_CELLS: usize = 20_000;

/// A point and what it stands for.
pub(super) type Hint = ((f64, f64), String);

/// What lies where in a picture, in its pixels.
#[derive(Clone, Debug, Default)]
pub(super) struct Hover {
    fields: Vec<serde_json::Value>,
    cells: usize,
}

/// The cells of one map.
pub(super) struct HoverCells {
    /// Left and upper end.
    pub corner: (f64, f64),
    /// Right ends of the columns.
    pub right: Vec<f64>,
    /// Upper ends of the rows, the lowest row first.
    pub top: Vec<f64>,
    /// Lower end of the lowest row.
    pub bottom: f64,
    /// What the columns and the rows stand for.
    pub x: Vec<String>,
    pub y: Vec<String>,
    /// The lowest row first.
    pub values: Vec<String>,
}

impl Hover {
    /// Points with what they stand for.
    pub fn points(&mut self, points: Vec<Hint>) {
        let points: Vec<serde_json::Value> =
            points.into_iter().map(|((x, y), text)| json!([tenth(x), tenth(y), text])).collect();
        self.fields.push(json!({ "points": points }));
    }

    /// The cells of a map.
    pub fn cells(&mut self, cells: HoverCells) {
        self.cells += cells.values.len();
        if self.cells > MOST_CELLS {
            self.fields.clear();
            return;
        }
        let tenths = |list: &[f64]| list.iter().map(|value| tenth(*value)).collect::<Vec<f64>>();
        self.fields.push(json!({
            "left": tenth(cells.corner.0),
            "upper": tenth(cells.corner.1),
            "right": tenths(&cells.right),
            "top": tenths(&cells.top),
            "bottom": tenth(cells.bottom),
            "x": cells.x,
            "y": cells.y,
            "values": cells.values,
        }));
    }

    /// The data as JSON that may stand inside a page.
    pub fn json(&self) -> Option<String> {
        let text = serde_json::to_string(&self.fields).ok()?;
        let safe = text.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026");
        (!self.fields.is_empty()).then_some(safe)
    }
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// Shows it. Written without the signs that pages and XML reserve.
pub(super) const SCRIPT: &str = include_str!("hover.js").trim_ascii_end();

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: HTML ends a script at its closing tag, wherever that stands; XML reserves the ampersand too.
    #[test]
    fn data_and_script_may_stand_inside_a_page() {
        let mut hover = Hover::default();
        hover.points(vec![((1.25, 2.0), "</script><b>&".into())]);
        let json = hover.json().unwrap();
        for text in [&json, SCRIPT] {
            assert!(!text.contains(['<', '&']), "{text}");
        }
        let back: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(back[0]["points"][0], json!([1.3, 2.0, "</script><b>&"]));
    }

    #[test]
    fn too_many_cells_are_not_told() {
        let cells = |count: usize| HoverCells {
            corner: (0.0, 0.0),
            right: vec![1.0],
            top: vec![0.0],
            bottom: 1.0,
            x: Vec::new(),
            y: Vec::new(),
            values: vec![String::new(); count],
        };
        let mut hover = Hover::default();
        hover.cells(cells(MOST_CELLS));
        assert!(hover.json().is_some());
        hover.cells(cells(1));
        assert_eq!(hover.json(), None);
    }
}
