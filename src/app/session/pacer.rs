//! The pacer: how many control steps a frame is given.
//!
//! In: the time since the last frame, what the user asked for, how long the frame has stepped already. Out: whether to
//! step once more. What is learnt depends on the number of steps alone, never on when they are taken.

use std::time::Duration;

use crate::app::commands::Pace;

/// So long may steps take of one frame: what is left of a 60th of a second is for drawing.
const STEP_BUDGET: Duration = Duration::from_millis(12);

/// Where drawing alone takes longer than a frame at 30 a second, steps may take as long as drawing, but not longer than
/// this: on a machine that draws slowly, little of its time would be left for learning else. (With the step that is under
/// way then, it stays below 50 ms.)
const MAX_STEP_BUDGET: Duration = Duration::from_millis(36);

/// A frame that took longer than this, in s, is not made up for: the window was hidden, or hung. (A software GPU may
/// need a fifth of a second for each.)
const MAX_FRAME_S: f64 = 0.25;

/// When to step.
#[derive(Clone, Debug)]
pub struct Pacer {
    /// Time stands still.
    pub paused: bool,
    /// How quickly it passes.
    pub pace: Pace,
    /// No step is taken while a picture is, though time does not stand still.
    pub on_hold: bool,
    /// One step was asked for.
    single: bool,
    /// Simulated time that has passed on the screen and was not stepped yet, in s.
    owed_s: f64,
    /// What one step is worth, in s.
    period_s: f64,
    /// So long may steps take of this frame.
    budget: Duration,
    /// So long they took of the last.
    spent: Duration,
}

impl Pacer {
    /// A pacer that begins at `pace`.
    #[must_use]
    pub fn new(pace: Pace, paused: bool) -> Self {
        Self {
            paused,
            pace,
            on_hold: false,
            single: false,
            owed_s: 0.0,
            period_s: 0.2,
            budget: STEP_BUDGET,
            spent: Duration::ZERO,
        }
    }

    /// One step, and then stand still.
    pub fn step_once(&mut self) {
        self.paused = true;
        self.single = true;
    }

    /// A frame begins, `real_s` after the last; a step is worth `period_s`.
    pub fn begin_frame(&mut self, real_s: f64, period_s: f64) {
        self.period_s = period_s;
        let drawing = Duration::from_secs_f64(real_s.clamp(0.0, 1.0)).saturating_sub(self.spent);
        self.budget =
            if drawing > Duration::from_millis(33) { drawing.min(MAX_STEP_BUDGET) } else { STEP_BUDGET };
        self.spent = Duration::ZERO;
        if let (false, Pace::Times(times)) = (self.paused, self.pace) {
            self.owed_s += real_s.clamp(0.0, MAX_FRAME_S) * f64::from(times.max(0.0));
        }
    }

    /// Whether to step once more in this frame, which has stepped for `spent` already.
    pub fn should_step(&mut self, spent: Duration) -> bool {
        self.spent = spent;
        if std::mem::take(&mut self.single) {
            self.owed_s = self.period_s;
            return true;
        }
        if self.paused || self.on_hold {
            return false;
        }
        match self.pace {
            Pace::Full => {
                self.owed_s = self.period_s;
                spent < self.budget
            }
            Pace::Times(_) if self.owed_s < self.period_s => false,
            Pace::Times(_) if spent >= self.budget => {
                // It doesn't go any quicker on this machine; what could not be stepped is let go.
                self.owed_s = self.owed_s.min(self.period_s);
                false
            }
            Pace::Times(_) => {
                self.owed_s -= self.period_s;
                true
            }
        }
    }

    /// Whether a frame that has worked for `spent` already may do more that is no step.
    pub fn has_budget(&mut self, spent: Duration) -> bool {
        self.spent = spent;
        spent < self.budget
    }

    /// So long the steps of the last frame took.
    #[must_use]
    pub fn spent(&self) -> Duration {
        self.spent
    }

    /// How far the picture is on its way from the state before the last step to the one after it, 0 to 1.
    #[must_use]
    pub fn interpolation(&self) -> f32 {
        (self.owed_s / self.period_s).clamp(0.0, 1.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps_in(pacer: &mut Pacer, real_s: f64) -> usize {
        pacer.begin_frame(real_s, 0.2);
        std::iter::from_fn(|| pacer.should_step(Duration::ZERO).then_some(())).count()
    }

    #[test]
    fn real_time_is_five_steps_a_second() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        let steps: usize = (0..600).map(|_| steps_in(&mut pacer, 1.0 / 60.0)).sum();
        assert!((49..=50).contains(&steps), "ten seconds at 60 frames a second were {steps} steps");
    }

    #[test]
    fn a_hundred_times_real_time_is_a_hundred_times_as_many() {
        let mut pacer = Pacer::new(Pace::Times(100.0), false);
        let steps: usize = (0..60).map(|_| steps_in(&mut pacer, 1.0 / 60.0)).sum();
        assert!((499..=500).contains(&steps), "{steps}");
    }

    #[test]
    fn a_frame_that_hung_is_not_made_up_for() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        assert_eq!(steps_in(&mut pacer, 3600.0), 1, "an hour counts as a quarter of a second");
    }

    #[test]
    fn steps_end_with_the_budget_and_leave_no_debt() {
        let mut pacer = Pacer::new(Pace::Times(100.0), false);
        pacer.begin_frame(0.016, 0.2);
        assert!(pacer.should_step(Duration::ZERO) && !pacer.should_step(STEP_BUDGET));
        let later = steps_in(&mut pacer, 0.0);
        assert_eq!(later, 1, "one step is owed at most");
        let mut full = Pacer::new(Pace::Full, false);
        full.begin_frame(0.016, 0.2);
        assert!(full.should_step(Duration::ZERO) && !full.should_step(STEP_BUDGET));
    }

    #[test]
    fn where_drawing_is_slow_learning_gets_its_share() {
        let mut pacer = Pacer::new(Pace::Full, false);
        let after = |milliseconds| Duration::from_millis(milliseconds);
        pacer.begin_frame(0.140, 0.2);
        assert!(
            pacer.should_step(after(35)) && !pacer.should_step(after(36)),
            "never longer, though drawing is"
        );
        pacer.begin_frame(0.071, 0.2);
        assert!(
            pacer.should_step(after(34)) && !pacer.should_step(after(35)),
            "of 71 ms 36 were steps: 35 of drawing"
        );
        pacer.begin_frame(0.055, 0.2);
        assert!(!pacer.should_step(after(12)), "of 55 ms 35 were steps: drawing is quick");
    }

    #[test]
    fn paused_means_paused_but_for_the_one_step_asked_for() {
        let mut pacer = Pacer::new(Pace::Full, true);
        assert_eq!(steps_in(&mut pacer, 1.0), 0);
        pacer.step_once();
        assert_eq!(steps_in(&mut pacer, 1.0), 1);
        assert!((pacer.interpolation() - 1.0).abs() < 1e-6, "and the picture shows it whole");
        assert_eq!(steps_in(&mut pacer, 1.0), 0);
    }

    #[test]
    fn the_picture_is_between_two_steps() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        steps_in(&mut pacer, 0.1);
        assert!((pacer.interpolation() - 0.5).abs() < 1e-6);
        steps_in(&mut pacer, 0.05);
        assert!((pacer.interpolation() - 0.75).abs() < 1e-6);
    }
}
