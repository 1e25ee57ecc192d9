//! The notes on rewards that teach nothing or the wrong thing.

use crate::scenario::{Note, NoteLevel, Scenario};
use crate::task::{RewardConfig, RewardKind, RewardLengths};

pub(super) fn check(
    reward: &RewardConfig,
    scenario: Option<&Scenario>,
    has_reward_terms: bool,
    notes: &mut Vec<Note>,
) {
    let RewardConfig { reached, collided, mu, sigma, l_r_m, .. } = *reward;
    let mut add = |level, field: &str, message: String| notes.push(Note::new(level, field, message));
    if collided > 0.0 {
        let message =
            format!("is {collided}: collisions are rewarded; help: give a negative number (the paper: -200)");
        add(NoteLevel::Warning, "reward.collided", message);
    }
    if reached < 0.0 {
        let message = format!(
            "is {reached}: reaching a goal is punished; help: give a positive number (the paper: 250)"
        );
        add(NoteLevel::Warning, "reward.reached", message);
    }
    let is_shaped = reward.kind == RewardKind::Optimized;
    let attracts = reached != 0.0 || (is_shaped && mu != 0.0);
    let repels = collided < 0.0 || (is_shaped && sigma > 0.0);
    if !attracts && !has_reward_terms {
        let lesson = if collided > 0.0 {
            "the robot learns to collide"
        } else if repels {
            "the robot only learns to avoid collisions"
        } else {
            "nothing will be learned"
        };
        let message = format!(
            "gives nothing for a goal, so {lesson}; help: give a positive `reached` (the paper: 250)"
        );
        add(NoteLevel::Warning, "reward", message);
    }
    if let Some(scenario) = scenario
        && is_shaped
        && sigma > 0.0
    {
        // In the potential's units, which are scaled for `RewardLengths::Robot`.
        let collision_m = reward.scale(scenario.robot_unit_m()) * scenario.sure_collision_m();
        if l_r_m <= collision_m {
            let message = format!(
                "is {l_r_m}, but below {collision_m:.2} m{} the robot collides at every heading, so obstacles repel only when it \
                 is too late; help: give a larger distance, such as {:.2}",
                if reward.lengths == RewardLengths::Robot { " (scaled to the paper's robot)" } else { "" },
                2.0 * collision_m
            );
            add(NoteLevel::Note, "reward.l_r_m", message);
        }
    }
}
