//! The layout in windows of different widths: panels, toolbar, legends.

use egui_kittest::kittest::Queryable;

use super::{assert_no_overlap, release_event, settle, toolbar_control_rects, window, window_with_size};
use crate::screen_fixture::ScreenFixture;

#[test]
fn the_plots_panel_keeps_the_width_it_was_dragged_to() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.view_state.plots_width = Some(400.0);
    let mut window = window(screen_fixture);
    assert_eq!(window.state().view_state.plots_width, Some(400.0));
    let edge = egui::pos2(1280.0 - 400.0, 500.0);
    window.hover_at(edge);
    settle(&mut window);
    window.drag_at(edge);
    settle(&mut window);
    window.hover_at(edge - egui::vec2(60.0, 0.0));
    settle(&mut window);
    window.event(release_event(edge - egui::vec2(60.0, 0.0)));
    settle(&mut window);
    let width = window.state().view_state.plots_width.expect("the width is remembered");
    assert!((width - 460.0).abs() < 3.0, "{width}");
}

#[test]
fn a_legend_fits_on_one_line_in_any_window() {
    for width in [1100.0, 1280.0, 1600.0] {
        let mut window = window_with_size(ScreenFixture::default(), [width, 1400.0]);
        window.get_by_label("More").click();
        window.run_steps(12);
        for entries in [
            &["greedy", "in training", "paper 96%"][..],
            &["mean of 100", "paper 2,500"],
            &["reached", "collided", "attract", "repuls"],
        ] {
            let rects: Vec<_> = entries
                .iter()
                .map(|entry| {
                    let mut found = window.get_all_by_label_contains(entry);
                    found.next().unwrap_or_else(|| panic!("{entry} at {width}")).rect()
                })
                .collect();
            for rect in &rects {
                assert!(rect.height() < 16.0 && rect.max.x <= width, "{entries:?} at {width}: {rect}");
                assert!((rect.min.y - rects[0].min.y).abs() < 1.0, "{entries:?} at {width}: {rect}");
            }
        }
    }
}

#[test]
fn the_controls_of_the_toolbar_do_not_overlap() {
    for width in [1000.0, 1100.0, 1280.0, 1600.0, 2560.0] {
        let mut screen_fixture = ScreenFixture::default();
        (screen_fixture.status.env_steps, screen_fixture.status.env_steps_per_s) = (123_456_789, 98_765.0);
        let window = window_with_size(screen_fixture, [width, 720.0]);
        let mut rects = toolbar_control_rects(&window);
        assert!(rects.len() >= 11, "only {} controls at {width}", rects.len());
        for caption in ["success rate ", "env steps "] {
            let before = rects.len();
            rects.extend(window.query_all_by_label_contains(caption).map(|n| n.rect()));
            assert!(rects.len() > before, "{caption}is shown at {width}");
        }
        assert_no_overlap(&rects, width);
    }
}
