//! A window as narrow as a phone: setup or plots below the arena, and a toolbar of two rows.

use egui_kittest::kittest::Queryable;

use super::{Window, assert_no_overlap, click, toolbar_control_rects, window_with_size};
use crate::screen_fixture::ScreenFixture;

fn narrow(width: f32) -> Window {
    window_with_size(ScreenFixture::default(), [width, 844.0])
}

/// Whether the setup panel is shown, and whether the plots are.
fn visible_panels(window: &Window) -> (bool, bool) {
    let shown = |label| window.query_by_label(label).is_some();
    (shown("Restart training"), shown("Learning"))
}

#[test]
fn either_the_setup_or_the_plots_are_below_the_arena() {
    let mut window = narrow(390.0);
    assert_eq!(visible_panels(&window), (false, true), "both are open, but only one fits");
    let arena = window.get_by_label("Arena 1").rect();
    assert!(arena.width() > 370.0 && arena.max.y < window.get_by_label("Learning").rect().min.y, "{arena}");
    for (button, expected) in [
        ("Setup panel", (true, false)),
        ("Setup panel", (false, false)),
        ("Plots panel", (false, true)),
        ("Setup panel", (true, false)),
        ("Plots panel", (false, true)),
        ("Plots panel", (false, false)),
    ] {
        assert_eq!(click(&mut window, button), []);
        assert_eq!(visible_panels(&window), expected, "{button}");
    }
}

#[test]
fn one_click_closes_the_plots_even_if_the_setup_is_open_too() {
    let mut window = narrow(390.0);
    click(&mut window, "Plots panel");
    assert_eq!(visible_panels(&window), (false, false));
}

#[test]
fn a_wider_window_shows_both_panels() {
    assert_eq!(visible_panels(&narrow(700.0)), (true, true));
}

#[test]
fn the_controls_of_both_toolbar_rows_do_not_overlap() {
    for (width, min_readouts, min_rects) in
        [(340.0, 0, 10), (360.0, 0, 11), (375.0, 0, 11), (390.0, 1, 12), (600.0, 3, 14), (699.0, 4, 15)]
    {
        let window = narrow(width);
        let mut rects = toolbar_control_rects(&window);
        let before = rects.len();
        for caption in ["success rate ", "env steps ", "episodes ", "real time ", "fps "] {
            rects.extend(window.query_all_by_label_contains(caption).map(|n| n.rect()));
        }
        assert!(
            rects.len() >= min_rects && rects.len() >= before + min_readouts,
            "{} at {width}",
            rects.len()
        );
        assert_no_overlap(&rects, width);
    }
}

#[test]
fn the_plots_header_fits_into_a_narrow_panel() {
    for plots_width in [240.0, 310.0] {
        let mut screen_fixture = ScreenFixture::default();
        screen_fixture.view_state.plots_width = Some(plots_width);
        let window = window_with_size(screen_fixture, [800.0, 844.0]);
        let header = ["Learning", "by env steps", "Export"].map(|label| window.get_by_label(label).rect());
        assert_no_overlap(&header, 800.0);
    }
}
