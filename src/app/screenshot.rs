//! Screenshots of the window.
//!
//! In: a [`ScreenshotRequest`]. Out: a PNG file, after which the app exits; it exits with an error if the training stops first.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use bevy::image::ImageFormat;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};

use super::fallback_fonts::FallbackFonts;
use super::session::{Journal, Notices, Pacer};
use crate::run::output_file::write_atomic;

/// Frames until the layout has settled, and glyphs and colours have reached the GPU.
const SETTLING_FRAMES: u32 = 8;

/// Maximum number of empty screenshots to discard: nothing is drawn until the shaders are compiled in the background.
const MAX_EMPTY: u32 = 1_000;

/// A screenshot of the window, after which the app exits.
#[derive(Resource, Clone, Debug, PartialEq, Eq)]
pub struct ScreenshotRequest {
    /// The PNG file.
    pub file: PathBuf,
    /// Number of control steps (of all arenas together, one each) that the training takes before the screenshot.
    pub after_steps: u64,
}

/// Takes the screenshot of the open window after the requested number of steps, and exits when it is written.
pub(super) fn take_screenshot(
    mut commands: Commands,
    request: Res<ScreenshotRequest>,
    journal: Option<Res<Journal>>,
    pacer: Option<ResMut<Pacer>>,
    fonts: Res<FallbackFonts>,
    under_way: Query<(), With<Screenshot>>,
    mut frames: Local<u32>,
) {
    let (Some(journal), Some(mut pacer)) = (journal, pacer) else { return };
    if !under_way.is_empty() || journal.steps < request.after_steps {
        return;
    }
    pacer.hold();
    if fonts.is_searching() {
        *frames = 0;
    }
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
                Ok(image) => write_encoded(&file, |bytes| {
                    let format = ImageFormat::Png.as_image_crate_format().ok_or("there is no PNG encoder")?;
                    image.write_to(bytes, format).map_err(|error| error.to_string())
                }),
                Err(error) => Err(error.to_string()),
            };
            exit.write(match written {
                Ok(()) => AppExit::Success,
                Err(error) => report_error(&file, &error),
            });
        },
    );
}

/// Exits with an error if the training stops before the requested number of steps.
pub(super) fn exit_if_training_stops(
    request: Res<ScreenshotRequest>,
    journal: Option<Res<Journal>>,
    notices: Res<Notices>,
    mut exit: MessageWriter<AppExit>,
) {
    let steps = journal.map_or(0, |journal| journal.steps);
    if let Some(failure) = notices.training_failure()
        && steps < request.after_steps
    {
        let why = format!("the training stopped after {steps} control steps: {failure}");
        exit.write(report_error(&request.file, &why));
    }
}

/// Prints why there is no screenshot in `file`.
fn report_error(file: &Path, why: &str) -> AppExit {
    crate::run::progress::print_stderr(&format!("error: {}: {why}", file.display()));
    AppExit::error()
}

/// Writes the output of `encode` to `file`.
fn write_encoded(
    file: &Path,
    encode: impl FnOnce(&mut Cursor<Vec<u8>>) -> Result<(), String>,
) -> Result<(), String> {
    let mut bytes = Cursor::new(Vec::new());
    encode(&mut bytes)?;
    write_atomic(file, |file| file.write_all(bytes.get_ref())).map_err(|error| error.to_string())
}
