//! The four sides of a plate, where loads and supports act.

use super::geometry::{bounding_box, edges};
use super::{Point, Specimen};

crate::kinds! {
    /// Sides of a plate: the straight stretches of the outline that lie on its bounding box.
    pub enum Edge for "loading.edges" {
        Top = "top": "side at the largest y",
        Bottom = "bottom": "side at the smallest y",
        Left = "left": "side at the smallest x",
        Right = "right": "side at the largest x",
    }
}

crate::kinds! {
    /// Components a support holds.
    pub enum Component for "supports.fix" {
        X = "x": "no displacement along x",
        Y = "y": "no displacement along y",
    }
}

impl Edge {
    /// Unit vector out of the plate.
    pub fn normal(self) -> Point {
        match self {
            Edge::Top => [0.0, 1.0],
            Edge::Bottom => [0.0, -1.0],
            Edge::Left => [-1.0, 0.0],
            Edge::Right => [1.0, 0.0],
        }
    }

    /// Stretches of the outline on this side; empty where only a corner touches the bounding box.
    pub fn stretches(self, specimen: &Specimen) -> Vec<(Point, Point)> {
        let [low, high] = bounding_box(&specimen.outline);
        let (axis, place) = match self {
            Edge::Top => (1, high[1]),
            Edge::Bottom => (1, low[1]),
            Edge::Left => (0, low[0]),
            Edge::Right => (0, high[0]),
        };
        let near = 1e-9 * (high[0] - low[0]).max(high[1] - low[1]);
        edges(&specimen.outline).filter(|(a, b)| (a[axis] - place).abs() <= near && (b[axis] - place).abs() <= near).collect()
    }
}
