//! Pictures of the whole window, compared with those in `tests/snapshots`. No GPU: [`SoftPaint`] draws them.
//! After a change that is meant: `UPDATE_SNAPSHOTS=1 cargo test --test app_pictures`, and look at them.

#![cfg(feature = "window")]

#[path = "support/fake.rs"]
mod fake;
#[path = "support/soft_paint.rs"]
mod soft_paint;

use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, SnapshotOptions};
use fake::Fake;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use soft_paint::SoftPaint;
use wayfield::app::desk::Look;
use wayfield::app::orders::Mode;
use wayfield::app::scene::Driver;

fn window(size: [f32; 2], look: Look, mut fake: Fake) -> Harness<'static, Fake> {
    fake.desk.look = look;
    let build = Harness::builder().with_size(size).renderer(SoftPaint::default());
    let mut window = build.build_ui_state(|ui, fake: &mut Fake| fake.draw(ui), fake);
    window.run_steps(10);
    window
}

fn compare(name: &str, size: [f32; 2], look: Look, fake: Fake) {
    held_against(&mut window(size, look, fake), name);
}

/// A picture of the middle alone.
fn middle(mut fake: Fake) -> Fake {
    (fake.desk.setup_open, fake.desk.plots_open) = (false, false);
    fake
}

fn held_against(window: &mut Harness<'_, Fake>, name: &str) {
    // Sines may differ in their last bit from one machine to another, and so may the edges of round things.
    window.snapshot_options(name, &SnapshotOptions::new().threshold(0.6).max_failed_pixels(40));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        packed(&format!("tests/snapshots/{name}.png"));
    }
}

/// Writes the picture again, as small as it gets: what is flat packs best without filters.
fn packed(path: &str) {
    let picture = image::open(path).expect("the picture just written").into_rgb8();
    let file = std::io::BufWriter::new(std::fs::File::create(path).expect("its file"));
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    picture.write_with_encoder(encoder).expect("the picture again");
}

#[test]
fn the_first_sight() {
    compare("first_light", [1100.0, 720.0], Look::Light, Fake::fresh());
}

#[test]
fn a_world_of_all_sorts() {
    compare(
        "all_sorts_dark",
        [900.0, 720.0],
        Look::Dark,
        middle(Fake::default().in_world(fake::all_sorts())),
    );
}

#[test]
fn the_editor() {
    let mut window = window([1100.0, 720.0], Look::Light, Fake::default().in_world(fake::all_sorts()));
    window.key_press(egui::Key::E);
    window.run_steps(4);
    let editor = window.state_mut().desk.editor.as_mut().expect("it is open");
    editor.select(wayfield::app::editor::Selection::Obstacle(1));
    window.run_steps(10);
    held_against(&mut window, "editor_light");
}

#[test]
fn in_training_light() {
    compare("training_light", [1280.0, 800.0], Look::Light, Fake::default());
}

#[test]
fn in_training_narrow_dark() {
    compare("training_narrow_dark", [1100.0, 720.0], Look::Dark, Fake::default());
}

#[test]
fn all_arenas() {
    let mut fake = Fake::default();
    fake.desk.grid = true;
    compare("arenas_dark", [900.0, 640.0], Look::Dark, middle(fake));
}

#[test]
fn two_side_by_side_with_a_second_policy() {
    let mut fake = Fake::default();
    fake.scene.arenas = vec![fake.scene.arenas[0].clone(), fake.scene.arenas[6].clone()];
    (fake.scene.arenas[0].driver, fake.scene.arenas[1].driver) =
        (Driver::Policy("Present policy".into()), Driver::Policy("best.safetensors".into()));
    (fake.status.mode, fake.status.opened) = (Mode::Compare, Some("best.safetensors".into()));
    compare("compare_light", [1000.0, 600.0], Look::Light, middle(fake));
}

#[test]
fn a_policy_alone_with_its_value() {
    let mut fake = Fake::default().driven_alone();
    fake.desk.overlays.value = true;
    fake.scene.value = Some(fake::field(1, 1.0));
    fake.desk.setup_open = false;
    compare("test_dark", [1000.0, 600.0], Look::Dark, fake);
}

#[test]
fn asked_back_before_a_training_is_given_up() {
    let mut fake = Fake::default();
    fake.status.restart_discards = true;
    let mut window = window([1100.0, 720.0], Look::Dark, fake);
    window.get_by_label("World").click();
    window.run_steps(4);
    window.get_by_label("Scenario II").click();
    window.run_steps(4);
    window.get_by_label("Start again").click();
    window.run_steps(10);
    window.get_by_label("More").click();
    window.run_steps(20);
    window.remove_cursor();
    window.run_steps(4);
    held_against(&mut window, "asked_dark");
}

#[test]
fn overlays() {
    let mut fake = Fake::default();
    (fake.desk.overlays.potential, fake.desk.overlays.trails) = (true, true);
    fake.scene.potential = Some(fake::field(1, 100.0));
    compare("overlays_light", [760.0, 640.0], Look::Light, middle(fake));
}

#[test]
fn notices() {
    compare("notices_light", [900.0, 600.0], Look::Light, middle(Fake::default().with_notices()));
}

#[test]
fn help() {
    let mut fake = Fake::default();
    fake.desk.help_open = true;
    compare("help_dark", [900.0, 680.0], Look::Dark, middle(fake));
}

/// A translucent square of many triangles is one even tone: no seam, nothing painted twice; half a pixel is half.
#[test]
fn the_painter_neither_overlaps_nor_gapes() {
    let mut window =
        Harness::builder().with_size([100.0, 100.0]).renderer(SoftPaint::default()).build_ui(|ui| {
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
    let image = window.render().expect("a picture");
    let (inside, outside) = (*image.get_pixel(50, 50), *image.get_pixel(5, 5));
    assert_ne!(inside, outside);
    for (x, y, pixel) in image.enumerate_pixels() {
        let covered = (10..90).contains(&x) && (10..90).contains(&y);
        assert_eq!(*pixel, if covered { inside } else { outside }, "at {x}, {y}");
    }
}
