//! A frame of the session: orders are carried out, then control steps are taken, and what each brought is noted.
//!
//! In: orders, the time since the last frame. Out: the world some steps on. An order never comes in the middle of a step.

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::time::Real;

use super::begin::examiner;
use super::trails::{Trails, poses};
use super::{Curves, Session};
use crate::agent::{Trainer, TrainingWarning};
use crate::app::orders::{Mode, Order};
use crate::app::status::Weight;
use crate::run::examiner::ON_THE_CALLERS_THREAD;
use crate::run::{RunError, follow, simulation};
use crate::task::{CurrentScenario, EpisodeEnded, Fault, Outcomes, TaskFault};

/// The words by which a warning of the training begins; with another training it is gone.
pub(super) const WARNING: &str = "This training";

/// One frame.
pub(super) fn advance(world: &mut World) {
    let orders: Vec<Order> = world.resource_mut::<Messages<Order>>().drain().collect();
    let time = world.resource::<Time<Real>>();
    let (real_s, now_s) = (time.delta_secs_f64(), time.elapsed_secs_f64());
    world.resource_scope(|world, mut session: Mut<Session>| {
        let session = &mut *session;
        for order in orders {
            session.carry_out(world, order);
        }
        #[cfg(not(target_arch = "wasm32"))]
        session.look_at_files(world);
        let period_s = f64::from(world.resource::<CurrentScenario>().0.task.control_period_s);
        session.pacer.begin_frame(real_s, period_s);
        let began = Instant::now();
        while session.may_step(world) && session.pacer.next(began.elapsed()) {
            if let Err(error) = session.step(world) {
                session.pacer.paused = true;
                session.tell(Weight::Failed, error.to_string());
                break;
            }
        }
        // Where the examiner works on this very thread, what is left of the frame's time is his.
        while ON_THE_CALLERS_THREAD && session.examining && session.pacer.has_time(began.elapsed()) {
            if let Err(error) = session.take_examinations(world, false) {
                session.replace_examiner(&error);
            }
        }
        session.forget_old_notices();
        session.speed.frame(now_s);
    });
}

impl Session {
    /// Whether a control step may be taken now: not while the examination of an earlier policy is waited for, nor after
    /// the learner has broken down.
    fn may_step(&mut self, world: &mut World) -> bool {
        if let Err(error) = self.take_examinations(world, false) {
            self.replace_examiner(&error);
        }
        self.mode != Mode::Train || !(self.broken || self.examining && self.examination_is_due(world))
    }

    /// The examiner is no more: another one takes his place, and this examination is let go.
    fn replace_examiner(&mut self, error: &RunError) {
        self.tell(Weight::Failed, error.to_string());
        self.examiner = SyncCell::new(examiner(&self.config, &self.scenario));
        self.examining = false;
    }

    fn examination_is_due(&self, world: &World) -> bool {
        world.resource::<Trainer>().0.env_steps() >= self.standing.next_evaluation
    }

    /// One control step.
    fn step(&mut self, world: &mut World) -> Result<(), RunError> {
        if self.mode == Mode::Train && self.examination_is_due(world) {
            self.standing.next_evaluation += self.config.preset.evaluation.every_env_steps;
            self.hand_in(world)?;
        }
        let before = poses(world);
        world.resource_mut::<Trails>().before(&before);
        let stepped = simulation::step(world);
        let after = poses(world);
        world.resource_scope(|world, mut trails: Mut<Trails>| {
            trails.after(&after, world.resource::<Outcomes>());
        });
        self.speed.stepped(after.len());
        if let Some(warning) = world.resource_mut::<TrainingWarning>().news() {
            self.tell(Weight::Failed, format!("{WARNING}: {warning}"));
        }
        let ended = !world.resource::<Messages<EpisodeEnded>>().is_empty();
        if self.mode == Mode::Train {
            self.journal.steps += 1;
            let wall_s = self.wall_s();
            for row in follow::ended_episodes(world, &mut self.standing, wall_s) {
                world.resource_mut::<Curves>().0.episode(&row);
            }
        } else {
            self.watch_rounds(world);
        }
        if ended {
            self.take_coming(world);
        }
        if stepped.is_err() {
            // A world without room may be mended by hand; numbers that are none cannot.
            let no_room = matches!(world.resource_mut::<TaskFault>().0.take(), Some(Fault::NoRoom { .. }));
            self.broken |= !no_room && self.mode == Mode::Train;
        }
        stepped
    }

    /// Hands the present policy to the examiner.
    fn hand_in(&mut self, world: &World) -> Result<(), RunError> {
        if std::mem::take(&mut self.examiner_is_stale) {
            self.examiner = SyncCell::new(examiner(&self.config, &self.scenario));
        }
        let candidate = follow::candidate(&self.config, world);
        self.standing.evaluated_at = Some(candidate.env_steps);
        self.examining = true;
        self.examiner.get().hand_in(candidate)
    }

    /// Notes the examination that is done, if one is; with `wait`, when it is.
    pub(super) fn take_examinations(&mut self, world: &mut World, wait: bool) -> Result<(), RunError> {
        while let Some(examination) = self.examiner.get().take(wait)? {
            self.examining = false;
            if self.examiner_is_stale {
                // Of another world.
                continue;
            }
            let wall_s = self.wall_s();
            let noted = follow::examined(&self.config, &mut self.standing, examination, wall_s)?;
            world.resource_mut::<Curves>().0.evaluation(&noted.row);
            self.evaluations.push(noted.row);
        }
        Ok(())
    }
}
