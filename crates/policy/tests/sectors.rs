//! The observation by sectors: hand-worked numbers, and what it promises about robots, LIDARs and motion.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use wayfield_policy::observation::{
    BodyScale, Column, FollowUp, LidarBeams, Quantity, SectorLayout, SectorObserver, Sensed,
};

const LAYOUT: SectorLayout =
    SectorLayout { count: 36, earlier_steps: 2, free_paths: true, predicted_paths: true };

/// An observer for a round robot of radius `unit_m`, with `beams` beams all around and a range of `27 * unit_m`.
fn observer(layout: SectorLayout, beams: usize, unit_m: f32) -> SectorObserver {
    let spacing_rad = TAU / beams as f32;
    let angles_rad = (0..beams).map(|beam| beam as f32 * spacing_rad).collect();
    let body = BodyScale {
        unit_m,
        extents_m: vec![unit_m; beams],
        max_speed_m_s: unit_m,
        max_turn_rad_s: 1.5,
        control_period_s: 0.2,
        goal_radius_m: 1.5 * unit_m,
    };
    SectorObserver::new(layout, &LidarBeams { angles_rad, spacing_rad, max_range_m: 27.0 * unit_m }, body)
}

fn row(observer: &SectorObserver, goal: (f32, f32)) -> Vec<f32> {
    let mut row = vec![f32::NAN; observer.layout().width()];
    observer.encode(goal, &mut row);
    row
}

/// The ranges, in m, from `pose` in a room of 2 m x 2 m around the origin, with a disc of radius 0.2 m at `disc_m`.
fn ranges(beams: usize, (x, y, heading): (f32, f32, f32), disc_m: (f32, f32)) -> Vec<f32> {
    let range = |beam: usize| {
        let angle = heading + beam as f32 * TAU / beams as f32;
        let (sin, cos) = angle.sin_cos();
        let to_wall = |at: f32, step: f32| {
            if step.abs() < 1e-6 { f32::INFINITY } else { (step.signum() - at) / step }
        };
        let (dx, dy) = (disc_m.0 - x, disc_m.1 - y);
        let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let to_disc = if along > 0.0 && across.abs() < 0.2 {
            along - (0.04 - across * across).sqrt()
        } else {
            f32::INFINITY
        };
        to_wall(x, cos).min(to_wall(y, sin)).min(to_disc)
    };
    (0..beams).map(range).collect()
}

#[test]
fn an_observation_is_what_its_columns_say() {
    let mut observer = observer(LAYOUT, 36, 0.1);
    let mut ranges_m = vec![2.7; 36];
    ranges_m[9] = 0.5; // 90 degrees to the left
    observer.sense(&Sensed { ranges_m: &ranges_m, pose: (0.0, 0.0, 0.0), twist: (0.05, -0.75) });
    let row = row(&observer, (FRAC_PI_2, 0.55));
    let columns: Vec<Column> = LAYOUT.columns().collect();
    assert_eq!((row.len(), columns.len()), (153, 153));
    for (column, value) in columns.into_iter().zip(row) {
        let expected = match (column.quantity, column.sector) {
            // The point is 4 units (0.4 m) from the body: 1 / (1 + 4 / 2). The free path towards it is as long.
            (Quantity::Nearness | Quantity::CollisionNearness | Quantity::PredictedNearness, Some(9)) => {
                1.0 / 3.0
            }
            // A path 10 degrees off passes the point at 0.87 units, so the body touches it after 4.92 - 0.50 units.
            (Quantity::CollisionNearness | Quantity::PredictedNearness, Some(8 | 10)) => {
                1.0 / (1.0 + (4.924_04 - 0.496_114) / 2.0)
            }
            (_, Some(_)) | (Quantity::GoalCosine | Quantity::WaitingNearness, None) => 0.0,
            (Quantity::GoalSine, None) => 1.0,
            // The goal's edge is 0.4 m away.
            (Quantity::GoalNearness, None) => 1.0 / 3.0,
            (Quantity::GoalLogDistance, None) => 5.0_f32.ln() / 4.0,
            (Quantity::Speed, None) => 0.5,
            (Quantity::TurningRate, None) => -0.5,
            (Quantity::StepLength, None) => 0.2,
            (Quantity::StepTurn, None) => 0.3,
            (other, None) => panic!("{other:?} is not in the layout"),
        };
        assert!((value - expected).abs() < 1e-5, "{column:?} is {value}, not {expected}");
    }
}

#[test]
fn a_robot_of_twice_the_size_in_a_world_of_twice_the_size_observes_the_same() {
    let observe = |scale: f32| {
        let mut observer = observer(LAYOUT, 24, 0.1 * scale);
        for step in 0..4 {
            let pose = (0.1 * step as f32, 0.0, 0.2 * step as f32);
            let ranges_m: Vec<f32> = ranges(24, pose, (0.7, 0.5)).iter().map(|range| range * scale).collect();
            let pose = (pose.0 * scale, pose.1 * scale, pose.2);
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.1 * scale, 0.5) });
        }
        row(&observer, (1.0, 0.8 * scale))
    };
    for (k, (one, two)) in observe(1.0).iter().zip(observe(2.0)).enumerate() {
        assert!((one - two).abs() < 1e-5, "value {k}: {one} and {two}");
    }
}

#[test]
fn every_lidar_gives_the_same_nearness_of_a_wall() {
    let nearness = |beams: usize| {
        let mut observer = observer(LAYOUT, beams, 0.1);
        let ranges_m = ranges(beams, (0.3, 0.0, 0.4), (9.0, 9.0));
        observer.sense(&Sensed { ranges_m: &ranges_m, pose: (0.0, 0.0, 0.0), twist: (0.0, 0.0) });
        row(&observer, (0.0, 1.0))[..36].to_vec()
    };
    let fine = nearness(720);
    for beams in [24, 36, 90, 360] {
        for (sector, (coarse, fine)) in nearness(beams).iter().zip(&fine).enumerate() {
            assert!((coarse - fine).abs() < 0.07, "sector {sector}, {beams} beams: {coarse} and {fine}");
        }
    }
}

#[test]
fn the_nearness_change_shows_what_approaches_and_not_the_robot_s_own_motion() {
    let changes = |disc_speed: f32| {
        let mut observer = observer(LAYOUT, 180, 0.1);
        for step in 0..3 {
            // The robot drives and turns; the disc ahead of it approaches at `disc_speed`.
            let pose = (-0.5 + 0.03 * step as f32, 0.0, 0.3 * step as f32);
            let disc_m = (0.5 - disc_speed * step as f32, 0.0);
            let ranges_m = ranges(180, pose, disc_m);
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.1, 1.5) });
        }
        row(&observer, (0.0, 1.0))[36..72].to_vec()
    };
    // After the turn of 0.6 rad, the disc is 0.6 rad to the right: 3.4 sectors.
    let sector = 36 - 3;
    let still = changes(0.0);
    assert!(still.iter().all(|change| change.abs() < 0.1), "nothing moves: {still:?}");
    let moving = changes(0.1);
    assert!(moving[sector] > 0.2, "it approaches: {moving:?}");
    let leaving = changes(-0.1);
    assert!(leaving[sector] < -0.1, "it leaves: {leaving:?}");
}

#[test]
fn predicted_paths_show_where_moving_things_will_be() {
    // The robot turns on the spot; a disc of 2 units' radius comes from the left, 6 units ahead, and continues to the right.
    let observe = |beams: usize, left_m: f32, disc_speed: f32| {
        let mut observer = observer(LAYOUT, beams, 0.1);
        for step in 0..6 {
            let pose = (-0.6, 0.0, 0.1 * (5 - step) as f32);
            let ranges_m = ranges(beams, pose, (0.0, left_m + disc_speed * (5 - step) as f32));
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.0, -0.5) });
        }
        row(&observer, (0.0, 1.0))
    };
    let columns: Vec<Column> = LAYOUT.columns().collect();
    let find = |row: &[f32], quantity: Quantity, sector: Option<usize>| {
        row[columns.iter().position(|c| (c.quantity, c.sector) == (quantity, sector)).expect("a column")]
    };
    for beams in [72, 180] {
        let still = observe(beams, 0.0, 0.0);
        let ahead = find(&still, Quantity::CollisionNearness, Some(0));
        assert!((ahead - 1.0 / (1.0 + 3.0 / 2.0)).abs() < 0.02, "3 units are free: {ahead}");
        assert_eq!(find(&still, Quantity::PredictedNearness, Some(0)), ahead, "it stays");
        // At its highest speed, 0.2 units a step, the robot would drive the 3 units in 15 steps, when the disc is 15 x 0.03 m
        // further on.
        let leaving = observe(beams, 0.0, 0.03);
        assert!((find(&leaving, Quantity::CollisionNearness, Some(0)) - ahead).abs() < 0.03);
        let predicted = find(&leaving, Quantity::PredictedNearness, Some(0));
        assert!(predicted < 0.1, "{beams} beams: it will have left: {predicted}");
        // Now it is 0.45 m to the left, and in the way after 15 steps.
        let coming = observe(beams, 0.45, 0.03);
        assert!(find(&coming, Quantity::CollisionNearness, Some(0)) < 0.2, "only the wall is ahead");
        let predicted = find(&coming, Quantity::PredictedNearness, Some(0));
        assert!((predicted - ahead).abs() < 0.06, "{beams} beams: it will be there: {predicted}");
        assert_eq!(find(&coming, Quantity::WaitingNearness, None), 0.0, "it passes a robot that waits");
    }
}

#[test]
fn predictions_are_dropped_until_the_next_reset() {
    // Whether the motion of a disc that drives past in front of the robot is predicted.
    let predicts_motion = |observer: &mut SectorObserver| {
        for step in 0..8 {
            let pose = (-0.6, 0.0, 0.0);
            let ranges_m = ranges(72, pose, (0.0, 0.03 * step as f32));
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.0, 0.0) });
        }
        let columns: Vec<Column> = LAYOUT.columns().collect();
        let row = row(observer, (0.0, 1.0));
        let all = |quantity: Quantity| -> Vec<f32> {
            columns
                .iter()
                .zip(&row)
                .filter(|(c, _)| c.quantity == quantity)
                .map(|(_, value)| *value)
                .collect()
        };
        all(Quantity::PredictedNearness) != all(Quantity::CollisionNearness)
    };
    let mut observer = observer(LAYOUT, 72, 0.1);
    assert!(predicts_motion(&mut observer), "a moving disc is predicted");
    observer.reset();
    observer.hide_predictions(1.0, 1);
    assert!(!predicts_motion(&mut observer));
    let is_hidden = |seed: &u64| {
        observer.reset();
        observer.hide_predictions(0.7, *seed);
        !predicts_motion(&mut observer)
    };
    let hidden = (0..100).filter(is_hidden).count();
    assert!((60..80).contains(&hidden), "the one disc is hidden with {hidden} of 100 seeds");
    observer.reset();
    observer.hide_predictions(1.0, 1);
    assert!(!predicts_motion(&mut observer));
    let memory = observer.memory().clone();
    observer.reset();
    assert!(predicts_motion(&mut observer));
    observer.restore(&memory, (0.0, 0.0));
    assert!(!predicts_motion(&mut observer), "a restored observer still drops predictions");
}

#[test]
fn collisions_with_still_and_moving_obstacles_are_foreseen() {
    // A disc in front stands still or comes towards the robot. The motion `ahead` is 0.2 units a step.
    let observe = |at_m: f32, speed: f32| {
        let mut observer = observer(LAYOUT, 180, 0.1);
        for step in 0..6 {
            let pose = (-0.6, 0.0, 0.0);
            let ranges_m = ranges(180, pose, (at_m + speed * (5 - step) as f32, 0.0));
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.0, 0.0) });
        }
        observer
    };
    let (ahead, stop, bend) = ((0.1, 0.0), (0.0, 0.0), (0.05, 1.5));
    // The disc's surface is 1.5 units ahead, half a unit from the body.
    let still = observe(-0.25, 0.0);
    assert_eq!(still.steps_to_collision(ahead, FollowUp::Keep(ahead)), 3.0, "the next half step after 2.5");
    assert_eq!(still.steps_to_collision(ahead, FollowUp::Keep(stop)), f32::INFINITY);
    assert_eq!(still.steps_to_collision(stop, FollowUp::Keep(stop)), f32::INFINITY);
    assert_eq!(
        still.steps_to_collision(bend, FollowUp::Keep(bend)),
        f32::INFINITY,
        "a bend with a radius of a third of a unit"
    );
    let mut reset = still.clone();
    reset.reset();
    assert_eq!(
        reset.steps_to_collision(ahead, FollowUp::Keep(ahead)),
        f32::INFINITY,
        "it has forgotten the disc"
    );
    // The same distance, but it comes nearer by 0.3 units a step.
    let coming = observe(-0.25, 0.03);
    let steps = coming.steps_to_collision(stop, FollowUp::Keep(stop));
    assert!((1.5..=2.0).contains(&steps), "0.5 / 0.3: {steps}");
    let back = coming.steps_to_collision((-0.1, 0.0), FollowUp::Keep((-0.1, 0.0)));
    assert!(steps < back && back <= 6.0, "0.5 / (0.3 - 0.2): {back}");
    let turn_to = |heading_rad| FollowUp::TurnTo { heading_rad, turns_rad_s: (1.5, -1.5), ahead_m_s: 0.1 };
    // A turn by a right angle takes more than five steps: too long if the disc arrives after two.
    assert!(still.steps_to_collision(stop, turn_to(0.0)) < 5.0);
    assert_eq!(still.steps_to_collision(stop, turn_to(PI / 2.0)), f32::INFINITY);
    assert!(coming.steps_to_collision(stop, turn_to(PI / 2.0)).is_finite());
}

#[test]
fn the_waiting_nearness_shows_what_approaches() {
    let mut observer = observer(LAYOUT, 180, 0.1);
    for step in 0..6 {
        let pose = (-0.6, 0.0, 0.0);
        let ranges_m = ranges(180, pose, (0.5 - 0.05 * step as f32, 0.0));
        observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.0, 0.0) });
    }
    // The disc, 0.55 m from the body, comes at 0.05 m a step: 11 steps to contact, in which the robot would drive 2.2 units.
    let waiting = row(&observer, (0.0, 1.0))[152];
    assert!((waiting - 1.0 / (1.0 + 2.2 / 2.0)).abs() < 0.06, "{waiting}");
}

#[test]
fn the_mirror_image_of_an_observation_is_the_observation_of_the_mirrored_world() {
    let observe = |side: f32| {
        let mut observer = observer(LAYOUT, 36, 0.1);
        for step in 0..3 {
            let pose = (-0.5 + 0.05 * step as f32, 0.1 * side, 0.2 * side * step as f32);
            let ranges_m = ranges(36, pose, (0.3, 0.4 * side - 0.1 * side * step as f32));
            observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.1, 1.0 * side) });
        }
        row(&observer, (0.7 * side, 1.0))
    };
    let (left, right) = (observe(1.0), observe(-1.0));
    for (k, (from, sign)) in LAYOUT.mirrored_columns().into_iter().enumerate() {
        assert!((right[k] - sign * left[from]).abs() < 1e-4, "value {k}: {} and {}", right[k], left[from]);
    }
}

#[test]
fn a_restored_observer_continues_bit_identically() {
    let sense = |observer: &mut SectorObserver, step: u8| {
        let pose = (0.05 * f32::from(step), 0.0, 0.3 * f32::from(step));
        let ranges_m = ranges(36, pose, (0.5, 0.3));
        observer.sense(&Sensed { ranges_m: &ranges_m, pose, twist: (0.1, f32::from(step)) });
    };
    let mut original = observer(LAYOUT, 36, 0.1);
    (0..7).for_each(|step| sense(&mut original, step));
    let saved = original.memory().clone();
    assert!(saved.fits(LAYOUT));
    let mut restored = observer(LAYOUT, 36, 0.1);
    restored.restore(&saved, (0.1, 6.0));
    assert_eq!(row(&restored, (1.0, 1.0)), row(&original, (1.0, 1.0)));
    [&mut original, &mut restored].into_iter().for_each(|observer| sense(observer, 7));
    assert_eq!(row(&restored, (1.0, 1.0)), row(&original, (1.0, 1.0)));
}

#[test]
fn a_huge_change_of_the_heading_does_not_panic() {
    let mut observer = observer(SectorLayout { predicted_paths: false, ..LAYOUT }, 36, 0.1);
    for (range_m, heading_rad) in [(2.0, 0.0), (0.5, -1e30)] {
        let pose = (0.0, 0.0, heading_rad);
        observer.sense(&Sensed { ranges_m: &[range_m; 36], pose, twist: (0.0, 0.0) });
    }
    let row = row(&observer, (0.0, 1.0));
    assert!(row[36..72].iter().any(|change| *change > 0.0), "the earlier scan is not lost: {row:?}");
}

#[test]
fn nothing_is_seen_outside_a_narrow_field_of_view() {
    let angles_rad: Vec<f32> = (0..31).map(|beam| (beam as f32 - 15.0) * PI / 30.0).collect();
    let body = BodyScale {
        unit_m: 0.1,
        extents_m: vec![0.1; 31],
        max_speed_m_s: 0.1,
        max_turn_rad_s: 1.0,
        control_period_s: 0.2,
        goal_radius_m: 0.1,
    };
    let lidar = LidarBeams { angles_rad, spacing_rad: PI / 30.0, max_range_m: 2.0 };
    let mut observer = SectorObserver::new(LAYOUT, &lidar, body);
    observer.sense(&Sensed { ranges_m: &[0.5; 31], pose: (0.0, 0.0, 0.0), twist: (0.0, 0.0) });
    let row = row(&observer, (0.0, 1.0));
    assert!(row[..10].iter().chain(&row[27..36]).all(|nearness| *nearness > 0.3), "ahead: {row:?}");
    assert!(row[11..26].iter().all(|nearness| *nearness == 0.0), "behind: {row:?}");
}
