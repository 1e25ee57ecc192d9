//! The selection: the item of the scenario that the handles and the inspector show.

/// The selected item of the scenario, or nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// No item; the inspector shows the settings of the scenario.
    #[default]
    Nothing,
    /// The boundary.
    Enclosure,
    /// An obstacle, by index.
    Obstacle(usize),
    /// An inner wall, by index.
    Wall(usize),
    /// A generator of random obstacles, by index.
    Generator(usize),
    /// The rule for starts.
    Starts,
    /// The rule for goals.
    Goals,
    /// The start of the benchmark route.
    BenchmarkStart,
    /// The goal of the benchmark route.
    BenchmarkGoal,
}

impl Selection {
    /// The item that the field at `path` belongs to; `path` is written as in diagnostics, such as
    /// `obstacles[2].shape.radius_m`.
    #[must_use]
    pub fn from_field_path(path: &str) -> Self {
        let end = path.find(['.', '[']).unwrap_or(path.len());
        let (head, rest) = path.split_at(end);
        let index = || rest.strip_prefix('[')?.split(']').next()?.parse().ok();
        let listed = |of: fn(usize) -> Self| index().map_or(Self::Nothing, of);
        match head {
            "enclosure" => Self::Enclosure,
            "obstacles" => listed(Self::Obstacle),
            "walls" => listed(Self::Wall),
            "generators" => listed(Self::Generator),
            "starts" => Self::Starts,
            "goals" => Self::Goals,
            "benchmark_route" if rest.starts_with(".goal") => Self::BenchmarkGoal,
            "benchmark_route" => Self::BenchmarkStart,
            _ => Self::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_path_names_the_item_it_belongs_to() {
        for (path, expected) in [
            ("obstacles[2].shape.radius_m", Selection::Obstacle(2)),
            ("obstacles", Selection::Nothing),
            ("walls[0].corners_m[3]", Selection::Wall(0)),
            ("generators[1].count", Selection::Generator(1)),
            ("starts.clearance_m", Selection::Starts),
            ("goals", Selection::Goals),
            ("benchmark_route.start_m[0]", Selection::BenchmarkStart),
            ("benchmark_route.goal_m", Selection::BenchmarkGoal),
            ("enclosure.width_m", Selection::Enclosure),
            ("robot.radius_m", Selection::Nothing),
            ("obstacles[x]", Selection::Nothing),
        ] {
            assert_eq!(Selection::from_field_path(path), expected, "{path}");
        }
    }
}
