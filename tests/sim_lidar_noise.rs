//! LIDAR noise and dropout have the scenario's parameters, affect the policy only, and are repeatable.

mod common;

use common::{Lab, bits};
use wayfield::scenario::Scenario;
use wayfield::task::{Pose, wrap_angle};

/// The true and the reported range of every beam, from robots that drive in circles at the centre of an enclosure whose
/// walls are within the LIDAR's range.
fn ranges(scenario: &Scenario, steps: usize, seed: u64) -> Vec<(f32, f32)> {
    let arenas = 16;
    let mut lab = Lab::new(scenario, arenas, seed);
    for arena in 0..arenas {
        let heading_rad = wrap_angle(arena as f32);
        lab.edit(arena, |state| state.pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad });
    }
    let mut pairs = Vec::new();
    for _ in 0..steps {
        lab.step(&vec![0; arenas]);
        for (arena, state) in lab.states().iter().enumerate() {
            let clean = lab.cast(arena, &state.pose);
            let nearest = clean.iter().copied().fold(f32::INFINITY, f32::min);
            assert_eq!(state.scan.nearest_m, nearest, "collisions and rewards use ranges without noise");
            pairs.extend(clean.into_iter().zip(state.scan.ranges_m.iter().copied()));
        }
        lab.assert_observations_current("with noisy ranges");
    }
    pairs
}

fn with_noise(noise_std_m: f32, dropout: f32) -> Scenario {
    let mut scenario = Scenario::default();
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (noise_std_m.into(), dropout.into());
    scenario.task.max_episode_steps = 10_000;
    scenario
}

#[test]
fn a_lidar_without_noise_reports_the_true_ranges() {
    assert!(
        ranges(&with_noise(0.0, 0.0), 50, 1)
            .iter()
            .all(|(clean, reported)| clean.to_bits() == reported.to_bits())
    );
}

#[test]
fn noise_has_mean_0_and_the_scenarios_standard_deviation() {
    let pairs = ranges(&with_noise(0.05, 0.0), 300, 1);
    let n = pairs.len() as f64;
    let errors = || pairs.iter().map(|(clean, reported)| f64::from(reported - clean));
    let mean = errors().sum::<f64>() / n;
    let std = (errors().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt();
    // 115,200 draws: standard errors 0.15 mm and 0.1 mm.
    assert!(mean.abs() < 0.0007, "the mean error is {mean} m");
    assert!((std - 0.05).abs() < 0.0006, "the standard deviation is {std} m instead of 0.05 m");
    let within = errors().filter(|e| e.abs() < 0.05).count() as f64 / n;
    assert!(
        (within - 0.6827).abs() < 0.01,
        "a fraction of {within} is within one standard deviation, not 0.68"
    );
}

#[test]
fn the_fraction_of_lost_beams_is_the_dropout() {
    let pairs = ranges(&with_noise(0.0, 0.1), 300, 1);
    let lost = pairs.iter().filter(|(_, reported)| *reported == 3.5).count() as f64 / pairs.len() as f64;
    assert!((lost - 0.1).abs() < 0.005, "a fraction of {lost} reads the maximum range");
    assert!(
        pairs.iter().all(|(clean, reported)| reported == clean || *reported == 3.5),
        "the other beams read the true range"
    );
}

#[test]
fn noisy_ranges_are_clamped_to_0_and_the_maximum() {
    let pairs = ranges(&with_noise(3.0, 0.01), 50, 1);
    assert!(pairs.iter().all(|(_, reported)| (0.0..=3.5).contains(reported)));
    assert!(pairs.iter().any(|(_, reported)| *reported == 0.0), "some range is clamped to 0");
}

#[test]
fn noise_and_dropout_repeat_with_the_seed() {
    let reported =
        |seed| bits(&ranges(&with_noise(0.05, 0.1), 30, seed).iter().map(|pair| pair.1).collect::<Vec<_>>());
    assert_eq!(reported(5), reported(5), "the same seed gives the same noise");
    assert_ne!(reported(5), reported(6), "a different seed gives different noise");
}

#[test]
fn noise_causes_no_collision() {
    // With noise of 1 m, some beam reads less than the collision range in about a third of the scans, although
    // nothing is near.
    let mut scenario = with_noise(1.0, 0.0);
    scenario.task.max_episode_steps = 1_000_000;
    let mut lab = Lab::new(&scenario, 1, 1);
    lab.edit(0, |state| state.pose = Pose::default());
    let mut scans_below = 0;
    for _ in 0..100 {
        lab.step(&[0]);
        assert!(!lab.outcomes()[0].collided, "collisions depend on the true ranges");
        let scan = lab.state(0).scan;
        scans_below += usize::from(scan.ranges_m.iter().any(|&range| range < 0.13));
    }
    assert!(scans_below > 20, "only {scans_below} scans have a range below the collision range");
}
