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
        mirror: true,
        advantage_learning: 0.5,
        quantiles: 8,
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
fn fields_that_are_left_out_have_their_defaults() {
    let read =
        |text: &str| ron::from_str::<LearningConfig>(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!(read("()"), LearningConfig::default());
    assert_eq!(read("(network: (), replay: ())"), LearningConfig::default());
    let table_1 = "(replay: (sampling: Prioritized()), target_update: Hard(), exploration: PerEpisode(), optimizer: RmsProp())";
    assert_eq!(read(table_1), LearningConfig::default());
    let others = read("(loss: Huber(), optimizer: Adam(), network: (dueling: false))");
    let adam = Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 };
    assert_eq!((others.loss, others.optimizer), (Loss::Huber { delta: 1.0 }, adam));
    assert_eq!(others.network, NetworkConfig { dueling: false, ..NetworkConfig::default() });
}

#[test]
fn every_value_out_of_range_is_reported_with_its_field() {
    let changes: &[Change] = &[
        ("network.hidden", |c| c.network.hidden = vec![1; 9]),
        ("network.hidden[1]", |c| c.network.hidden = vec![64, 0]),
        ("gamma", |c| c.gamma = 1.01),
        ("gamma", |c| c.gamma = f32::NAN),
        ("n_step", |c| c.n_step = 0),
        ("n_step", |c| c.n_step = 101),
        ("advantage_learning", |c| c.advantage_learning = 1.0),
        ("quantiles", |c| c.quantiles = 0),
        ("quantiles", |c| c.quantiles = 201),
        ("loss", |c| c.quantiles = 8),
        ("reward_scale", |c| c.reward_scale = 0.0),
        ("reward_scale", |c| c.reward_scale = 1e21),
        ("loss.delta", |c| c.loss = Loss::Huber { delta: -1.0 }),
        ("optimizer.smoothing", |c| c.optimizer = Optimizer::RmsProp { smoothing: 1.0, epsilon: 1e-8 }),
        ("optimizer.epsilon", |c| c.optimizer = Optimizer::RmsProp { smoothing: 0.9, epsilon: 0.0 }),
        ("optimizer.beta1", |c| c.optimizer = Optimizer::Adam { beta1: 1.0, beta2: 0.999, epsilon: 1e-8 }),
        ("optimizer.beta2", |c| c.optimizer = Optimizer::Adam { beta1: 0.9, beta2: 2.0, epsilon: 1e-8 }),
        ("learning_rate", |c| c.learning_rate = Schedule::Constant(-1e-3)),
        ("learning_rate", |c| c.learning_rate = Schedule::Constant(11.0)),
        ("learning_rate.from", |c| {
            c.learning_rate = Schedule::Linear { from: -1e-3, to: 1e-4, env_steps: 1 };
        }),
        ("learning_rate.env_steps", |c| {
            c.learning_rate = Schedule::Linear { from: 1e-3, to: 1e-4, env_steps: 0 };
        }),
        ("learning_rate.to", |c| {
            c.learning_rate = Schedule::Cosine { from: 1e-3, to: f32::NAN, env_steps: 1 };
        }),
        ("learning_rate.to", |c| {
            c.learning_rate = Schedule::Exponential { from: 1e-3, to: 0.0, env_steps: 1 };
        }),
        ("learning_rate.env_steps", |c| {
            c.learning_rate = Schedule::Exponential { from: 1e-3, to: 1e-5, env_steps: 0 };
        }),
        ("learning_rate.factor", |c| {
            c.learning_rate = Schedule::Step { from: 1e-3, factor: 2.0, every_env_steps: 1 };
        }),
        ("learning_rate.every_env_steps", |c| {
            c.learning_rate = Schedule::Step { from: 1e-3, factor: 0.5, every_env_steps: 0 };
        }),
        ("max_gradient_norm", |c| c.max_gradient_norm = Some(0.0)),
        ("max_gradient_norm", |c| c.max_gradient_norm = Some(f32::INFINITY)),
        ("weight_decay", |c| c.weight_decay = -0.1),
        ("weight_decay", |c| c.weight_decay = 1.5),
        ("batch_size", |c| c.batch_size = 0),
        ("batch_size", |c| c.batch_size = 65_537),
        ("replay.capacity", |c| c.replay.capacity = 63),
        ("replay.capacity", |c| c.replay.capacity = usize::MAX),
        ("replay.sampling.alpha", |c| {
            c.replay.sampling = Sampling::Prioritized {
                alpha: 1.5,
                beta: Schedule::Constant(0.4),
                importance_weights: true,
                epsilon: 1e-3,
            };
        }),
        ("replay.sampling.beta", |c| {
            c.replay.sampling = Sampling::Prioritized {
                alpha: 0.6,
                beta: Schedule::Constant(1.5),
                importance_weights: true,
                epsilon: 1e-3,
            };
        }),
        ("replay.sampling.epsilon", |c| {
            c.replay.sampling = Sampling::Prioritized {
                alpha: 0.6,
                beta: Schedule::Constant(0.4),
                importance_weights: true,
                epsilon: 0.0,
            };
        }),
        ("train_freq", |c| c.train_freq = 0),
        ("gradient_steps", |c| c.gradient_steps = 0),
        ("gradient_steps", |c| c.gradient_steps = 10_001),
        ("target_update.every", |c| c.target_update = TargetUpdate::Hard { every: 0 }),
        ("target_update.tau", |c| c.target_update = TargetUpdate::Soft { tau: 0.0 }),
        ("exploration.decay", |c| {
            c.exploration = Exploration::PerEpisode { start: 1.0, decay: 0.0, end: 0.05 };
        }),
        ("exploration.start", |c| {
            c.exploration = Exploration::Linear { start: 2.0, end: 0.05, env_steps: 10 };
        }),
        ("exploration.end", |c| {
            c.exploration = Exploration::Linear { start: 1.0, end: -0.1, env_steps: 10 };
        }),
        ("exploration.env_steps", |c| {
            c.exploration = Exploration::Linear { start: 1.0, end: 0.05, env_steps: 0 };
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
fn a_config_without_the_options_of_later_versions_has_them_off() {
    let text = ron::to_string(&LearningConfig::default()).expect("a config is RON");
    let older = [
        ",quantiles:1",
        ",advantage_learning:0.0",
        ",mirror:false",
        "max_gradient_norm:None,",
        "weight_decay:0.0,",
        ",layer_norm:false,activation:Relu",
    ]
    .iter()
    .fold(text.clone(), |text, field| {
        assert!(text.contains(field), "{field} in {text}");
        text.replace(field, "")
    });
    assert_eq!(ron::from_str(&older), Ok(LearningConfig::default()), "{older}");
}

#[test]
fn schedules_follow_their_formulas_and_become_constant_at_their_end() {
    let (from, env_steps) = (1.0, 100);
    // 0.25^(1/2) = 0.5, 0.25^0.99 = 0.2534898. (1 + cos(pi / 4)) / 2 = 0.8535534, (1 + cos(0.99 pi)) / 2 = 0.0002467.
    let exponential = Schedule::Exponential { from, to: 0.25, env_steps };
    let cosine = Schedule::Cosine { from, to: 0.5, env_steps };
    let growing = Schedule::Exponential { from: 0.01, to: 1.0, env_steps };
    let step = Schedule::Step { from: 0.8, factor: 0.5, every_env_steps: 100 };
    for (schedule, values) in [
        (Schedule::Linear { from, to: 0.5, env_steps }, [1.0, 0.875, 0.75, 0.505, 0.5, 0.5]),
        (exponential, [1.0, std::f32::consts::FRAC_1_SQRT_2, 0.5, 0.253_489_8, 0.25, 0.25]),
        (cosine, [1.0, 0.926_776_7, 0.75, 0.500_123_4, 0.5, 0.5]),
        (growing, [0.01, 0.031_622_8, 0.1, 0.954_992_6, 1.0, 1.0]),
        (step, [0.8, 0.8, 0.8, 0.8, 0.4, 0.2]),
        (Schedule::Constant(0.3), [0.3; 6]),
    ] {
        for (n, value) in [0, 25, 50, 99, 100, 200].into_iter().zip(values) {
            let found = schedule.at(n);
            assert!((found - value).abs() < 1e-6, "{schedule:?} at {n}: {found}, not {value}");
        }
        assert!((0.0..=1.0).contains(&schedule.at(u64::MAX)), "{schedule:?} stays between 0 and 1");
    }
}
