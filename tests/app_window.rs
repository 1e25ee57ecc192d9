//! The real window: the binary runs on its own virtual display (Xvfb, with Mesa's software GPU), trains, and takes a
//! screenshot, which must show the expected colours. Also: error messages when no window can open.
#![cfg(all(feature = "gui", target_os = "linux"))]

#[path = "support/window_process.rs"]
mod window_process;

use std::path::Path;
use std::process::{Command, Output};

use image::RgbImage;
use window_process::{Controls, Display, command, requirements, text, wait_until, xdotool};

fn wayfield(display: Option<&str>, home: &Path, arguments: &[&str]) -> Output {
    command(display, home, arguments).output().expect("the binary starts")
}

fn screenshot(display: &Display, arguments: &[&str]) -> RgbImage {
    let home = tempfile::tempdir().expect("temporary folder");
    let file = home.path().join("screenshot.png");
    let all = [arguments, &["--screenshot", "screenshot.png", "--size", "1280x800"]].concat();
    let output = wayfield(Some(&display.name), home.path(), &all);
    let stderr = text(&output.stderr);
    assert!(output.status.success(), "{}: {stderr}", output.status);
    assert!(!stderr.contains("panicked"), "{stderr}");
    image::open(&file).expect("the screenshot was written").to_rgb8()
}

/// Number of pixels of about this colour in the part x0..x1 by y0..y1 (each 0 to 1) of `image`.
fn count(image: &RgbImage, (x0, y0, x1, y1): (f32, f32, f32, f32), colour: [u8; 3]) -> usize {
    let (w, h) = (image.width() as f32, image.height() as f32);
    let within = |x: u32, y: u32| {
        let (x, y) = (x as f32 / w, y as f32 / h);
        x >= x0 && x < x1 && y >= y0 && y < y1
    };
    image
        .enumerate_pixels()
        .filter(|(x, y, pixel)| {
            within(*x, *y) && pixel.0.iter().zip(colour).all(|(&a, b)| a.abs_diff(b) <= 6)
        })
        .count()
}

#[test]
fn the_window_shows_robot_goal_and_curves_during_training() {
    let Some(display) = Display::new() else { return };
    let image = screenshot(
        &display,
        &["--seed", "3", "--pace", "full", "--screenshot-after", "300", "--theme", "light"],
    );
    assert_eq!(image.dimensions(), (1280, 800));
    let (arena, plots) = ((0.20, 0.08, 0.72, 1.0), (0.73, 0.08, 1.0, 1.0));
    let (accent, good, solid) = ([0x00, 0x72, 0xb2], [0x00, 0x8a, 0x64], [0x8a, 0x94, 0x9e]);
    assert!(count(&image, arena, accent) > 200, "the robot is visible");
    assert!(count(&image, arena, good) > 100, "the goal is visible");
    assert!(count(&image, arena, solid) > 3_000, "four cylinders and the walls are visible");
    assert!(count(&image, plots, accent) > 200, "the curves are visible");
}

#[test]
fn the_grid_shows_all_arenas_in_the_dark_theme() {
    let Some(display) = Display::new() else { return };
    let image = screenshot(
        &display,
        &["--pace", "full", "--screenshot-after", "60", "--theme", "dark", "--show", "grid,path"],
    );
    let (accent, paper) = ([0x56, 0xb4, 0xe9], [0x0f, 0x13, 0x17]);
    let arena = (0.20, 0.08, 0.72, 1.0);
    assert!(count(&image, arena, accent) > 400, "sixteen robots are visible");
    assert!(count(&image, arena, paper) > 10_000, "the background is dark");
}

#[test]
fn a_name_in_japanese_is_shown_with_a_system_font() {
    if !requirements::japanese_font_is_installed() {
        return;
    }
    let Some(display) = Display::new() else { return };
    let home = tempfile::tempdir().expect("temporary folder");
    let image_of = |name: &str| {
        let file = home.path().join("named.ron");
        std::fs::write(&file, format!("(name: \"{name}\")")).expect("the file can be written");
        let file = file.to_str().expect("the path is UTF-8");
        // The editor is at rest, so that images differ in the name alone.
        screenshot(&display, &["--scenario", file, "--edit", "--screenshot-after", "0", "--theme", "light"])
    };
    let maze = image_of("迷路");
    // Not `assert_eq!`, which would print millions of numbers.
    assert!(maze == image_of("迷路"), "the image is reproducible");
    assert!(maze != image_of("路迷"), "missing glyphs would all look the same");
}

#[test]
fn at_every_scale_factor_the_controls_are_in_the_window() {
    // The smallest and the largest scale factor on a screen with enough space; the largest one on a screen without.
    for (scale, pixels, points) in [
        ("0.5", "1280x800", (1280.0, 800.0)),
        ("4", "3200x2000", (800.0, 500.0)),
        ("4", "1280x800", (320.0, 200.0)),
    ] {
        let Some(display) = Display::with_size(pixels) else { return };
        let home = tempfile::tempdir().expect("temporary folder");
        let controls = Controls(home.path().join("controls"));
        let mut app = command(Some(&display.name), home.path(), &[])
            .env("WINIT_X11_SCALE_FACTOR", scale)
            .env("WAYFIELD_CONTROLS", &controls.0)
            .spawn()
            .expect("the binary starts");
        for name in ["Pause", "Test", "Edit"] {
            let (x, y) = controls.centre(name);
            assert!(
                x > 0.0 && x < points.0 && y > 0.0 && y < points.1,
                "{name} at {x}, {y} of {points:?}, scale {scale}"
            );
        }
        let (x, y) = controls.centre("Pause");
        let factor: f64 = scale.parse().expect("a number");
        xdotool(&display, &format!("mousemove {} {}", (x * factor) as i64, (y * factor) as i64));
        xdotool(&display, "click 1");
        assert!(
            wait_until(20, || controls.rect("Run").is_some()),
            "a click hits what is shown, scale {scale}"
        );
        app.kill().and_then(|()| app.wait()).expect("it ends");
    }
}

#[test]
fn without_a_display_the_error_names_an_alternative() {
    let home = tempfile::tempdir().expect("temporary folder");
    for display in [None, Some(":54321")] {
        let output = wayfield(display, home.path(), &[]);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert_eq!(stderr.lines().count(), 1, "one line with the error and the help: {stderr}");
        assert!(stderr.contains("no display") && stderr.contains("wayfield --train"), "{stderr}");
    }
}

#[test]
fn unusable_options_are_reported_before_the_window_opens() {
    let home = tempfile::tempdir().expect("temporary folder");
    std::fs::write(home.path().join("broken.ron"), "(name: \"A\", radius: 1)")
        .expect("the file can be written");
    for (arguments, expected) in [
        (vec!["--scenario", "broken.ron"], "broken.ron:1:13"),
        (vec!["--preset", "fsat"], "did you mean `fast`?"),
        (vec!["--pace", "quick"], "give 0.01 to 100, or full"),
        (vec!["--size", "10x10"], "16x16"),
        (vec!["--size", "100x100"], "800x500"),
        (vec!["--theme", "red"], "light"),
        (vec!["--screenshot-after", "5"], "--screenshot"),
        (vec!["--screenshot", "a.jpg"], "a.jpg: screenshots are PNG files; help: give a file name"),
        (
            vec!["--screenshot", "nowhere/a.png"],
            "nowhere/a.png: can't be written: the folder nowhere does not",
        ),
        (vec!["--train", "--screenshot", "a.png"], "cannot be used with"),
    ] {
        let output = wayfield(None, home.path(), &arguments);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(expected), "{arguments:?}: {stderr}");
    }
}

#[test]
fn an_obstacle_dragged_in_the_editor_is_saved_to_its_file() {
    let Some(display) = Display::new() else { return };
    let home = tempfile::tempdir().expect("temporary folder");
    let file = home.path().join("mine.ron");
    let before = "// My own.\n(\n    name: \"Mine\",\n    obstacles: [\n        \
                  (shape: Circle(radius_m: 0.3), position_m: (0.0, 0.6)), // here\n        \
                  (shape: Circle(radius_m: 0.1), position_m: (0.6, -1.0)),\n    ],\n)\n";
    std::fs::write(&file, before).expect("the file can be written");
    let controls = Controls(home.path().join("controls"));
    let arguments = ["--scenario", "mine.ron", "--edit", "--theme", "light", "--size", "1280x800"];
    let mut app = command(Some(&display.name), home.path(), &arguments)
        .env("WAYFIELD_CONTROLS", &controls.0)
        .spawn()
        .expect("the binary starts");
    // Drags the first obstacle to the right, to the x of the second one.
    let ((from, y), (to, _)) = (controls.centre("Obstacle 1"), controls.centre("Obstacle 2"));
    xdotool(&display, &format!("mousemove {from} {y}"));
    xdotool(&display, "mousedown 1");
    for fraction in [0.2, 0.6, 1.0] {
        xdotool(&display, &format!("mousemove {} {y}", from + fraction * (to - from)));
    }
    xdotool(&display, "mouseup 1");
    let (x, y) = controls.centre("Save");
    xdotool(&display, &format!("mousemove {x} {y}"));
    xdotool(&display, "click 1");
    let written = || std::fs::read_to_string(&file).unwrap_or_default();
    wait_until(20, || written() != before);
    let _ = app.kill();
    let _ = app.wait();
    assert_eq!(written(), before.replace("(0.0, 0.6)", "(0.6, 0.6)"), "only one number has changed");
}

#[test]
fn a_stored_size_that_no_screen_has_is_made_to_fit() {
    let Some(display) = Display::new() else { return };
    let home = tempfile::tempdir().expect("temporary folder");
    let folder = home.path().join("wayfield");
    std::fs::create_dir(&folder).expect("the folder can be made");
    std::fs::write(folder.join("preferences.ron"), "(size: (5000.0, 4000.0))")
        .expect("the file can be written");
    let controls = Controls(home.path().join("controls"));
    let mut app = command(Some(&display.name), home.path(), &["--theme", "light"])
        .env("WAYFIELD_CONTROLS", &controls.0)
        .spawn()
        .expect("the binary starts");
    // The button at the right end of the toolbar.
    let fits = wait_until(60, || controls.rect("Help").is_some_and(|[x, _, width, _]| x + width <= 1280.0));
    let _ = app.kill();
    let _ = app.wait();
    assert!(fits, "the window is no wider than the screen: {:?}", std::fs::read_to_string(&controls.0));
}

#[test]
fn the_view_is_stored_in_the_preferences() {
    let Some(display) = Display::new() else { return };
    let home = tempfile::tempdir().expect("temporary folder");
    let arguments = ["--theme", "dark", "--show", "grid", "--size", "900x600"];
    let mut app = command(Some(&display.name), home.path(), &arguments).spawn().expect("the binary starts");
    let file = home.path().join("wayfield/preferences.ron");
    wait_until(60, || file.exists());
    let _ = app.kill();
    let _ = app.wait();
    let preferences = std::fs::read_to_string(&file).expect("written within a minute");
    assert!(preferences.contains("theme: Dark") && preferences.contains("grid: true"), "{preferences}");
    assert!(preferences.contains("size: (900.0, 600.0)"), "{preferences}");
}

/// Asserts that the app ended with status 2 and one error, which contains all `needles` and the alternative.
fn assert_no_window(output: &Output, needles: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    let error = stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
    for needle in needles.iter().chain(&["wayfield --train"]) {
        assert!(error.contains(needle), "`{needle}`: {stderr}");
    }
    assert!(!stderr.contains("panicked") && !stderr.contains("backtrace"), "{stderr}");
}

#[test]
fn without_a_graphics_driver_the_error_names_the_package() {
    let Some(display) = Display::new() else { return };
    let home = tempfile::tempdir().expect("temporary folder");
    let mut command = command(Some(&display.name), home.path(), &[]);
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "__EGL_VENDOR_LIBRARY_FILENAMES"] {
        command.env(variable, "/dev/null");
    }
    assert_no_window(
        &command.output().expect("the binary starts"),
        &["graphics driver", "mesa-vulkan-drivers"],
    );
}

#[test]
fn without_a_library_that_the_window_loads_the_error_names_its_package() {
    let Some(display) = Display::new() else { return };
    let tried = Command::new("unshare").args(["--mount", "--map-root-user", "true"]).output();
    if !tried.is_ok_and(|output| output.status.success()) {
        requirements::report_skip(
            "`unshare --mount` is not permitted; help: run as root, or allow user namespaces",
        );
        return;
    }
    let home = tempfile::tempdir().expect("temporary folder");
    let cache = Command::new("ldconfig").arg("-p").output().expect("ldconfig starts");
    for (library, package) in
        [("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"), ("libXcursor.so.1", "libxcursor1")]
    {
        let cache = text(&cache.stdout);
        let path = cache
            .lines()
            .filter(|line| line.trim().starts_with(library))
            .find_map(|line| line.split(" => ").nth(1));
        let path = path.expect("the library is installed, as the other tests need it");
        let script = format!("mount --bind /dev/null {path} && exec \"$0\"");
        let mut command = Command::new("unshare");
        command.args(["--mount", "--map-root-user", "sh", "-c", &script, env!("CARGO_BIN_EXE_wayfield")]);
        command.current_dir(home.path()).env("XDG_CONFIG_HOME", home.path()).env("DISPLAY", &display.name);
        assert_no_window(&command.output().expect("unshare starts"), &[package]);
    }
}

#[test]
fn wayland_without_x11_is_reported_as_such() {
    let home = tempfile::tempdir().expect("temporary folder");
    let output = command(None, home.path(), &[]).env("WAYLAND_DISPLAY", "wayland-0").output();
    assert_no_window(&output.expect("the binary starts"), &["no X11 display", "xwayland"]);
}
