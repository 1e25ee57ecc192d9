//! A trace has the result of the evaluation's first episode, and its poses fit that result.

use std::sync::Arc;

use wayfield::learning::{NetworkConfig, Policy, QNetwork};
use wayfield::run::evaluate::Evaluator;
use wayfield::run::shipped;
use wayfield::task::{EpisodeEnd, EpisodeSetup};
use wayfield::{random, scenario::Scenario};

/// A policy with random weights.
fn policy(scenario: &Scenario, seed: u64) -> Policy {
    let config = NetworkConfig { hidden: vec![8], dueling: false, ..NetworkConfig::default() };
    let shape = config.shape(scenario.lidar.beams + 4, scenario.robot.motions.len());
    let network = QNetwork::new(shape.expect("a valid shape"), &mut random::stream(seed, "trace", 0));
    network.expect("a network").to_policy()
}

#[test]
fn a_trace_is_the_first_episode_of_the_evaluation() {
    for name in ["scenario-1", "scenario-2"] {
        let scenario = Arc::new(shipped::scenario(name).expect("shipped"));
        let route = scenario.benchmark_route.expect("a benchmark route");
        let mut evaluator = Evaluator::new(&scenario, 3);
        let mut alone = Evaluator::new(&scenario, 1);
        let mut ends = Vec::new();
        for seed in 0..12 {
            for setup in [EpisodeSetup::Random, EpisodeSetup::Route(route)] {
                let policy = policy(&scenario, seed);
                let episodes = evaluator.run(&policy, seed, 3, setup).expect("no error");
                let (episode, poses) = evaluator.trace(&policy, seed, setup).expect("no error");
                assert_eq!(episode, episodes[0]);
                assert_eq!(alone.trace(&policy, seed, setup), Ok((episode, poses.clone())));
                assert_eq!(
                    evaluator.run(&policy, seed, 3, setup),
                    Ok(episodes),
                    "a trace does not affect later evaluations"
                );
                assert_eq!(poses.len(), episode.steps as usize + 1);
                assert_eq!(poses[0], episode.start);
                // At most 0.15 m/s for 0.2 s, and rounding.
                for pair in poses.windows(2) {
                    let distance_m = libm::hypotf(pair[1].x_m - pair[0].x_m, pair[1].y_m - pair[0].y_m);
                    assert!(distance_m < 0.0301, "{distance_m} m in one step");
                }
                let reached = poses[poses.len() - 1].distance_m(&episode.goal) < 0.2;
                assert_eq!(reached, episode.end == EpisodeEnd::Reached);
                ends.push(episode.end);
            }
        }
        assert!(ends.contains(&EpisodeEnd::Collided), "{name}: {ends:?}");
    }
}
