//! The window: Bevy's renderer and egui around the studio, and pictures of it.
//!
//! In: what to begin with. Out: the app that runs until the window is closed; with [`ScreenshotRequest`], until it is taken. The
//! screen is drawn once a frame from the scene; what it asks for goes out as orders.

use std::path::PathBuf;
use std::time::Duration;

use bevy::asset::AssetEventSystems;
use bevy::log::LogPlugin;
use bevy::prelude::*;
#[cfg(not(target_arch = "wasm32"))]
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::{
    ExitCondition, FileDragAndDrop, PresentMode, PrimaryWindow, WindowResolution, WindowTheme,
};
use bevy::winit::{UpdateMode, WinitSettings};
use bevy_egui::{
    EguiContexts, EguiInput, EguiPlugin, EguiPostUpdateSet, EguiPreUpdateSet, EguiPrimaryContextPass,
};

#[cfg(target_arch = "wasm32")]
use super::browser as file_dialogs;
use super::commands::Command;
#[cfg(not(target_arch = "wasm32"))]
use super::file_dialogs;
use super::preferences::{self, Preferences};
use super::screen::{self, ScreenInput, theme};
use super::session::{Session, StartOptions, TrainingHistory};
use super::view_state::ThemeChoice;
use super::{AppCorePlugin, CurrentViewState, Snapshot, blending};
use crate::run::RunError;

/// A picture of the window, after which the app ends.
#[derive(Resource, Clone, Debug, PartialEq, Eq)]
pub struct ScreenshotRequest {
    /// The PNG file.
    pub file: PathBuf,
    /// It is taken after so many control steps of the training.
    pub after_steps: u64,
}

/// What the window is opened with.
#[derive(Clone, Debug, Default)]
pub struct WindowOptions {
    /// What to begin with.
    pub first: StartOptions,
    /// A picture to be taken, if any.
    pub screenshot: Option<ScreenshotRequest>,
    /// Light or dark, if not as remembered.
    pub theme: Option<ThemeChoice>,
    /// Drawn over the world, if not as remembered.
    pub overlays: Option<super::view_state::Overlays>,
    /// All arenas as a grid, if not as remembered.
    pub grid: Option<bool>,
    /// Its size in points, if not as remembered.
    pub size: Option<(f32, f32)>,
}

/// Opens the window and runs until it is closed.
///
/// # Errors
/// There is no display; the picture could not be written.
pub fn run(opening: WindowOptions) -> Result<(), RunError> {
    let _held = display()?;
    match app(opening).run() {
        AppExit::Success => Ok(()),
        AppExit::Error(_) => Err(RunError::Failed("the window ended unexpectedly (see above)".into())),
    }
}

/// The window's app, to which more may be added before it runs. It panics if there is no display ([`run`] asks first).
pub fn app(opening: WindowOptions) -> App {
    let mut app = App::new();
    app.add_plugins(WindowedPlugin(opening));
    app
}

/// A connection to the display on which a window can be opened: winit would panic without one. It is to be held until the
/// window is there, since a display such as Xvfb begins anew when its last client leaves, and is not to be had meanwhile.
#[cfg(all(unix, not(target_os = "macos")))]
fn display() -> Result<impl Sized, RunError> {
    x11rb::connect(None).map_err(|error| {
        RunError::InvalidInput(format!(
            "no display to open a window on ({error}): train without one by `wayfield --train`, or set DISPLAY"
        ))
    })
}

/// Other systems always have one.
#[cfg(not(all(unix, not(target_os = "macos"))))]
fn display() -> Result<impl Sized, RunError> {
    Ok(())
}

struct WindowedPlugin(WindowOptions);

impl Plugin for WindowedPlugin {
    fn build(&self, app: &mut App) {
        let opening = &self.0;
        let mut preferences = preferences::load();
        // A picture shows what was asked for, not what somebody happened to look at last.
        if opening.screenshot.is_some() {
            preferences = Preferences::default();
        }
        let (width, height) = opening.size.unwrap_or(preferences.size);
        let view_state = &mut preferences.view_state;
        view_state.theme = opening.theme.unwrap_or(view_state.theme);
        view_state.overlays = opening.overlays.unwrap_or(view_state.overlays);
        view_state.grid = opening.grid.unwrap_or(view_state.grid);
        view_state.open_editor = opening.first.edit;
        let window = Window {
            title: "wayfield".into(),
            name: Some("wayfield".into()),
            resolution: WindowResolution::new(width as u32, height as u32),
            present_mode: PresentMode::AutoVsync,
            #[cfg(not(target_arch = "wasm32"))]
            resize_constraints: bevy::window::WindowResizeConstraints {
                min_width: 800.0,
                min_height: 500.0,
                ..Default::default()
            },
            // In a browser: the page's canvas, as large as the page.
            canvas: Some("#canvas".into()),
            fit_canvas_to_parent: true,
            // (The page keeps from the browser what is the program's, and leaves it reloading, copying and the rest.)
            prevent_default_event_handling: false,
            ..Default::default()
        };
        let defaults = DefaultPlugins.build();
        // (The page has a panic hook of its own.)
        #[cfg(target_arch = "wasm32")]
        let defaults = defaults.disable::<bevy::app::PanicHandlerPlugin>();
        app.add_plugins(
            defaults
                .set(WindowPlugin {
                    primary_window: Some(window),
                    exit_condition: ExitCondition::OnPrimaryClosed,
                    ..Default::default()
                })
                // What a graphics driver has to say is of no use to who only wants to see a robot learn.
                .set(LogPlugin { filter: "error".into(), ..Default::default() }),
        )
        .add_plugins(EguiPlugin::default())
        // bevy_egui 0.42 leaves this open: a new glyph would then be seen a frame late.
        .configure_sets(PostUpdate, EguiPostUpdateSet::PostProcessOutput.before(AssetEventSystems))
        .insert_resource(CurrentViewState(preferences.view_state.clone()))
        .add_plugins(AppCorePlugin { first: opening.first.clone() })
        .insert_resource(ClearColor(Color::BLACK))
        .insert_resource(WinitSettings::game())
        .add_systems(Startup, blending::spawn_camera)
        .add_systems(EguiPrimaryContextPass, draw)
        .add_systems(
            PreUpdate,
            (take_dropped_files, file_dialogs::run_file_dialogs.run_if(resource_exists::<Session>)).chain(),
        )
        .add_systems(
            PreUpdate,
            mend_input.after(EguiPreUpdateSet::ProcessInput).before(EguiPreUpdateSet::BeginPass),
        )
        .add_systems(Update, rest_while_paused);
        match &opening.screenshot {
            #[cfg(not(target_arch = "wasm32"))]
            Some(picture) => {
                app.insert_resource(picture.clone()).add_systems(Last, take_picture);
            }
            _ => {
                app.insert_resource(preferences).add_systems(Last, preferences::keep);
            }
        }
        app.init_resource::<file_dialogs::FileDialogs>();
        #[cfg(target_arch = "wasm32")]
        app.add_systems(Last, super::browser::report_to_page);
    }
}

/// Draws the screen, and sends what it asks for.
fn draw(
    mut contexts: EguiContexts,
    shown: Res<Snapshot>,
    curves: Res<TrainingHistory>,
    mut view_state: ResMut<CurrentViewState>,
    mut commands: MessageWriter<Command>,
    mut dressed: Local<bool>,
) -> Result {
    let context = contexts.ctx_mut()?;
    // The typeface is there from the next frame on.
    if !std::mem::replace(&mut *dressed, true) {
        theme::install(context);
        return Ok(());
    }
    let Some((scene, status)) = &shown.now else { return Ok(()) };
    let place = egui::UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.content_rect());
    let mut ui = egui::Ui::new(context.clone(), "window".into(), place);
    let mut asked = Vec::new();
    let view = ScreenInput { scene, status, history: &curves.0 };
    screen::screen_ui(&mut ui, &view, &mut view_state.0, &mut asked);
    commands.write_batch(asked);
    Ok(())
}

/// What bevy_egui 0.42 leaves to do. It does not say whether the system is light or dark. And it tells egui in every frame
/// which modifier keys are held; egui asks for another frame after every event, so it would never rest: what is no news is
/// taken out.
fn mend_input(
    mut inputs: Query<&mut EguiInput>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut held: Local<egui::Modifiers>,
) {
    let theme = windows.single().ok().and_then(|window| window.window_theme).map(|theme| match theme {
        WindowTheme::Light => egui::Theme::Light,
        WindowTheme::Dark => egui::Theme::Dark,
    });
    for mut input in &mut inputs {
        input.system_theme = theme;
        input.events.retain(|event| match event {
            egui::Event::ModifiersChanged(now) => std::mem::replace(&mut *held, *now) != *now,
            _ => true,
        });
    }
}

/// While time stands still, the window is drawn when something happens to it, and once a second.
fn rest_while_paused(session: Option<Res<Session>>, mut settings: ResMut<WinitSettings>) {
    let is_idle = session.is_some_and(|session| session.is_idle());
    let mode = if is_idle { UpdateMode::reactive(Duration::from_secs(1)) } else { UpdateMode::Continuous };
    if settings.focused_mode != mode {
        settings.focused_mode = mode;
        settings.unfocused_mode = mode;
    }
}

/// A file that is dropped on the window is opened.
fn take_dropped_files(
    view_state: Res<CurrentViewState>,
    mut dropped: MessageReader<FileDragAndDrop>,
    mut commands: MessageWriter<Command>,
) {
    for event in dropped.read() {
        if let FileDragAndDrop::DroppedFile { path_buf: path, .. } = event {
            let edits =
                view_state.0.editor.is_some() && path.extension().is_some_and(|ending| ending == "ron");
            commands.write(if edits {
                Command::OpenInEditor(Some(path.clone()))
            } else {
                Command::Open(path.clone())
            });
        }
    }
}

/// Takes the picture when it is time, and ends the app when it is written.
#[cfg(not(target_arch = "wasm32"))]
fn take_picture(
    mut commands: Commands,
    picture: Res<ScreenshotRequest>,
    session: Option<ResMut<Session>>,
    windows: Query<Entity, With<PrimaryWindow>>,
    under_way: Query<(), With<Screenshot>>,
    mut frames: Local<u32>,
) {
    // Drawn often enough for the layout to have settled, and for glyphs and colours to have reached the GPU.
    const SETTLED: u32 = 8;
    // So many pictures of nothing are thrown away: shaders are made beside, and until they are there nothing is drawn.
    const MAX_EMPTY: u32 = 1_000;
    let Some(mut session) = session else { return };
    if !under_way.is_empty() || session.journal.steps < picture.after_steps || windows.is_empty() {
        return;
    }
    session.pacer.on_hold = true;
    *frames += 1;
    if *frames < SETTLED {
        return;
    }
    let (file, last) = (picture.file.clone(), *frames >= SETTLED + MAX_EMPTY);
    commands.spawn(Screenshot::primary_window()).observe(
        move |captured: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
            let written = match captured.image.clone().try_into_dynamic().map(|image| image.to_rgb8()) {
                Ok(image) if image.pixels().all(|pixel| pixel == image.get_pixel(0, 0)) => {
                    if !last {
                        return;
                    }
                    Err("nothing is drawn".to_owned())
                }
                Ok(image) => image.save(&file).map_err(|error| error.to_string()),
                Err(error) => Err(error.to_string()),
            };
            exit.write(match written {
                Ok(()) => AppExit::Success,
                Err(error) => {
                    crate::run::progress::print_stderr(&format!("error: {}: {error}", file.display()));
                    AppExit::error()
                }
            });
        },
    );
}
