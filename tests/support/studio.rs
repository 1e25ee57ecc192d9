//! The studio without a window: its plugins under MinimalPlugins, its screen drawn to nowhere, its time by hand.
#![allow(dead_code)]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use wayfield::app::desk::Desk;
use wayfield::app::orders::Order;
use wayfield::app::scene::Scene;
use wayfield::app::screen::{self, View};
use wayfield::app::session::{Curves, First, Session};
use wayfield::app::status::{Status, Weight};
use wayfield::app::{OnDesk, Shown, StudioPlugin};

/// The studio.
pub struct Studio {
    app: App,
    egui: egui::Context,
    frames: u32,
}

impl Studio {
    /// The studio at its first frame.
    pub fn new(first: First) -> Self {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins).add_plugins(StudioPlugin { first });
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
        let mut desk = world.resource::<OnDesk>().0.clone();
        let mut asked = Vec::new();
        let mut triangles = 0;
        if let Some((scene, status)) = &world.resource::<Shown>().now {
            let view = View { scene, status, history: &world.resource::<Curves>().0 };
            let size = egui::vec2(1280.0, 800.0);
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
                ..Default::default()
            };
            let drawn = self.egui.run_ui(input, |ui| screen::show(ui, &view, &mut desk, &mut asked));
            for drawn in self.egui.tessellate(drawn.shapes, drawn.pixels_per_point) {
                if let egui::epaint::Primitive::Mesh(mesh) = drawn.primitive {
                    triangles += mesh.indices.len() / 3;
                }
            }
        }
        world.resource_mut::<OnDesk>().0 = desk;
        for order in asked {
            self.order(order);
        }
        triangles
    }

    /// Asks for something, which the next frame carries out.
    pub fn order(&mut self, order: Order) {
        self.app.world_mut().write_message(order);
    }

    /// Single steps, until the training has had so many.
    pub fn step_to(&mut self, steps: u64) {
        while self.steps() < steps {
            self.order(Order::Step);
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
    pub fn shown(&self) -> &(Scene, Status) {
        self.app.world().resource::<Shown>().now.as_ref().expect("a frame was drawn")
    }

    /// What was told of failures.
    pub fn complaints(&self) -> Vec<String> {
        let told = self.session().notices().into_iter();
        told.filter(|notice| notice.weight == Weight::Failed).map(|notice| notice.text).collect()
    }

    /// What the user looks at.
    pub fn desk(&mut self) -> &mut Desk {
        &mut self.app.world_mut().resource_mut::<OnDesk>().into_inner().0
    }

    /// The world.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }
}
