//! Changes of kind: motion, start and goal rules, enclosure.

use super::*;

#[test]
fn every_new_motion_fits_the_scenario() {
    for at in [vec2(0.0, -0.6), vec2(-1.7, -1.7), vec2(1.0, 1.8), vec2(0.6, 0.0)] {
        for (kind, ..) in MotionKind::ALL {
            for shape in [Shape::Circle { radius_m: 0.1 }, Shape::Rectangle { width_m: 0.2, height_m: 0.1 }] {
                let scenario =
                    Scenario { obstacles: vec![static_obstacle(shape, at)], ..Scenario::default() };
                let mut editor = editor(scenario);
                editor.select(Selection::Obstacle(0));
                editor.set_motion(kind);
                assert_eq!(editor.scenario().obstacles[0].motion.kind(), kind);
                let of_obstacles = |problem: &&Diagnostic| problem.path.starts_with("obstacles");
                assert_eq!(editor.diagnostics().iter().find(of_obstacles), None, "{kind:?} at {at:?}");
            }
        }
    }
}

#[test]
fn changing_between_patrol_and_back_and_forth_keeps_the_path() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.set_motion(MotionKind::BackAndForth);
    let expected = ObstacleMotion::BackAndForth {
        waypoints_m: vec![vec2(1.0, 1.5), vec2(0.5, 1.5)],
        speed_m_s: 0.1.into(),
    };
    assert_eq!(editor.scenario().obstacles[1].motion, expected);
    editor.set_motion(MotionKind::Patrol);
    assert_eq!(editor.scenario().obstacles[1], full().obstacles[1]);
}

#[test]
fn a_range_of_speeds_is_kept_where_the_new_motion_can_have_one() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.set_motion(MotionKind::Pedestrian);
    editor.edit("speed", |s| {
        if let ObstacleMotion::Pedestrian { speed_m_s, .. } = &mut s.obstacles[1].motion {
            *speed_m_s = Ranged::Range(0.2, 0.4);
        }
    });
    for kind in [MotionKind::Patrol, MotionKind::RandomWalk, MotionKind::BackAndForth] {
        editor.set_motion(kind);
        let (ObstacleMotion::Patrol { speed_m_s, .. }
        | ObstacleMotion::BackAndForth { speed_m_s, .. }
        | ObstacleMotion::RandomWalk { speed_m_s, .. }) = editor.scenario().obstacles[1].motion
        else {
            panic!("another motion than {kind:?}");
        };
        assert_eq!(speed_m_s, Ranged::Range(0.2, 0.4), "{kind:?}");
    }
    editor.set_motion(MotionKind::KeyFrames);
    let mean = editor.scenario().obstacles[1].mean_speed_m_s().expect("it moves");
    assert!((mean - 0.3).abs() < 0.01, "the middle, not {mean}");
    editor.set_motion(MotionKind::RandomWalk);
    let ObstacleMotion::RandomWalk { speed_m_s, .. } = editor.scenario().obstacles[1].motion else {
        panic!("another motion than a random walk");
    };
    assert!((speed_m_s.value() - 0.3).abs() < 0.01, "the speed of the key frames, not {speed_m_s:?}");
}

#[test]
fn an_open_path_stays_open_as_key_frames_or_goals_of_a_pedestrian() {
    for kind in [MotionKind::KeyFrames, MotionKind::Pedestrian] {
        let mut editor = editor(full());
        editor.select(Selection::Obstacle(1));
        editor.set_motion(MotionKind::BackAndForth);
        let path_m = editor.scenario().obstacles[1].path_m();
        editor.set_motion(kind);
        assert_eq!(editor.scenario().obstacles[1].path_m(), path_m, "{kind:?}");
    }
}

#[test]
fn a_new_orbit_is_centred_in_the_scenario_if_it_fits() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    editor.set_motion(MotionKind::Orbit);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15.into() };
    assert_eq!(editor.scenario().obstacles[0].motion, expected);
    // From so far out, an orbit around (0, 0) would cross the boundary; around a point half a metre to the left, it fits.
    editor.edit("x", |s| s.obstacles[0] = circle(1.5, 1.3));
    editor.set_motion(MotionKind::Orbit);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(1.0, 1.3), speed_rad_s: 0.15.into() };
    assert_eq!(editor.scenario().obstacles[0].motion, expected);
}

#[test]
fn changing_a_rule_keeps_what_both_kinds_have() {
    let mut editor = editor(full());
    editor.set_rule(PlacementRole::Goals, PlacementKind::Fixed);
    assert_eq!(editor.selection(), Selection::Goals);
    assert_eq!(
        editor.scenario().goals,
        PlacementRule::Fixed { position_m: vec2(0.0, 1.5), heading_rad: None }
    );
    editor.set_rule(PlacementRole::Goals, PlacementKind::OneOf);
    assert_eq!(editor.scenario().goals, PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5)] });
    editor.edit("clearance", |s| s.starts = PlacementRule::Random { clearance_m: 0.5 });
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    let (min_m, max_m) = (vec2(-1.0, -1.0), vec2(1.0, 1.0));
    assert_eq!(editor.scenario().starts, PlacementRule::Within { min_m, max_m, clearance_m: 0.5 });
    editor.set_rule(PlacementRole::Starts, PlacementKind::Fixed);
    assert_eq!(
        editor.scenario().starts,
        PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: None }
    );
    editor.delete();
    assert_eq!(editor.scenario().starts, PlacementRule::default());
    assert!(!editor.can_delete(), "the default rule cannot be deleted");
}

#[test]
fn a_new_rule_has_room_for_a_large_robot() {
    let mut scenario = full();
    scenario.starts = PlacementRule::Fixed { position_m: vec2(1.0, -1.0), heading_rad: None };
    scenario.robot.radius_m = 0.5;
    scenario.task.collision_range_m = 0.51;
    let mut editor = editor(scenario);
    editor.set_rule(PlacementRole::Starts, PlacementKind::Random);
    assert_eq!(editor.scenario().starts, PlacementRule::Random { clearance_m: 0.53 });
}

#[test]
fn an_enclosure_can_become_a_polygon_and_a_rectangle_again() {
    let mut editor = editor(full());
    editor.set_enclosure(EnclosureKind::Polygon);
    let corners_m = vec![vec2(-2.0, -2.0), vec2(2.0, -2.0), vec2(2.0, 2.0), vec2(-2.0, 2.0)];
    assert_eq!(editor.scenario().enclosure, Enclosure::Polygon { corners_m });
    editor.edit("corner", |s| {
        if let Enclosure::Polygon { corners_m } = &mut s.enclosure {
            corners_m[2] = vec2(3.0, 2.0);
        }
    });
    editor.set_enclosure(EnclosureKind::Rectangle);
    assert_eq!(editor.scenario().enclosure, Enclosure::Rectangle { width_m: 6.0, height_m: 4.0 });
}
