//! The pacer: how many control steps each frame may take.
//!
//! In: the time since the last frame, the requested pace, and the time spent on steps in this frame. Out: whether to take
//! another step. What is learned depends only on the number of steps, never on when they are taken.

use std::time::Duration;

use bevy::prelude::Resource;

use crate::app::commands::Pace;

/// Budget of a frame for steps. The rest of 1/60 s is for drawing.
const STEP_BUDGET: Duration = Duration::from_millis(12);

/// Maximum of the budget on slow machines. If drawing takes longer than 1/30 s, the budget is as long as the drawing, up to
/// this maximum; otherwise a slow machine would spend most of its time on drawing. Together with a step that has
/// already begun, this stays below 50 ms.
const MAX_STEP_BUDGET: Duration = Duration::from_millis(36);

/// Drawing that takes longer than this raises the budget.
const SLOW_DRAWING: Duration = Duration::from_millis(33);

/// A clock with a longer tick cannot time a frame: a browser that resists fingerprinting rounds to 100 ms. Control steps are
/// then counted, and timed over many frames.
const COARSE_TICK: Duration = Duration::from_millis(4);

/// Factor by which the sums of [`StepCost`] decay per frame.
const COST_DECAY: f64 = 0.99;

/// Maximum time between two frames, in s, that the simulation catches up with. A longer time means that the window was
/// hidden or the system hung. (A software GPU may need 0.2 s per frame.)
const MAX_FRAME_S: f64 = 0.25;

/// The state of simulated time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TimeState {
    /// Time passes at the pace.
    Running,
    /// Time is paused.
    Paused,
    /// Time is paused after one more step.
    SingleStep,
    /// Time appears to run, but no step is taken, because a screenshot is taken.
    OnHold,
}

/// The time that steps take, as exponentially decaying sums over frames.
#[derive(Clone, Copy, Debug, Default)]
struct StepCost {
    seconds: f64,
    steps: f64,
}

impl StepCost {
    fn add(&mut self, spent: Duration, steps: u32) {
        self.seconds = self.seconds * COST_DECAY + spent.as_secs_f64();
        self.steps = self.steps * COST_DECAY + f64::from(steps);
    }

    /// How many steps fit into `budget`, at least 1; `None` if no step has been timed yet.
    fn steps_within(self, budget: Duration) -> Option<u32> {
        let steps = budget.as_secs_f64() * self.steps / self.seconds;
        steps.is_finite().then_some(steps.max(1.0) as u32)
    }
}

/// Decides when to take control steps.
#[derive(Resource, Clone, Debug)]
pub struct Pacer {
    /// Requested pace while time runs.
    pub pace: Pace,
    time: TimeState,
    /// Simulated time in s for which no step has been taken yet.
    pending_s: f64,
    /// Duration of one control step, in s of simulated time.
    period_s: f64,
    /// Budget of this frame for steps.
    budget: Duration,
    /// Time spent on steps (in a browser, also on evaluation) in the last frame, or so far in this one.
    spent: Duration,
    /// Steps in this frame.
    steps: u32,
    cost: StepCost,
    /// The smallest tick of the clock seen so far.
    tick: Duration,
}

impl Pacer {
    /// A pacer that starts at `pace`.
    #[must_use]
    pub fn new(pace: Pace, paused: bool) -> Self {
        Self {
            pace,
            time: if paused { TimeState::Paused } else { TimeState::Running },
            pending_s: 0.0,
            period_s: 0.2,
            budget: STEP_BUDGET,
            spent: Duration::ZERO,
            steps: 0,
            cost: StepCost::default(),
            tick: Duration::MAX,
        }
    }

    /// Whether time is paused.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        matches!(self.time, TimeState::Paused | TimeState::SingleStep)
    }

    /// Pauses time, or lets it run.
    pub fn set_paused(&mut self, paused: bool) {
        self.time = match self.time {
            _ if paused => TimeState::Paused,
            TimeState::OnHold => TimeState::OnHold,
            _ => TimeState::Running,
        };
    }

    /// If time runs, stops taking steps; time still appears to run.
    pub fn hold(&mut self) {
        if self.time == TimeState::Running {
            self.time = TimeState::OnHold;
        }
    }

    /// Takes one step, then pauses.
    pub fn step_once(&mut self) {
        self.time = TimeState::SingleStep;
    }

    /// Begins a frame `real_s` seconds after the last one; a control step lasts `period_s`.
    pub fn begin_frame(&mut self, real_s: f64, period_s: f64) {
        self.period_s = period_s;
        self.cost.add(self.spent, self.steps);
        let drawing = Duration::from_secs_f64(real_s.clamp(0.0, 1.0)).saturating_sub(self.spent);
        let is_slow = drawing > SLOW_DRAWING && !self.is_clock_coarse();
        self.budget = if is_slow { drawing.min(MAX_STEP_BUDGET) } else { STEP_BUDGET };
        (self.spent, self.steps) = (Duration::ZERO, 0);
        if let (false, Pace::Times(times)) = (self.is_paused(), self.pace) {
            self.pending_s += real_s.clamp(0.0, MAX_FRAME_S) * f64::from(times.max(0.0));
        }
    }

    /// Whether to take another step in this frame, after `spent` on steps.
    pub fn should_step(&mut self, spent: Duration) -> bool {
        self.note_spent(spent);
        let should_step = match self.time {
            TimeState::SingleStep => {
                self.time = TimeState::Paused;
                self.pending_s = self.period_s;
                true
            }
            TimeState::Paused | TimeState::OnHold => false,
            TimeState::Running => self.should_step_at_pace(),
        };
        self.steps += u32::from(should_step);
        should_step
    }

    fn note_spent(&mut self, spent: Duration) {
        if spent > self.spent {
            self.tick = self.tick.min(spent - self.spent);
        }
        self.spent = spent;
    }

    fn is_clock_coarse(&self) -> bool {
        self.tick > COARSE_TICK && self.tick < Duration::MAX
    }

    fn is_budget_spent(&self) -> bool {
        match self.cost.steps_within(self.budget) {
            Some(steps) if self.is_clock_coarse() => self.steps >= steps || self.spent > self.tick,
            _ => self.spent >= self.budget,
        }
    }

    fn should_step_at_pace(&mut self) -> bool {
        match self.pace {
            Pace::Full => {
                self.pending_s = self.period_s;
                !self.is_budget_spent()
            }
            Pace::Times(_) if self.pending_s < self.period_s => false,
            Pace::Times(_) if self.is_budget_spent() => {
                // This machine is too slow for the pace: the remaining steps are dropped.
                self.pending_s = self.pending_s.min(self.period_s);
                false
            }
            Pace::Times(_) => {
                self.pending_s -= self.period_s;
                true
            }
        }
    }

    /// Whether any of this frame's budget is left after `spent`, for work other than steps.
    pub fn has_budget(&mut self, spent: Duration) -> bool {
        self.note_spent(spent);
        !self.is_budget_spent()
    }

    /// Time that the steps of the last frame took; in a browser, with its evaluation.
    #[must_use]
    pub fn spent(&self) -> Duration {
        self.spent
    }

    /// Interpolation parameter of the displayed state: from 0, before the last step, to 1, after it.
    #[must_use]
    pub fn interpolation(&self) -> f32 {
        (self.pending_s / self.period_s).clamp(0.0, 1.0) as f32
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
    fn real_time_is_five_steps_per_second() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        let steps: usize = (0..600).map(|_| steps_in(&mut pacer, 1.0 / 60.0)).sum();
        assert!((49..=50).contains(&steps), "{steps} steps in 10 s at 60 frames per second");
    }

    #[test]
    fn a_hundred_times_real_time_is_a_hundred_times_as_many_steps() {
        let mut pacer = Pacer::new(Pace::Times(100.0), false);
        let steps: usize = (0..60).map(|_| steps_in(&mut pacer, 1.0 / 60.0)).sum();
        assert!((499..=500).contains(&steps), "{steps}");
    }

    #[test]
    fn a_very_long_frame_is_not_caught_up_with() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        assert_eq!(steps_in(&mut pacer, 3600.0), 1, "an hour counts as 0.25 s");
    }

    #[test]
    fn steps_beyond_the_budget_are_dropped() {
        let mut pacer = Pacer::new(Pace::Times(100.0), false);
        pacer.begin_frame(0.016, 0.2);
        assert!(pacer.should_step(Duration::ZERO) && !pacer.should_step(STEP_BUDGET));
        let later = steps_in(&mut pacer, 0.0);
        assert_eq!(later, 1, "at most one step is pending");
        let mut full = Pacer::new(Pace::Full, false);
        full.begin_frame(0.016, 0.2);
        assert!(full.should_step(Duration::ZERO) && !full.should_step(STEP_BUDGET));
    }

    /// Frames and steps in 20 s at full pace, if a step takes 0.7 ms, drawing 5 ms, and the clock rounds down to `tick`.
    fn at_full_pace(tick: Duration) -> (usize, usize) {
        let (mut pacer, mut now, mut last_frame) =
            (Pacer::new(Pace::Full, false), Duration::ZERO, Duration::ZERO);
        let rounded = |now: Duration| tick * (now.as_micros() / tick.as_micros()) as u32;
        let (mut frames, mut steps) = (0, 0);
        while now < Duration::from_secs(20) {
            let began = rounded(now);
            pacer.begin_frame((began - last_frame).as_secs_f64(), 0.2);
            last_frame = began;
            while pacer.should_step(rounded(now) - began) {
                now += Duration::from_micros(700);
                steps += 1;
            }
            now += Duration::from_millis(5);
            frames += 1;
        }
        (frames, steps)
    }

    #[test]
    fn a_clock_that_rounds_to_100_ms_gives_as_many_frames_and_steps_as_a_fine_one() {
        let (fine, coarse) =
            (at_full_pace(Duration::from_micros(5)), at_full_pace(Duration::from_millis(100)));
        let ratio = |coarse: usize, fine: usize| coarse as f64 / fine as f64;
        assert!(ratio(coarse.0, fine.0) > 0.9, "frames: {coarse:?}, with a fine clock {fine:?}");
        assert!(ratio(coarse.1, fine.1) > 0.8, "steps: {coarse:?}, with a fine clock {fine:?}");
    }

    #[test]
    fn slow_drawing_raises_the_step_budget() {
        let mut pacer = Pacer::new(Pace::Full, false);
        let after = |milliseconds| Duration::from_millis(milliseconds);
        pacer.begin_frame(0.140, 0.2);
        assert!(
            pacer.should_step(after(35)) && !pacer.should_step(after(36)),
            "the budget has an upper limit"
        );
        pacer.begin_frame(0.071, 0.2);
        assert!(
            pacer.should_step(after(34)) && !pacer.should_step(after(35)),
            "71 ms minus 36 ms of steps leave 35 ms of drawing"
        );
        pacer.begin_frame(0.055, 0.2);
        assert!(!pacer.should_step(after(12)), "55 ms minus 35 ms of steps leave 20 ms: drawing is fast");
    }

    #[test]
    fn a_paused_pacer_takes_only_the_single_step_that_was_requested() {
        let mut pacer = Pacer::new(Pace::Full, true);
        assert_eq!(steps_in(&mut pacer, 1.0), 0);
        pacer.step_once();
        assert_eq!(steps_in(&mut pacer, 1.0), 1);
        assert!((pacer.interpolation() - 1.0).abs() < 1e-6, "the state after the step is displayed");
        assert_eq!(steps_in(&mut pacer, 1.0), 0);
    }

    #[test]
    fn the_displayed_state_is_interpolated_between_two_steps() {
        let mut pacer = Pacer::new(Pace::Times(1.0), false);
        steps_in(&mut pacer, 0.1);
        assert!((pacer.interpolation() - 0.5).abs() < 1e-6);
        steps_in(&mut pacer, 0.05);
        assert!((pacer.interpolation() - 0.75).abs() < 1e-6);
    }

    #[test]
    fn a_pacer_on_hold_takes_no_step_and_does_not_look_paused() {
        let mut pacer = Pacer::new(Pace::Full, false);
        pacer.hold();
        assert!(!pacer.is_paused() && !pacer.should_step(Duration::ZERO));
        pacer.set_paused(false);
        assert!(!pacer.should_step(Duration::ZERO));
    }
}
