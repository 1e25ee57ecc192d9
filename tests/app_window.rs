//! The real window: the binary is started on a display of its own (Xvfb, with Mesa's software GPU), trains, and takes its
//! own picture, which must show what it ought to. And what it says where no window can be.
#![cfg(all(feature = "gui", target_os = "linux"))]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use image::RgbImage;

/// A display without a screen; it ends with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn new() -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts: its package is among those that the README has one install");
        let mut number = String::new();
        let from = server.stdout.take().expect("it was piped");
        BufReader::new(from).read_line(&mut number).expect("Xvfb says which display it is");
        assert!(!number.trim().is_empty(), "Xvfb found no display to be");
        Self { server, name: format!(":{}", number.trim()) }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn command(display: Option<&str>, home: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wayfield"));
    command.args(arguments).current_dir(home).env("XDG_CONFIG_HOME", home).env("XDG_RUNTIME_DIR", home);
    command.env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    if let Some(display) = display {
        command.env("DISPLAY", display);
    }
    command
}

fn wayfield(display: Option<&str>, home: &Path, arguments: &[&str]) -> Output {
    command(display, home, arguments).output().expect("the binary starts")
}

/// Waits until `done`, `seconds` at most; gives whether it is.
fn until(seconds: u64, done: impl Fn() -> bool) -> bool {
    let begun = std::time::Instant::now();
    while !done() && begun.elapsed().as_secs() < seconds {
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    done()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn picture(arguments: &[&str]) -> RgbImage {
    let display = Display::new();
    let home = tempfile::tempdir().expect("a folder");
    let file = home.path().join("picture.png");
    let all = [arguments, &["--screenshot", "picture.png", "--size", "1280x800"]].concat();
    let output = wayfield(Some(&display.name), home.path(), &all);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{}: {said}", output.status);
    assert!(!said.contains("panicked"), "{said}");
    image::open(&file).expect("it took its picture").to_rgb8()
}

/// How many pixels of the part x0..x1 by y0..y1 (0 to 1) of `picture` are of this colour, to within a little.
fn count(picture: &RgbImage, (x0, y0, x1, y1): (f32, f32, f32, f32), colour: [u8; 3]) -> usize {
    let (w, h) = (picture.width() as f32, picture.height() as f32);
    let within = |x: u32, y: u32| {
        let (x, y) = (x as f32 / w, y as f32 / h);
        x >= x0 && x < x1 && y >= y0 && y < y1
    };
    picture
        .enumerate_pixels()
        .filter(|(x, y, pixel)| {
            within(*x, *y) && pixel.0.iter().zip(colour).all(|(&a, b)| a.abs_diff(b) <= 6)
        })
        .count()
}

#[test]
fn the_window_opens_trains_and_shows_robot_target_and_curves() {
    let picture =
        picture(&["--seed", "3", "--pace", "full", "--screenshot-after", "300", "--theme", "light"]);
    assert_eq!(picture.dimensions(), (1280, 800));
    let (world, plots) = ((0.20, 0.08, 0.72, 1.0), (0.73, 0.08, 1.0, 1.0));
    let (accent, good, solid) = ([0x00, 0x72, 0xb2], [0x00, 0x8a, 0x64], [0x8a, 0x94, 0x9e]);
    assert!(count(&picture, world, accent) > 200, "the robot is there");
    assert!(count(&picture, world, good) > 100, "its goal is there");
    assert!(count(&picture, world, solid) > 3_000, "four cylinders and the walls are there");
    assert!(count(&picture, plots, accent) > 200, "the curves have begun");
}

#[test]
fn all_arenas_are_shown_side_by_side_in_the_dark_too() {
    let picture =
        picture(&["--pace", "full", "--screenshot-after", "60", "--theme", "dark", "--show", "grid,path"]);
    let (accent, paper) = ([0x56, 0xb4, 0xe9], [0x0f, 0x13, 0x17]);
    let world = (0.20, 0.08, 0.72, 1.0);
    assert!(count(&picture, world, accent) > 400, "sixteen robots are there");
    assert!(count(&picture, world, paper) > 10_000, "it is dark");
}

#[test]
fn without_a_display_the_error_names_the_way_out() {
    let home = tempfile::tempdir().expect("a folder");
    for display in [None, Some(":54321")] {
        let output = wayfield(display, home.path(), &[]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert_eq!(said.lines().count(), 2, "one line for the error, one for the help: {said}");
        assert!(said.contains("no display") && said.contains("wayfield --train"), "{said}");
    }
}

#[test]
fn what_cannot_be_used_is_said_before_a_window_opens() {
    let home = tempfile::tempdir().expect("a folder");
    std::fs::write(home.path().join("broken.ron"), "(name: \"A\", radius: 1)").expect("it is written");
    for (arguments, expected) in [
        (vec!["--scenario", "broken.ron"], "broken.ron:1:13"),
        (vec!["--preset", "fsat"], "did you mean `fast`?"),
        (vec!["--pace", "quick"], "give 0.01 to 100, or full"),
        (vec!["--size", "10x10"], "800x500"),
        (vec!["--theme", "red"], "light"),
        (vec!["--screenshot-after", "5"], "--screenshot"),
        (vec!["--train", "--screenshot", "a.png"], "cannot be used with"),
    ] {
        let output = wayfield(None, home.path(), &arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}

#[test]
fn a_picture_that_cannot_be_written_is_a_failure() {
    let display = Display::new();
    let home = tempfile::tempdir().expect("a folder");
    let output = wayfield(Some(&display.name), home.path(), &["--screenshot", "nowhere/picture.png"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("nowhere/picture.png"));
}

/// Does what a user's hand does: `xdotool`, which says where a mouse is and what it presses.
fn hand(display: &Display, deeds: &[&str]) {
    for deed in deeds {
        let done = Command::new("xdotool").args(deed.split(' ')).env("DISPLAY", &display.name).status();
        assert!(
            done.expect("xdotool starts: its package is among those that the README has one install")
                .success(),
            "{deed}"
        );
        // A software GPU draws some ten frames a second, and each should see it.
        std::thread::sleep(std::time::Duration::from_millis(400));
    }
}

#[test]
fn an_obstacle_dragged_in_the_editor_and_saved_is_found_in_the_file() {
    let display = Display::new();
    let home = tempfile::tempdir().expect("a folder");
    let file = home.path().join("mine.ron");
    let before = "// My own.\n(\n    name: \"Mine\",\n    obstacles: [\n        \
                  (shape: Circle(radius_m: 0.3), position_m: (0.0, 0.6)), // here\n    ],\n)\n";
    std::fs::write(&file, before).expect("it is written");
    let arguments = ["--scenario", "mine.ron", "--edit", "--theme", "light", "--size", "1280x800"];
    let mut app = command(Some(&display.name), home.path(), &arguments).spawn().expect("the binary starts");
    // It remembers what one looks at as soon as it is there, and after.
    assert!(until(20, || home.path().join("wayfield/preferences.ron").exists()), "the window is there");
    // The obstacle, 0.6 m above the middle of a world of 4 m; "Save" at the panel's foot.
    let (obstacle, save) = ((588, 335), (67, 775));
    let at = |(x, y): (i32, i32)| format!("mousemove {x} {y}");
    hand(&display, &[&at(obstacle), "mousedown 1"]);
    for x in [20, 60, 93] {
        hand(&display, &[&at((obstacle.0 + x, obstacle.1))]);
    }
    hand(&display, &["mouseup 1", &at(save), "click 1"]);
    let written = || std::fs::read_to_string(&file).unwrap_or_default();
    until(20, || written() != before);
    let _ = app.kill();
    let _ = app.wait();
    // 93 points of about 156 a metre, on the grid of 5 cm.
    assert_eq!(written(), before.replace("(0.0, 0.6)", "(0.6, 0.6)"), "one number is another");
}

#[test]
fn what_one_looked_at_is_remembered() {
    let display = Display::new();
    let home = tempfile::tempdir().expect("a folder");
    let arguments = ["--theme", "dark", "--show", "grid", "--size", "900x600"];
    let mut app = command(Some(&display.name), home.path(), &arguments).spawn().expect("the binary starts");
    let file = home.path().join("wayfield/preferences.ron");
    until(60, || file.exists());
    let _ = app.kill();
    let _ = app.wait();
    let remembered = std::fs::read_to_string(&file).expect("it was written within a minute");
    assert!(remembered.contains("theme: Dark") && remembered.contains("grid: true"), "{remembered}");
    assert!(remembered.contains("size: (900.0, 600.0)"), "{remembered}");
}
