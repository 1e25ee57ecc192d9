//! The app without a window: its plugins under `MinimalPlugins`, a screen that is laid out but not displayed, and a manual
//! clock.
#![allow(dead_code, reason = "each program uses part of this module")]

use std::time::Duration;

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use wayfield::app::app_status::{AppStatus, Notice, Severity};
use wayfield::app::commands::{Command, EditorReply};
use wayfield::app::scene::Scene;
use wayfield::app::screen::{self, ScreenInput};
use wayfield::app::session::{
    Journal, Notices, OpenedFiles, ScenarioSource, StartOptions, TrainingHistory, TrainingRun,
};
use wayfield::app::view_state::ViewState;
use wayfield::app::{AppCorePlugin, CurrentViewState, Snapshot};

/// The app.
pub struct HeadlessApp {
    app: App,
    egui: egui::Context,
    frames: u32,
    replies: MessageCursor<EditorReply>,
}

impl HeadlessApp {
    /// The app before its first frame.
    pub fn new(start: StartOptions) -> Self {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins).add_plugins(AppCorePlugin { start });
        app.finish();
        app.cleanup();
        Self { app, egui: egui::Context::default(), frames: 0, replies: MessageCursor::default() }
    }

    /// Runs a frame that comes `after` the last one, and lays out the screen. The screen's commands are executed in the next
    /// frame.
    pub fn frame(&mut self, after: Duration) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(after));
        self.app.update();
        if self.frames == 0 {
            screen::theme::install(&self.egui);
        }
        self.frames += 1;
        self.draw();
    }

    /// Lays out the screen again. Returns the number of triangles.
    pub fn draw(&mut self) -> usize {
        let world = self.app.world_mut();
        let mut view_state = world.resource::<CurrentViewState>().0.clone();
        let mut requested = Vec::new();
        let mut triangles = 0;
        if let Some((scene, status)) = &world.resource::<Snapshot>().now {
            let view = ScreenInput { scene, status, history: &world.resource::<TrainingHistory>().0 };
            let size = egui::vec2(1280.0, 800.0);
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
                ..Default::default()
            };
            let output =
                self.egui.run_ui(input, |ui| screen::screen_ui(ui, &view, &mut view_state, &mut requested));
            for clipped in self.egui.tessellate(output.shapes, output.pixels_per_point) {
                if let egui::epaint::Primitive::Mesh(mesh) = clipped.primitive {
                    triangles += mesh.indices.len() / 3;
                }
            }
        }
        world.resource_mut::<CurrentViewState>().0 = view_state;
        for command in requested {
            self.command(command);
        }
        triangles
    }

    /// Sends a command, which the next frame executes.
    pub fn command(&mut self, command: Command) {
        self.app.world_mut().write_message(command);
    }

    /// Takes single steps until the training has taken `steps` control steps.
    pub fn step_to(&mut self, steps: u64) {
        while self.steps() < steps {
            self.command(Command::Step);
            self.frame(Duration::from_millis(1));
        }
    }

    /// Control steps of the training so far.
    pub fn steps(&self) -> u64 {
        self.app.world().get_resource::<Journal>().map_or(0, |journal| journal.steps)
    }

    /// The training run.
    pub fn run(&self) -> &TrainingRun {
        self.app.world().resource()
    }

    /// The journal of the training.
    pub fn journal(&self) -> &Journal {
        self.app.world().resource()
    }

    /// What the user has opened.
    pub fn opened_files(&self) -> &OpenedFiles {
        self.app.world().resource()
    }

    /// Whether the scenario differs from its file.
    pub fn scenario_modified(&self) -> bool {
        self.app.world().resource::<ScenarioSource>().is_modified(&self.run().config)
    }

    /// What the screen draws.
    pub fn shown(&self) -> &(Scene, AppStatus) {
        self.app.world().resource::<Snapshot>().now.as_ref().expect("a frame was run before")
    }

    /// The notices, oldest first.
    pub fn notices(&self) -> Vec<Notice> {
        self.app.world().resource::<Notices>().list()
    }

    /// Texts of the error notices, oldest first.
    pub fn error_notices(&self) -> Vec<String> {
        let errors = self.notices().into_iter().filter(|notice| notice.severity == Severity::Error);
        errors.map(|notice| notice.text).collect()
    }

    /// Replies to the editor since the last call. Call it at least every two frames: Bevy drops older messages.
    pub fn editor_replies(&mut self) -> Vec<EditorReply> {
        let messages = self.app.world().resource::<Messages<EditorReply>>();
        self.replies.read(messages).cloned().collect()
    }

    /// The view state.
    pub fn view_state(&mut self) -> &mut ViewState {
        &mut self.app.world_mut().resource_mut::<CurrentViewState>().into_inner().0
    }

    /// The Bevy world.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }
}
