//! A test of the claim in u-trap.ron and docs/worlds.md: a potential field alone gets stuck in the U-trap with every gain and
//! range tested, but succeeds in Scenario I.

use std::path::Path;

use glam::{Vec2, vec2};
use wayfield_scenario::{Motion, Scenario, clearance};

fn shipped(name: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join("scenarios").join(name);
    Scenario::load(path).unwrap_or_else(|error| panic!("{error}"))
}

/// How a drive ends.
#[derive(Debug, PartialEq)]
enum End {
    Reached,
    Collided,
    TimedOut,
}

/// Khatib's potential field: attraction to the goal, and repulsion from the nearest surface if it is within range.
struct Field {
    /// The gain of the repulsion.
    gain: f32,
    /// The range of the repulsion, in m.
    range_m: f32,
}

impl Field {
    /// The potential: 1 per metre to the goal, plus gain / 2 (1 / d - 1 / range)^2 at a distance d < range from the nearest
    /// surface.
    fn potential(&self, scenario: &Scenario, Vec2 { x, y }: Vec2) -> f32 {
        let goal = scenario.benchmark_route.expect("a benchmark route").goal_m;
        let nearest = clearance(scenario, vec2(x, y), 0).max(0.01);
        let pushed = (1.0 / nearest - 1.0 / self.range_m).max(0.0);
        (x - goal.x).hypot(y - goal.y) + self.gain / 2.0 * pushed * pushed
    }

    /// The direction of steepest descent, in rad.
    fn downhill(&self, scenario: &Scenario, Vec2 { x, y }: Vec2) -> f32 {
        let by = 0.01;
        let slope = |dx, dy| {
            self.potential(scenario, Vec2 { x: x - dx, y: y - dy })
                - self.potential(scenario, Vec2 { x: x + dx, y: y + dy })
        };
        slope(0.0, by).atan2(slope(by, 0.0))
    }

    /// The end of a drive on the benchmark route. Each step takes the motion that best turns the robot downhill.
    fn drive(&self, scenario: &Scenario) -> End {
        let (benchmark_route, task) = (scenario.benchmark_route.expect("a benchmark route"), &scenario.task);
        let (Vec2 { mut x, mut y }, mut heading) = (benchmark_route.start_m, benchmark_route.heading_rad);
        for _ in 0..task.max_episode_steps {
            let downhill = self.downhill(scenario, vec2(x, y));
            let off = |motion: &&Motion| {
                let turned = downhill - heading - motion.w_rad_s * task.control_period_s;
                turned.sin().atan2(turned.cos()).abs()
            };
            let motions = scenario.robot.motions.iter();
            let motion = motions.min_by(|a, b| off(a).total_cmp(&off(b))).expect("it has motions");
            let turn = motion.w_rad_s * task.control_period_s;
            let step = motion.v_m_s * task.control_period_s;
            (x, y) = (x + step * (heading + turn / 2.0).cos(), y + step * (heading + turn / 2.0).sin());
            heading += turn;
            if (x - benchmark_route.goal_m.x).hypot(y - benchmark_route.goal_m.y) < task.goal_radius_m {
                return End::Reached;
            }
            if clearance(scenario, vec2(x, y), 0) < task.collision_range_m {
                return End::Collided;
            }
        }
        End::TimedOut
    }
}

#[test]
fn a_potential_field_alone_gets_stuck_in_the_u() {
    let (open, trap) = (shipped("scenario-1.ron"), shipped("u-trap.ron"));
    for gain in [0.05, 0.1, 0.2, 0.4] {
        for range_m in [0.4, 0.5, 0.6, 0.7, 0.8] {
            let field = Field { gain, range_m };
            assert_eq!(field.drive(&open), End::Reached, "Scenario I: gain {gain}, range {range_m} m");
            assert_eq!(field.drive(&trap), End::TimedOut, "the U: gain {gain}, range {range_m} m");
        }
    }
}
