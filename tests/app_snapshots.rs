//! Screenshots of the whole window, compared with those in `tests/snapshots`. [`SoftwareRenderer`] draws them without a GPU.
//! After an intended change: `cargo xtask snapshots`, then inspect the new files.

#![cfg(feature = "gui")]

#[path = "support/screen_fixture.rs"]
mod screen_fixture;
#[path = "support/software_renderer.rs"]
mod software_renderer;

use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, SnapshotOptions};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use screen_fixture::ScreenFixture;
use software_renderer::SoftwareRenderer;
use wayfield::app::commands::{PolicySource, SessionMode};
use wayfield::app::scene::DriverLabel;
use wayfield::app::view_state::ThemeChoice;

fn window(
    size: [f32; 2],
    theme: ThemeChoice,
    mut screen_fixture: ScreenFixture,
) -> Harness<'static, ScreenFixture> {
    screen_fixture.view_state.theme = theme;
    let build = Harness::builder().with_size(size).renderer(SoftwareRenderer::default());
    let mut window = build
        .build_ui_state(|ui, screen_fixture: &mut ScreenFixture| screen_fixture.draw(ui), screen_fixture);
    window.run_steps(10);
    window
}

fn compare(name: &str, size: [f32; 2], theme: ThemeChoice, screen_fixture: ScreenFixture) {
    assert_matches(&mut window(size, theme, screen_fixture), name);
}

/// Closes the side panels, so that only the middle is drawn.
fn without_panels(mut screen_fixture: ScreenFixture) -> ScreenFixture {
    (screen_fixture.view_state.setup_open, screen_fixture.view_state.plots_open) = (false, false);
    screen_fixture
}

fn assert_matches(window: &mut Harness<'_, ScreenFixture>, name: &str) {
    // Sines may differ in the last bit between machines, and so may the edges of circles.
    window.snapshot_options(name, &SnapshotOptions::new().threshold(0.6).max_failed_pixels(40));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        compress(&format!("tests/snapshots/{name}.png"));
    }
}

/// Compresses the file as well as possible. Flat colours compress best without filters.
fn compress(path: &str) {
    let image = image::open(path).expect("written just now").into_rgb8();
    let file = std::io::BufWriter::new(std::fs::File::create(path).expect("the file can be written"));
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    image.write_with_encoder(encoder).expect("the image can be written");
}

#[test]
fn before_the_first_step() {
    compare("first_light", [1100.0, 720.0], ThemeChoice::Light, ScreenFixture::untrained());
}

#[test]
fn every_kind_of_obstacle() {
    compare(
        "all_sorts_dark",
        [900.0, 720.0],
        ThemeChoice::Dark,
        without_panels(ScreenFixture::default().with_scenario(screen_fixture::mixed_scenario())),
    );
}

#[test]
fn editor() {
    let mut window = window(
        [1100.0, 720.0],
        ThemeChoice::Light,
        ScreenFixture::default().with_scenario(screen_fixture::mixed_scenario()),
    );
    window.key_press(egui::Key::E);
    window.run_steps(4);
    let editor = window.state_mut().view_state.editor.as_mut().expect("the editor is open");
    editor.select(wayfield::app::editor::Selection::Obstacle(1));
    window.run_steps(10);
    assert_matches(&mut window, "editor_light");
}

#[test]
fn training_light() {
    compare("training_light", [1280.0, 800.0], ThemeChoice::Light, ScreenFixture::default());
}

#[test]
fn training_narrow_dark() {
    compare("training_narrow_dark", [1100.0, 720.0], ThemeChoice::Dark, ScreenFixture::default());
}

#[test]
fn all_arenas() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.view_state.grid = true;
    compare("arenas_dark", [900.0, 640.0], ThemeChoice::Dark, without_panels(screen_fixture));
}

#[test]
fn two_policies_side_by_side() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.scene.arenas =
        vec![screen_fixture.scene.arenas[0].clone(), screen_fixture.scene.arenas[6].clone()];
    (screen_fixture.scene.arenas[0].driver, screen_fixture.scene.arenas[1].driver) = (
        policy("Current policy", "after 312,480 env steps"),
        policy("Scenario II expert", "Trained in Scenario II, new here"),
    );
    (screen_fixture.status.mode, screen_fixture.status.opened_policy) =
        (SessionMode::Compare, Some("Scenario II expert".into()));
    compare("compare_light", [1000.0, 600.0], ThemeChoice::Light, without_panels(screen_fixture));
}

fn policy(name: &str, origin: &str) -> DriverLabel {
    DriverLabel::Policy { name: name.into(), origin: origin.into() }
}

#[test]
fn one_policy_with_its_value_overlay() {
    let mut screen_fixture = ScreenFixture::default().with_single_policy();
    screen_fixture.view_state.overlays.value = true;
    screen_fixture.scene.value = Some(screen_fixture::field(1, 1.0));
    screen_fixture.view_state.plots_open = false;
    screen_fixture.status.tested = PolicySource::Best;
    screen_fixture.scene.arenas[0].driver = policy("Best so far", "94.6% after 311,040 env steps");
    compare("test_dark", [1000.0, 600.0], ThemeChoice::Dark, screen_fixture);
}

#[test]
fn confirmation_before_a_training_run_is_discarded() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.status.restart_loses_training = true;
    let mut window = window([1100.0, 720.0], ThemeChoice::Dark, screen_fixture);
    window.get_by_label("Scenario").click();
    window.run_steps(4);
    window.get_by_label("Scenario II").click();
    window.run_steps(4);
    window.get_by_label("Train from scratch in Scenario II").click();
    window.run_steps(10);
    window.get_by_label("More").click();
    window.run_steps(20);
    window.remove_cursor();
    window.run_steps(4);
    assert_matches(&mut window, "asked_dark");
}

#[test]
fn overlays() {
    let mut screen_fixture = ScreenFixture::default();
    (screen_fixture.view_state.overlays.potential, screen_fixture.view_state.overlays.trails) = (true, true);
    screen_fixture.scene.potential = Some(screen_fixture::field(1, 100.0));
    compare("overlays_light", [760.0, 640.0], ThemeChoice::Light, without_panels(screen_fixture));
}

#[test]
fn notices() {
    compare(
        "notices_light",
        [900.0, 600.0],
        ThemeChoice::Light,
        without_panels(ScreenFixture::default().with_notices()),
    );
}

#[test]
fn help() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.view_state.help_open = true;
    compare("help_dark", [900.0, 680.0], ThemeChoice::Dark, without_panels(screen_fixture));
}

/// A translucent polygon of many triangles has one uniform colour: no gaps, no pixel painted twice.
#[test]
fn the_software_renderer_leaves_no_gaps_and_no_overlaps() {
    let mut window =
        Harness::builder().with_size([100.0, 100.0]).renderer(SoftwareRenderer::default()).build_ui(|ui| {
            let mut mesh = egui::Mesh::default();
            let ink = egui::Color32::from_rgba_premultiplied(60, 0, 0, 128);
            let middle = egui::pos2(50.3, 49.8);
            mesh.colored_vertex(middle, ink);
            let corners =
                [(10.0, 10.0), (40.7, 10.0), (90.0, 10.0), (90.0, 77.1), (90.0, 90.0), (10.0, 90.0)];
            for (x, y) in corners {
                mesh.colored_vertex(egui::pos2(x, y), ink);
            }
            for k in 0..6 {
                mesh.add_triangle(0, 1 + k, 1 + (k + 1) % 6);
            }
            ui.ctx().debug_painter().add(mesh);
        });
    window.run();
    let image = window.render().expect("the window is drawn");
    let (inside, outside) = (*image.get_pixel(50, 50), *image.get_pixel(5, 5));
    assert_ne!(inside, outside);
    for (x, y, pixel) in image.enumerate_pixels() {
        let covered = (10..90).contains(&x) && (10..90).contains(&y);
        assert_eq!(*pixel, if covered { inside } else { outside }, "at {x}, {y}");
    }
}
