//! A scenario, parsed from text, checked, and drawn as an image.
//!
//! `cargo run --release --no-default-features --example draw_scenario -- [FILE.svg]`

use std::path::PathBuf;

use wayfield::run::scenario_image;
use wayfield::scenario::Scenario;

const SCENARIO: &str = r#"(
    name: "A box and a patrol",
    obstacles: [
        (shape: Rectangle(width_m: 0.6, height_m: 0.3), position_m: (0.8, 0.5), rotation_rad: 0.4),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (-0.8, -0.8),
            motion: Patrol(waypoints_m: [(-0.8, 0.8)], speed_m_s: 0.1),
        ),
    ],
)"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args_os().nth(1).map_or_else(|| "scenario.svg".into(), PathBuf::from);
    // An error message has the line, the column and a suggested fix.
    let scenario = Scenario::parse(SCENARIO, "draw_scenario.rs")?;
    scenario_image::draw(&scenario, &file)?;
    println!("{} with {} obstacles, drawn to {}", scenario.name, scenario.obstacles.len(), file.display());
    Ok(())
}
