//! Domain randomization: a range in place of a number is read, written and checked at both ends; each layout seed draws from it.

use wayfield_scenario::{ObstacleMotion, Ranged, Scenario, notes, to_text, with_setting};

const TEXT: &str = "(
    name: \"Ranges\", // as written
    obstacles: [
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.6, 0.6),
            motion: Orbit(centre_m: (0.0, 0.0), speed_rad_s: (-0.2, 0.2)),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (-1.0, -1.0),
            motion: BackAndForth(waypoints_m: [(1.0, -1.0)], speed_m_s: (0.05, 0.1)),
        ),
    ],
    robot: (actuator_lag_s: (0.0, 0.3)),
    lidar: (noise_std_m: ( 0.0, 0.02 ), dropout: 0.01, latency_steps: (1, 3)),
)
";

fn scenario() -> Scenario {
    Scenario::parse(TEXT, "ranges.ron").unwrap_or_else(|error| panic!("{error}"))
}

/// The problems of the text in which `from` is replaced by `to`.
fn problems(from: &str, to: &str) -> String {
    let text = TEXT.replace(from, to);
    assert_ne!(text, TEXT);
    Scenario::parse(&text, "ranges.ron").expect_err(to).to_string()
}

fn speed(scenario: &Scenario, index: usize) -> Ranged<f32> {
    scenario.obstacles[index].motion.given_speed().expect("it moves")
}

#[test]
fn ranges_are_read_and_written_back_as_they_were() {
    let mut scenario = scenario();
    assert_eq!(scenario.lidar.noise_std_m, Ranged::Range(0.0, 0.02));
    assert_eq!(scenario.lidar.dropout, Ranged::Number(0.01));
    assert_eq!(scenario.lidar.latency_steps, Ranged::Range(1, 3));
    assert_eq!(to_text(&scenario, Some(TEXT)), TEXT);
    let written = to_text(&scenario, None);
    assert_eq!(Scenario::parse(&written, "written.ron").expect("valid"), scenario, "{written}");
    scenario.lidar.noise_std_m = Ranged::Range(0.0, 0.05);
    scenario.lidar.latency_steps = Ranged::Number(2);
    let edited = TEXT.replace("( 0.0, 0.02 )", "( 0.0, 0.05 )").replace("(1, 3)", "2");
    assert_eq!(to_text(&scenario, Some(TEXT)), edited);
}

#[test]
fn a_setting_takes_a_range() {
    let set = with_setting(&Scenario::default(), "lidar.noise_std_m", "(0.01, 0.02)").expect("a range");
    assert_eq!(set.lidar.noise_std_m, Ranged::Range(0.01, 0.02));
    let back = with_setting(&set, "lidar.noise_std_m", "0.01").expect("a number");
    assert_eq!(back.lidar.noise_std_m, Ranged::Number(0.01));
}

#[test]
fn both_ends_of_a_range_are_checked() {
    for (from, to, expected) in [
        ("( 0.0, 0.02 )", "(-0.1, 0.02)", "`lidar.noise_std_m[0]` is -0.1: write a number from 0 to 10"),
        ("( 0.0, 0.02 )", "(0.0, 11.0)", "`lidar.noise_std_m[1]` is 11: write a number from 0 to 10"),
        ("( 0.0, 0.02 )", "(0.2, 0.1)", "`lidar.noise_std_m` is (0.2, 0.1): write the smaller number first"),
        ("(1, 3)", "(1, 51)", "`lidar.latency_steps[1]` is 51: write a number from 0 to 50"),
        ("(0.0, 0.3)", "(0.0, 10.5)", "`robot.actuator_lag_s[1]` is 10.5"),
        ("(0.05, 0.1)", "(0.05, 5.5)", "`obstacles[1].motion.speed_m_s[1]` is 5.5"),
        ("(0.05, 0.1)", "(0.0, 4.0)", "moves the obstacle 0.800 m in one control step"),
        (
            "actuator_lag_s: (0.0, 0.3)",
            "slip: (forward: 0.0, turning: (0.0, 0.95), std: 0.0)",
            "`robot.slip.turning[1]` is 0.95: write a number from 0 to 0.9",
        ),
        (
            "actuator_lag_s: (0.0, 0.3)",
            "odometry_drift: (distance_error: 0.6, rotation_error: 0.1, heading_drift_rad_m: 0.0)",
            "`robot.odometry_drift.distance_error` is 0.6: write a number from -0.5 to 0.5",
        ),
        (
            "actuator_lag_s: (0.0, 0.3)",
            "max_acceleration_m_s2: 0.0",
            "`robot.max_acceleration_m_s2` is 0: write a number from 0.01 to 1000",
        ),
        ("(-0.2, 0.2)", "(-7.0, 0.1)", "moves the obstacle 1.188 m in one control step"),
    ] {
        let found = problems(from, to);
        assert!(found.contains(expected), "{to}: {found}");
    }
}

#[test]
fn values_other_than_numbers_and_ranges_are_rejected_with_an_explanation() {
    for (to, expected) in [
        ("\"0.1\"", "`lidar.noise_std_m` must be a number, or a range (lowest, highest), without quotes"),
        ("(0.1)", "a number, or a range (lowest, highest)"),
        (
            "(0.1, 0.2, 0.3)",
            "`lidar.noise_std_m` must end before this: a `)` is missing, or it has too many parts",
        ),
        ("(lowest: 0.1, highest: 0.2)", "a number, or a range (lowest, highest)"),
        ("low", "a number, or a range (lowest, highest)"),
    ] {
        let found = problems("( 0.0, 0.02 )", to);
        assert!(found.contains("ranges.ron:16:") && found.contains(expected), "{to}: {found}");
    }
    for to in ["1.5", "-1", "(0, 1.5)"] {
        let found = problems("(1, 3)", to);
        assert!(found.contains("`lidar.latency_steps") && found.contains("whole number"), "{to}: {found}");
    }
}

#[test]
fn drawn_numbers_cover_their_whole_ranges() {
    let scenario = scenario();
    assert!(scenario.has_ranges() && scenario.varies_by_episode());
    let drawn: Vec<Scenario> = (0..500).map(|seed| scenario.with_generated_obstacles(seed)).collect();
    assert!(drawn.iter().all(|drawn| !drawn.has_ranges() && drawn.lidar.dropout == 0.01.into()));
    assert_eq!(drawn[7], scenario.with_generated_obstacles(7), "the same seed gives the same numbers");
    let covers = |low: f32, high: f32, of: &dyn Fn(&Scenario) -> f32| {
        let numbers: Vec<f32> = drawn.iter().map(of).collect();
        let span = (high - low) * 0.05;
        assert!(numbers.iter().all(|number| (low..=high).contains(number)), "{low} to {high}");
        assert!(numbers.iter().any(|number| *number < low + span), "some are near {low}");
        assert!(numbers.iter().any(|number| *number > high - span), "some are near {high}");
    };
    covers(-0.2, 0.2, &|drawn| speed(drawn, 0).value());
    covers(0.05, 0.1, &|drawn| speed(drawn, 1).value());
    covers(0.0, 0.3, &|drawn| drawn.robot.actuator_lag_s.value());
    covers(0.0, 0.02, &|drawn| drawn.lidar.noise_std_m.value());
    let count = |steps: u32| drawn.iter().filter(|drawn| drawn.lidar.latency_steps == steps.into()).count();
    let counts = [1, 2, 3].map(count);
    assert!(counts.iter().sum::<usize>() == 500 && counts.iter().all(|count| *count > 120), "{counts:?}");
}

#[test]
fn a_number_drawn_from_a_range_does_not_depend_on_other_ranges() {
    let all = scenario();
    let mut some = all.clone();
    some.robot.actuator_lag_s = 0.0.into();
    some.obstacles[0].motion = ObstacleMotion::Static;
    let [all, some] = [all, some].map(|scenario| scenario.with_generated_obstacles(5));
    assert_eq!((&all.lidar, speed(&all, 1)), (&some.lidar, speed(&some, 1)));
}

#[test]
fn a_note_considers_the_highest_speed_of_a_range() {
    let text = TEXT.replace("(0.05, 0.1)", "(0.05, 0.3)");
    let notes = notes(&Scenario::parse(&text, "ranges.ron").expect("valid"));
    let found: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert!(found.iter().any(|note| note.contains("at up to 0.300 m/s")), "{found:?}");
}
