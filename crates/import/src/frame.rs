//! The pose of a scenario in the frame of the file that it was imported from, as a sentence in its `about`.

use std::fmt;

use glam::{DVec2, dvec2};

/// The pose of a scenario's (0, 0) in the source's frame. A scenario imported from a map has the axes of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Position in m.
    pub origin_m: DVec2,
    /// Rotation in rad, counterclockwise.
    pub yaw_rad: f64,
}

const ROTATE: &str = "Source coordinates: rotate by ";
const ADD: &str = " rad, then add (";

impl fmt::Display for Frame {
    /// The sentence that [`Frame::find`] reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Adding 0 turns -0 into 0.
        let DVec2 { x, y } = (self.origin_m * 1e6).round() / 1e6 + DVec2::ZERO;
        write!(f, "{ROTATE}{}{ADD}{x}, {y}) m.", self.yaw_rad)
    }
}

impl Frame {
    /// The frame that the `about` of an imported scenario states.
    #[must_use]
    pub fn find(about: &str) -> Option<Self> {
        let (_, rest) = about.rsplit_once(ROTATE)?;
        let (yaw, rest) = rest.split_once(ADD)?;
        let (x, rest) = rest.split_once(", ")?;
        let (y, _) = rest.split_once(") m.")?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|value| value.is_finite());
        Some(Self { origin_m: dvec2(number(x)?, number(y)?), yaw_rad: number(yaw)? })
    }

    /// Converts a point, in m, from the source's frame to the scenario's.
    #[must_use]
    pub fn to_scenario(self, source_m: DVec2) -> DVec2 {
        DVec2::from_angle(-self.yaw_rad).rotate(source_m - self.origin_m)
    }

    /// Converts a point, in m, from the scenario's frame to the source's.
    #[must_use]
    pub fn to_source(self, scenario_m: DVec2) -> DVec2 {
        self.origin_m + DVec2::from_angle(self.yaw_rad).rotate(scenario_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_is_read_back_and_points_convert_both_ways() {
        let frame = Frame { origin_m: dvec2(-10.25, 0.1 + 0.2), yaw_rad: 1.0 };
        let found = Frame::find(&format!("Imported. {frame}")).expect("it is there");
        assert_eq!(found, Frame { origin_m: dvec2(-10.25, 0.3), ..frame });
        let there = frame.to_source(dvec2(1.0, 2.0));
        assert!(frame.to_scenario(there).distance(dvec2(1.0, 2.0)) < 1e-12);
        assert_eq!(Frame::find("Made by hand."), None);
    }
}
