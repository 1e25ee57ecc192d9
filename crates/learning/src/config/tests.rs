//! Range checks, schedules, RON.

use super::*;

/// The expected field of the error, and the change to the default config that causes it.
type Change = (&'static str, fn(&mut LearningConfig));

#[test]
fn a_config_is_read_from_ron_as_it_was_written() {
    let config = LearningConfig {
        loss: Loss::Huber { delta: 1.0 },
        optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
        learning_rate: Schedule::Linear { from: 5e-4, to: 1e-5, env_steps: 150_000 },
        exploration: Exploration::Linear { start: 1.0, end: 0.05, env_steps: 40_000 },
        target_update: TargetUpdate::Soft { tau: 0.005 },
        ..LearningConfig::default()
    };
    for config in [config, LearningConfig::default()] {
        assert_eq!(config.check(), Ok(()));
        let text = ron::to_string(&config).expect("a config is RON");
        let back: LearningConfig = ron::from_str(&text).expect("RON is a config");
        assert_eq!(back, config, "{text}");
    }
    let text = ron::to_string(&LearningConfig::default()).expect("a config is RON");
    let mistyped = text.replace("gamma", "gama");
    assert!(ron::from_str::<LearningConfig>(&mistyped).is_err(), "an unknown field is an error");
}

#[test]
fn every_value_out_of_range_is_reported_with_its_field() {
    let changes: &[Change] = &[
        ("network.hidden", |c| c.network.hidden = vec![1; 9]),
        ("network.hidden[1]", |c| c.network.hidden = vec![64, 0]),
        ("gamma", |c| c.gamma = 1.01),
        ("gamma", |c| c.gamma = f32::NAN),
        ("n_step", |c| c.n_step = 0),
        ("reward_scale", |c| c.reward_scale = 0.0),
        ("loss.delta", |c| c.loss = Loss::Huber { delta: -1.0 }),
        ("optimizer.smoothing", |c| c.optimizer = Optimizer::RmsProp { smoothing: 1.0, epsilon: 1e-8 }),
        ("optimizer.epsilon", |c| c.optimizer = Optimizer::RmsProp { smoothing: 0.9, epsilon: 0.0 }),
        ("optimizer.beta2", |c| c.optimizer = Optimizer::Adam { beta1: 0.9, beta2: 2.0, epsilon: 1e-8 }),
        ("learning_rate", |c| c.learning_rate = Schedule::Constant(-1e-3)),
        ("learning_rate.env_steps", |c| {
            c.learning_rate = Schedule::Linear { from: 1e-3, to: 1e-4, env_steps: 0 };
        }),
        ("batch_size", |c| c.batch_size = 0),
        ("replay.capacity", |c| c.replay.capacity = 63),
        ("replay.capacity", |c| c.replay.capacity = usize::MAX),
        ("replay.sampling.beta", |c| {
            c.replay.sampling = Sampling::Prioritized {
                alpha: 0.6,
                beta: Schedule::Constant(1.5),
                importance_weights: true,
                epsilon: 1e-3,
            };
        }),
        ("train_freq", |c| c.train_freq = 0),
        ("gradient_steps", |c| c.gradient_steps = 0),
        ("target_update.every", |c| c.target_update = TargetUpdate::Hard { every: 0 }),
        ("target_update.tau", |c| c.target_update = TargetUpdate::Soft { tau: 0.0 }),
        ("exploration.decay", |c| {
            c.exploration = Exploration::PerEpisode { start: 1.0, decay: 0.0, end: 0.05 };
        }),
        ("exploration.start", |c| {
            c.exploration = Exploration::Linear { start: 2.0, end: 0.05, env_steps: 10 };
        }),
    ];
    for (field, change) in changes {
        let mut config = LearningConfig::default();
        change(&mut config);
        let error = config.check().expect_err(field);
        assert_eq!(&error.field, field, "{error}");
        assert!(error.problem.contains("; help: "), "{error}");
    }
}

#[test]
fn a_linear_schedule_becomes_constant_at_its_end() {
    let schedule = Schedule::Linear { from: 1.0, to: 0.5, env_steps: 100 };
    for (step, value) in [(0, 1.0), (50, 0.75), (99, 0.505), (100, 0.5), (1_000_000, 0.5)] {
        assert!((schedule.at(step) - value).abs() < 1e-6, "at {step}: {}", schedule.at(step));
    }
}
