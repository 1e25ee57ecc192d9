//! The options of an import.

use std::path::{Path, PathBuf};

use wayfield_scenario::{FileError, Scenario};

use crate::limits::{LIDAR_HEIGHT_M, RESOLUTION_M, TOLERANCE_M};

/// The options of an import. The defaults suit a ROS map and a TurtleBot3.
#[derive(Clone, Debug)]
pub struct ImportOptions {
    /// Side of a pixel of a plain image, in m. Maps state their own.
    pub resolution_m: Option<f64>,
    /// How far the walls may be from the cells of a map, in m. 0 keeps every cell. `None` is the side of a cell plus half the
    /// thickness of a wall (0.01 m).
    pub tolerance_m: Option<f64>,
    /// Specks of up to this many cells, such as noise in a SLAM map, count as floor.
    pub speck_cells: usize,
    /// Height of the LIDAR above the ground, in m, at which the shapes of an SDF world are cut.
    pub lidar_height_m: f64,
    /// Folders that are searched for the models of an SDF world, in this order.
    pub models: Vec<PathBuf>,
    /// The number of the world in a file of BARN worlds, or of the stage in a file of stages.
    pub world: Option<u32>,
    /// The scenario whose robot, LIDAR and rules are used. `None` is the default scenario; for a BARN world or a stage, the
    /// robot and rules of BARN or of turtlebot3_drlnav.
    pub robot_from: Option<Scenario>,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            resolution_m: None,
            tolerance_m: None,
            speck_cells: 0,
            // That of the LDS-01 or LDS-02 on a TurtleBot3 Burger.
            lidar_height_m: 0.18,
            models: Vec::new(),
            world: None,
            robot_from: None,
        }
    }
}

impl ImportOptions {
    /// Checks that all numbers are in their ranges ([`limits`](crate::limits)).
    ///
    /// # Errors
    /// A number is out of range. The error names `path`.
    pub(crate) fn check(&self, path: &Path) -> Result<(), FileError> {
        let numbers = [
            ("the resolution", self.resolution_m, RESOLUTION_M),
            ("the tolerance", self.tolerance_m, TOLERANCE_M),
            ("the height of the LIDAR", Some(self.lidar_height_m), LIDAR_HEIGHT_M),
        ];
        for (what, value, range) in numbers {
            if let Some(value) = value.filter(|value| !range.contains(value)) {
                let (low, high) = (range.start(), range.end());
                let message = format!("{what} is {value}; help: give {low} to {high} (metres)");
                return Err(FileError::for_file(path, message));
            }
        }
        Ok(())
    }
}
