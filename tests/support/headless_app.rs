//! The headless_app without a window: its plugins under MinimalPlugins, its screen drawn to nowhere, its time by hand.
#![allow(dead_code)]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use wayfield::app::app_snapshot::{AppSnapshot, Severity};
use wayfield::app::commands::Command;
use wayfield::app::scene::Scene;
use wayfield::app::screen::{self, ScreenInput};
use wayfield::app::session::{Session, StartOptions, TrainingHistory};
use wayfield::app::view_state::ViewState;
use wayfield::app::{AppCorePlugin, CurrentViewState, Snapshot};

/// The headless_app.
pub struct HeadlessApp {
    app: App,
    egui: egui::Context,
    frames: u32,
}

impl HeadlessApp {
    /// The headless_app at its first frame.
    pub fn new(first: StartOptions) -> Self {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins).add_plugins(AppCorePlugin { first });
        app.finish();
        app.cleanup();
        Self { app, egui: egui::Context::default(), frames: 0 }
    }

    /// A frame that comes `after` the one before; the screen is drawn, and what it asks for is carried out in the next.
    pub fn frame(&mut self, after: Duration) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(after));
        self.app.update();
        if self.frames == 0 {
            screen::theme::install(&self.egui);
        }
        self.frames += 1;
        self.draw();
    }

    /// Draws the screen once more; gives the number of triangles.
    pub fn draw(&mut self) -> usize {
        let world = self.app.world_mut();
        let mut view_state = world.resource::<CurrentViewState>().0.clone();
        let mut asked = Vec::new();
        let mut triangles = 0;
        if let Some((scene, status)) = &world.resource::<Snapshot>().now {
            let view = ScreenInput { scene, status, history: &world.resource::<TrainingHistory>().0 };
            let size = egui::vec2(1280.0, 800.0);
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
                ..Default::default()
            };
            let drawn =
                self.egui.run_ui(input, |ui| screen::screen_ui(ui, &view, &mut view_state, &mut asked));
            for drawn in self.egui.tessellate(drawn.shapes, drawn.pixels_per_point) {
                if let egui::epaint::Primitive::Mesh(mesh) = drawn.primitive {
                    triangles += mesh.indices.len() / 3;
                }
            }
        }
        world.resource_mut::<CurrentViewState>().0 = view_state;
        for command in asked {
            self.command(command);
        }
        triangles
    }

    /// Asks for something, which the next frame carries out.
    pub fn command(&mut self, command: Command) {
        self.app.world_mut().write_message(command);
    }

    /// Single steps, until the training has had so many.
    pub fn step_to(&mut self, steps: u64) {
        while self.steps() < steps {
            self.command(Command::Step);
            self.frame(Duration::from_millis(1));
        }
    }

    /// Control steps of the training so far.
    pub fn steps(&self) -> u64 {
        self.app.world().get_resource::<Session>().map_or(0, |session| session.journal.steps)
    }

    /// What goes on.
    pub fn session(&self) -> &Session {
        self.app.world().resource::<Session>()
    }

    /// What the screen draws.
    pub fn shown(&self) -> &(Scene, AppSnapshot) {
        self.app.world().resource::<Snapshot>().now.as_ref().expect("a frame was drawn")
    }

    /// What was told of failures.
    pub fn error_notices(&self) -> Vec<String> {
        let told = self.session().notices().into_iter();
        told.filter(|notice| notice.severity == Severity::Error).map(|notice| notice.text).collect()
    }

    /// What the user looks at.
    pub fn view_state(&mut self) -> &mut ViewState {
        &mut self.app.world_mut().resource_mut::<CurrentViewState>().into_inner().0
    }

    /// The world.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }
}
