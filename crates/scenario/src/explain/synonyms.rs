//! The names that other libraries and papers use for fields of a preset.

/// Names in lower case, and the path of the field in a preset. A path may end with the value that is meant.
const SYNONYMS: [(&[&str], &str); 17] = [
    (&["lr", "learningrate", "step_size"], "learning.learning_rate"),
    (
        &[
            "gradient_clip",
            "gradient_clipping",
            "grad_clip",
            "clip_grad_norm",
            "clipnorm",
            "max_grad_norm",
            "clip",
        ],
        "learning.max_gradient_norm",
    ),
    (&["batch", "minibatch_size", "mini_batch_size", "batchsize"], "learning.batch_size"),
    (&["discount", "discount_factor"], "learning.gamma"),
    (&["l2", "decay", "l2_regularization"], "learning.weight_decay"),
    (&["double_q", "double_dqn", "ddqn"], "learning.double"),
    (&["multi_step", "n_steps", "nstep"], "learning.n_step"),
    (&["train_interval", "update_every", "update_freq", "update_frequency"], "learning.train_freq"),
    (
        &[
            "hidden",
            "hidden_size",
            "hidden_sizes",
            "hidden_layers",
            "hidden_units",
            "layers",
            "net_arch",
            "units",
        ],
        "learning.network.hidden",
    ),
    (&["dueling", "duelling"], "learning.network.dueling"),
    (
        &["buffer", "buffer_size", "capacity", "memory", "memory_size", "replay_size"],
        "learning.replay.capacity",
    ),
    (&["learning_starts", "start_steps", "warmup", "warmup_steps"], "learning.replay.learning_starts"),
    (&["per", "prioritized", "prioritised", "prioritized_replay"], "learning.replay.sampling"),
    (
        &["target_update_interval", "target_update_freq", "target_update_every", "target_network_update"],
        "learning.target_update: Hard(every: ...)",
    ),
    (&["tau", "polyak", "soft_update"], "learning.target_update: Soft(tau: ...)"),
    (&["eps", "epsilon", "epsilon_start", "epsilon_decay", "exploration_fraction"], "learning.exploration"),
    (&["n_envs", "num_envs", "envs", "environments", "n_env"], "arenas"),
];

/// The field that is meant by `word`, as its path from a struct with the fields `known`: `replay.capacity` for `buffer_size` in
/// `learning`. `None` if it is not in that struct.
pub(super) fn synonym(word: &str, known: &[&str]) -> Option<&'static str> {
    let word = word.to_lowercase();
    let (_, path) = SYNONYMS.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    let starts = std::iter::once(0).chain(path.match_indices('.').map(|(dot, _)| dot + 1));
    let mut rests = starts.map(|start| &path[start..]);
    rests.find(|rest| rest.split(['.', ':']).next().is_some_and(|first| known.contains(&first)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_of_a_synonym_starts_at_the_struct_it_is_written_in() {
        let learning =
            ["network", "learning_rate", "max_gradient_norm", "gradient_steps", "replay", "target_update"];
        for (word, path) in [
            ("lr", "learning_rate"),
            ("gradient_clip", "max_gradient_norm"),
            ("hidden", "network.hidden"),
            ("Buffer_Size", "replay.capacity"),
            ("tau", "target_update: Soft(tau: ...)"),
        ] {
            assert_eq!(synonym(word, &learning), Some(path), "{word}");
        }
        assert_eq!(synonym("lr", &["arenas", "learning"]), Some("learning.learning_rate"), "at the top");
        assert_eq!(synonym("buffer_size", &["capacity", "sampling"]), Some("capacity"), "in `replay`");
        assert_eq!(synonym("lr", &["walls", "obstacles"]), None, "in a scenario");
        assert_eq!(synonym("obstacels", &["obstacles"]), None);
    }
}
