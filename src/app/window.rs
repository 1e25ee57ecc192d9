//! The window: the app with Bevy's renderer and egui, and screenshots of it.
//!
//! In: [`WindowOptions`]. Out: an app that runs until the window is closed or, with a [`ScreenshotRequest`], until the
//! screenshot is written. The screen is drawn once per frame from the snapshot; the user's input becomes commands.

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
#[cfg(not(target_arch = "wasm32"))]
use super::session::Journal;
use super::session::{Evaluations, Pacer, StartOptions, TrainingHistory, TrainingRun};
use super::view_state::{EditorSource, Overlays, ThemeChoice};
use super::{AppCorePlugin, CurrentViewState, Snapshot, blending};
use crate::run::RunError;

/// A screenshot of the window, after which the app exits.
#[derive(Resource, Clone, Debug, PartialEq, Eq)]
pub struct ScreenshotRequest {
    /// The PNG file.
    pub file: PathBuf,
    /// Control steps of the training before the screenshot.
    pub after_steps: u64,
}

/// Options of the window.
#[derive(Clone, Debug, Default)]
pub struct WindowOptions {
    /// Options of the first training.
    pub start: StartOptions,
    /// A screenshot to take, if any.
    pub screenshot: Option<ScreenshotRequest>,
    /// Colour theme; `None` for the stored preference.
    pub theme: Option<ThemeChoice>,
    /// Overlays; `None` for the stored preference.
    pub overlays: Option<Overlays>,
    /// Whether to show all arenas as a grid; `None` for the stored preference.
    pub grid: Option<bool>,
    /// Size in points; `None` for the stored preference.
    pub size: Option<(f32, f32)>,
}

/// Opens the window and runs the app until it is closed.
///
/// # Errors
/// There is no display, or the screenshot could not be written.
pub fn run(options: WindowOptions) -> Result<(), RunError> {
    let _connection = connect_to_display()?;
    match app(options).run() {
        AppExit::Success => Ok(()),
        AppExit::Error(_) => Err(RunError::Failed("the window closed unexpectedly (see above)".into())),
    }
}

/// The app with its window, to which more systems may be added before it runs.
///
/// # Panics
/// There is no display. [`run`] checks this first.
pub fn app(options: WindowOptions) -> App {
    let mut app = App::new();
    app.add_plugins(WindowedPlugin(options));
    app
}

/// Connects to the X display: without one, winit would panic. Keep the connection until the window is open, because a
/// display such as Xvfb restarts when its last client disconnects, and is not available meanwhile.
///
/// # Errors
/// There is no display.
#[cfg(all(unix, not(target_os = "macos")))]
fn connect_to_display() -> Result<impl Sized, RunError> {
    x11rb::connect(None).map_err(|error| {
        RunError::InvalidInput(format!(
            "no display for the window ({error})\nhelp: train without a window with `wayfield --train`, or set DISPLAY"
        ))
    })
}

/// Other systems always have a display.
#[cfg(not(all(unix, not(target_os = "macos"))))]
fn connect_to_display() -> Result<impl Sized, RunError> {
    Ok(())
}

struct WindowedPlugin(WindowOptions);

impl Plugin for WindowedPlugin {
    fn build(&self, app: &mut App) {
        let options = &self.0;
        let mut preferences = preferences::load();
        // A screenshot must not depend on stored preferences.
        if options.screenshot.is_some() {
            preferences = Preferences::default();
        }
        let (width, height) = options.size.unwrap_or(preferences.size);
        let view_state = &mut preferences.view_state;
        view_state.theme = options.theme.unwrap_or(view_state.theme);
        view_state.overlays = options.overlays.unwrap_or(view_state.overlays);
        view_state.grid = options.grid.unwrap_or(view_state.grid);
        view_state.open_editor = options.start.edit.then_some(EditorSource::RunningScenario);
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
            // In a browser: the canvas of the page, as large as the page.
            canvas: Some("#canvas".into()),
            fit_canvas_to_parent: true,
            // The page decides which keys the browser handles, such as reloading and copying.
            prevent_default_event_handling: false,
            ..Default::default()
        };
        let defaults = DefaultPlugins.build();
        // The page installs its own panic hook.
        #[cfg(target_arch = "wasm32")]
        let defaults = defaults.disable::<bevy::app::PanicHandlerPlugin>();
        app.add_plugins(
            defaults
                .set(WindowPlugin {
                    primary_window: Some(window),
                    exit_condition: ExitCondition::OnPrimaryClosed,
                    ..Default::default()
                })
                // Warnings of graphics drivers are of no use to the user.
                .set(LogPlugin { filter: "error".into(), ..Default::default() }),
        )
        .add_plugins(EguiPlugin::default())
        // bevy_egui 0.42 does not set this order; without it a new glyph would appear one frame late.
        .configure_sets(PostUpdate, EguiPostUpdateSet::PostProcessOutput.before(AssetEventSystems))
        .insert_resource(CurrentViewState(preferences.view_state.clone()))
        .add_plugins(AppCorePlugin { start: options.start.clone() })
        .insert_resource(ClearColor(Color::BLACK))
        .insert_resource(WinitSettings::game())
        .add_systems(Startup, blending::spawn_camera)
        .add_systems(EguiPrimaryContextPass, draw)
        .add_systems(
            PreUpdate,
            (take_dropped_files, file_dialogs::run_file_dialogs.run_if(resource_exists::<TrainingRun>))
                .chain(),
        )
        .add_systems(
            PreUpdate,
            fix_input.after(EguiPreUpdateSet::ProcessInput).before(EguiPreUpdateSet::BeginPass),
        )
        .add_systems(Update, draw_less_when_idle);
        match &options.screenshot {
            #[cfg(not(target_arch = "wasm32"))]
            Some(request) => {
                app.insert_resource(request.clone()).add_systems(Last, take_screenshot);
            }
            _ => {
                app.insert_resource(preferences).add_systems(Last, preferences::store);
            }
        }
        app.init_resource::<file_dialogs::FileDialogs>();
        #[cfg(target_arch = "wasm32")]
        app.add_systems(Last, super::browser::report_to_page.run_if(resource_exists::<TrainingRun>));
    }
}

/// Draws the screen, and sends the user's commands.
fn draw(
    mut contexts: EguiContexts,
    snapshot: Res<Snapshot>,
    history: Res<TrainingHistory>,
    mut view_state: ResMut<CurrentViewState>,
    mut commands: MessageWriter<Command>,
    mut is_theme_installed: Local<bool>,
) -> Result {
    let context = contexts.ctx_mut()?;
    // The font is available from the next frame on.
    if !std::mem::replace(&mut *is_theme_installed, true) {
        theme::install(context);
        return Ok(());
    }
    let Some((scene, status)) = &snapshot.now else { return Ok(()) };
    let whole = egui::UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.content_rect());
    let mut ui = egui::Ui::new(context.clone(), "window".into(), whole);
    let mut requested = Vec::new();
    let view = ScreenInput { scene, status, history: &history.0 };
    screen::screen_ui(&mut ui, &view, &mut view_state.0, &mut requested);
    commands.write_batch(requested);
    Ok(())
}

/// Works around two gaps in bevy_egui 0.42. It does not pass on the system's theme. And it reports the modifier keys in every
/// frame: since egui requests another frame after every event, the app would never idle, so repeated reports are removed.
fn fix_input(
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

/// While time is paused and no evaluation runs, draws only on input, and once a second.
fn draw_less_when_idle(
    pacer: Option<Res<Pacer>>,
    evaluations: Option<Res<Evaluations>>,
    mut settings: ResMut<WinitSettings>,
) {
    let is_paused = pacer.is_some_and(|pacer| pacer.is_paused());
    let is_idle = is_paused && evaluations.is_some_and(|evaluations| !evaluations.is_running());
    let mode = if is_idle { UpdateMode::reactive(Duration::from_secs(1)) } else { UpdateMode::Continuous };
    if settings.focused_mode != mode {
        settings.focused_mode = mode;
        settings.unfocused_mode = mode;
    }
}

/// Opens files that are dropped on the window; scenarios in the editor, if it is open.
fn take_dropped_files(
    view_state: Res<CurrentViewState>,
    mut dropped: MessageReader<FileDragAndDrop>,
    mut commands: MessageWriter<Command>,
) {
    for event in dropped.read() {
        if let FileDragAndDrop::DroppedFile { path_buf: path, .. } = event {
            let is_scenario = path.extension().is_some_and(|extension| extension == "ron");
            commands.write(if is_scenario && view_state.0.editor.is_some() {
                Command::OpenInEditor(Some(path.clone()))
            } else {
                Command::Open(path.clone())
            });
        }
    }
}

/// Takes the screenshot after the requested number of steps, and exits when it is written.
#[cfg(not(target_arch = "wasm32"))]
fn take_screenshot(
    mut commands: Commands,
    request: Res<ScreenshotRequest>,
    journal: Option<Res<Journal>>,
    pacer: Option<ResMut<Pacer>>,
    windows: Query<Entity, With<PrimaryWindow>>,
    under_way: Query<(), With<Screenshot>>,
    mut frames: Local<u32>,
) {
    // Frames until the layout has settled, and glyphs and colours have reached the GPU.
    const SETTLING_FRAMES: u32 = 8;
    // Empty screenshots that are discarded: nothing is drawn until the shaders are compiled in the background.
    const MAX_EMPTY: u32 = 1_000;
    let (Some(journal), Some(mut pacer)) = (journal, pacer) else { return };
    if !under_way.is_empty() || journal.steps < request.after_steps || windows.is_empty() {
        return;
    }
    pacer.hold();
    *frames += 1;
    if *frames < SETTLING_FRAMES {
        return;
    }
    let (file, is_last) = (request.file.clone(), *frames >= SETTLING_FRAMES + MAX_EMPTY);
    commands.spawn(Screenshot::primary_window()).observe(
        move |captured: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
            let written = match captured.image.clone().try_into_dynamic().map(|image| image.to_rgb8()) {
                Ok(image) if image.pixels().all(|pixel| pixel == image.get_pixel(0, 0)) => {
                    if !is_last {
                        return;
                    }
                    Err("the window stayed empty".to_owned())
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
