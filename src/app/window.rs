//! The window: the app with Bevy's renderer and egui.
//!
//! In: [`WindowOptions`]. Out: an app that runs until the window is closed, or until the requested screenshot is written. The
//! screen is drawn once per frame from the snapshot; the user's input becomes commands.

use bevy::asset::AssetEventSystems;
use bevy::log::LogPlugin;
use bevy::prelude::*;
#[cfg(not(target_arch = "wasm32"))]
use bevy::window::PrimaryWindow;
use bevy::window::{ExitCondition, PresentMode, WindowCloseRequested, WindowResolution};
use bevy::winit::WinitSettings;
use bevy_egui::{EguiContexts, EguiPlugin, EguiPostUpdateSet, EguiPreUpdateSet, EguiPrimaryContextPass};

#[cfg(target_arch = "wasm32")]
use super::browser as file_dialogs;
use super::commands::Command;
#[cfg(not(target_arch = "wasm32"))]
use super::file_dialogs;
use super::preferences::{self, Preferences};
use super::screen::{self, ScreenInput, theme};
#[cfg(not(target_arch = "wasm32"))]
use super::screenshot::{ScreenshotRequest, exit_if_training_stops, take_screenshot};
use super::session::{StartOptions, TrainingHistory, TrainingRun};
#[cfg(not(target_arch = "wasm32"))]
use super::shutdown;
use super::view_state::{EditorSource, Overlays, ThemeChoice};
#[cfg(not(target_arch = "wasm32"))]
use super::window_failure;
use super::window_input::{draw_less_when_idle, fit_to_monitor, fix_input, take_dropped_files};
use super::{AppCorePlugin, CurrentViewState, Snapshot, blending};
use crate::run::RunError;

/// Options of the app's window.
#[derive(Clone, Debug, Default)]
pub struct WindowOptions {
    /// Options of the first training run.
    pub start: StartOptions,
    /// A screenshot to take, if any.
    #[cfg(not(target_arch = "wasm32"))]
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
/// There is no display or no graphics driver, a library is missing, the screenshot could not be written, or a signal or a failure
/// has ended the app.
#[cfg(not(target_arch = "wasm32"))]
pub fn run(options: WindowOptions) -> Result<(), RunError> {
    #[cfg(all(unix, not(target_os = "macos")))]
    shutdown::watch_display(window_failure::connect_to_display()?);
    let exit = window_failure::catch(|| app(options).run())?;
    shutdown::result(&exit)
}

/// Runs the app in the page.
///
/// # Errors
/// The app ended with an error.
#[cfg(target_arch = "wasm32")]
pub fn run(options: WindowOptions) -> Result<(), RunError> {
    let exit = app(options).run();
    match exit {
        AppExit::Success => Ok(()),
        AppExit::Error(_) => Err(RunError::Failed("the window closed unexpectedly".into())),
    }
}

/// Builds the app with its window. More systems may be added before it runs.
///
/// # Panics
/// There is no display. [`run`] checks this first.
pub fn app(options: WindowOptions) -> App {
    let mut app = App::new();
    app.add_plugins(WindowedPlugin(options));
    app
}

struct WindowedPlugin(WindowOptions);

impl Plugin for WindowedPlugin {
    fn build(&self, app: &mut App) {
        let options = &self.0;
        let preferences = initial_preferences(options);
        app.add_plugins(default_plugins(options.size.unwrap_or(preferences.size)))
            .add_plugins(EguiPlugin::default())
            // bevy_egui 0.42 does not set this order; without it a new glyph would appear one frame late.
            .configure_sets(PostUpdate, EguiPostUpdateSet::PostProcessOutput.before(AssetEventSystems))
            .insert_resource(CurrentViewState(preferences.view_state.clone()))
            .add_plugins(AppCorePlugin { start: options.start.clone() })
            .insert_resource(ClearColor(Color::BLACK))
            .insert_resource(WinitSettings::game())
            .init_resource::<file_dialogs::FileDialogs>()
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
        app.init_resource::<super::fallback_fonts::FallbackFonts>().add_systems(
            PostUpdate,
            super::fallback_fonts::add_fallback_fonts
                .after(EguiPostUpdateSet::EndPass)
                .before(EguiPostUpdateSet::ProcessOutput),
        );
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(request) = &options.screenshot {
            let has_window = any_with_component::<PrimaryWindow>;
            app.insert_resource(request.clone())
                .add_systems(Last, (exit_if_training_stops, take_screenshot.run_if(has_window)));
            return;
        }
        if options.size.is_none() {
            app.add_systems(Update, fit_to_monitor);
        }
        app.insert_resource(preferences).add_systems(Last, preferences::store);
        #[cfg(not(target_arch = "wasm32"))]
        app.add_plugins(shutdown::ShutdownPlugin);
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(file) = super::controls::ControlsFile::from_env() {
            app.insert_resource(file).add_systems(Last, super::controls::write_controls);
        }
        #[cfg(target_arch = "wasm32")]
        app.add_plugins(super::text_input::TextInputPlugin).add_systems(
            Last,
            (
                super::browser::report_to_page.run_if(resource_exists::<TrainingRun>),
                super::controls::keep_tree,
            ),
        );
    }
}

/// The stored preferences, overridden by `options`.
fn initial_preferences(options: &WindowOptions) -> Preferences {
    let mut preferences = preferences::load();
    // A screenshot must not depend on stored preferences.
    #[cfg(not(target_arch = "wasm32"))]
    if options.screenshot.is_some() {
        preferences = Preferences::default();
    }
    let view_state = &mut preferences.view_state;
    view_state.theme = options.theme.unwrap_or(view_state.theme);
    view_state.overlays = options.overlays.unwrap_or(view_state.overlays);
    view_state.grid = options.grid.unwrap_or(view_state.grid);
    view_state.open_editor = options.start.edit.then_some(EditorSource::RunningScenario);
    preferences
}

/// Bevy's plugins with a window of this size, in points.
fn default_plugins((width, height): (f32, f32)) -> impl PluginGroup {
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
        // The page decides which keys the browser handles, such as those for reloading and copying.
        prevent_default_event_handling: false,
        ..Default::default()
    };
    let plugins = DefaultPlugins.build();
    // The page installs its own panic hook.
    #[cfg(target_arch = "wasm32")]
    let plugins = plugins.disable::<bevy::app::PanicHandlerPlugin>();
    // `shutdown.rs` handles signals.
    #[cfg(not(target_arch = "wasm32"))]
    let plugins = plugins.disable::<bevy::app::TerminalCtrlCHandlerPlugin>();
    plugins
        .set(WindowPlugin {
            primary_window: Some(window),
            exit_condition: ExitCondition::OnPrimaryClosed,
            // Close requests go to [`screen::request_close`].
            close_when_requested: false,
            ..Default::default()
        })
        // Warnings of graphics drivers are of no use to the user.
        .set(LogPlugin { filter: "error".into(), ..Default::default() })
}

/// Draws the screen, and sends the user's commands.
fn draw(
    mut contexts: EguiContexts,
    snapshot: Res<Snapshot>,
    history: Res<TrainingHistory>,
    mut view_state: ResMut<CurrentViewState>,
    mut commands: MessageWriter<Command>,
    mut close_requests: MessageReader<WindowCloseRequested>,
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
    if close_requests.read().count() > 0 {
        screen::request_close(&mut view_state.0, &mut requested);
    }
    commands.write_batch(requested);
    Ok(())
}
