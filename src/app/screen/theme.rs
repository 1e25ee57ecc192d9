//! The look: one typeface, one scale of type, one accent, for light and dark.
//!
//! In: whether it is dark. Out: colours by what they mean ([`Inks`]), and egui's style set up with them.

use egui::{Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Shadow, Stroke, TextStyle};

/// The typeface of the reports, too: Arial's widths, figures of equal width.
const FONT: &[u8] = include_bytes!("../../../assets/fonts/wayfield-sans.ttf");

/// The scale of type, in points: captions, text, headings.
pub const SMALL: f32 = 11.0;
/// Text.
pub const BODY: f32 = 13.0;
/// Headings.
pub const HEADING: f32 = 16.0;
/// The one figure that matters, where there is one.
pub const FIGURE: f32 = 22.0;

/// Space between things that belong together; groups are two or three of it apart.
pub const GAP: f32 = 6.0;

/// Colours by what they mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inks {
    /// Behind everything.
    pub paper: Color32,
    /// Panels.
    pub panel: Color32,
    /// What can be pressed.
    pub raised: Color32,
    /// The floor of an arena.
    pub floor: Color32,
    /// Its lines: fainter than the faintest beam.
    pub grid: Color32,
    /// Text and outlines.
    pub ink: Color32,
    /// Captions, axes: what is to be read second.
    pub soft: Color32,
    /// Hairlines.
    pub line: Color32,
    /// The one accent: what is active, the robot, the chosen action.
    pub accent: Color32,
    /// Text on the accent.
    pub on_accent: Color32,
    /// Walls and obstacles.
    pub solid: Color32,
    /// Success: the target, a reached trail.
    pub good: Color32,
    /// Failure: a collision.
    pub bad: Color32,
    /// Neither: out of time, an exploring action, a warning.
    pub warn: Color32,
    /// Fields over the plane, least and greatest: a hue that nothing else has.
    pub field: [Color32; 2],
}

impl Inks {
    /// For a light or a dark screen.
    #[must_use]
    pub const fn new(dark: bool) -> Self {
        let rgb = Color32::from_rgb;
        if dark {
            Self {
                paper: rgb(0x0f, 0x13, 0x17),
                panel: rgb(0x17, 0x1c, 0x21),
                raised: rgb(0x23, 0x2a, 0x32),
                floor: rgb(0x1b, 0x21, 0x27),
                grid: rgb(0x23, 0x2a, 0x31),
                ink: rgb(0xe2, 0xe7, 0xec),
                soft: rgb(0x98, 0xa4, 0xb0),
                line: rgb(0x2f, 0x37, 0x40),
                accent: rgb(0x56, 0xb4, 0xe9),
                on_accent: rgb(0x08, 0x1a, 0x26),
                solid: rgb(0x5b, 0x67, 0x73),
                good: rgb(0x2b, 0xc2, 0x93),
                bad: rgb(0xf0, 0x7a, 0x3c),
                warn: rgb(0xe6, 0xb4, 0x2e),
                field: [rgb(0x22, 0x21, 0x39), rgb(0xc4, 0x90, 0xd3)],
            }
        } else {
            Self {
                paper: rgb(0xec, 0xef, 0xf2),
                panel: rgb(0xf8, 0xf9, 0xfb),
                raised: rgb(0xff, 0xff, 0xff),
                floor: rgb(0xff, 0xff, 0xff),
                grid: rgb(0xf1, 0xf4, 0xf6),
                ink: rgb(0x1c, 0x21, 0x26),
                soft: rgb(0x5a, 0x63, 0x6d),
                line: rgb(0xd4, 0xda, 0xe0),
                accent: rgb(0x00, 0x72, 0xb2),
                on_accent: rgb(0xff, 0xff, 0xff),
                solid: rgb(0x8a, 0x94, 0x9e),
                good: rgb(0x00, 0x8a, 0x64),
                bad: rgb(0xc8, 0x4d, 0x00),
                warn: rgb(0xa8, 0x76, 0x00),
                field: [rgb(0xf6, 0xf6, 0xfc), rgb(0x96, 0x5a, 0xac)],
            }
        }
    }

    /// The accent as a wash over `under`: behind what is chosen.
    #[must_use]
    pub fn wash(&self, under: Color32) -> Color32 {
        under.lerp_to_gamma(self.accent, 0.16)
    }

    /// Those of the style that `ui` is drawn with.
    #[must_use]
    pub fn of(ui: &egui::Ui) -> Self {
        Self::new(ui.visuals().dark_mode)
    }
}

/// The project's own typeface for everything.
#[must_use]
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    fonts.font_data.insert("wayfield-sans".into(), FontData::from_static(FONT).into());
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec!["wayfield-sans".into()]);
    }
    fonts
}

/// Gives `ctx` the typeface, the scale and the colours.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    for (theme, dark) in [(egui::Theme::Light, false), (egui::Theme::Dark, true)] {
        ctx.style_mut_of(theme, |style| dress(style, Inks::new(dark)));
    }
}

fn dress(style: &mut egui::Style, inks: Inks) {
    for (name, size) in [
        (TextStyle::Small, SMALL),
        (TextStyle::Body, BODY),
        (TextStyle::Button, BODY),
        (TextStyle::Monospace, BODY),
        (TextStyle::Heading, HEADING),
    ] {
        style.text_styles.insert(name, FontId::proportional(size));
    }
    style.spacing.item_spacing = egui::vec2(GAP, GAP);
    style.spacing.button_padding = egui::vec2(9.0, 4.0);
    style.spacing.interact_size.y = 24.0;
    let v = &mut style.visuals;
    v.panel_fill = inks.panel;
    v.window_fill = inks.panel;
    v.extreme_bg_color = inks.floor;
    v.faint_bg_color = inks.paper;
    v.window_stroke = Stroke::new(1.0, inks.line);
    v.hyperlink_color = inks.accent;
    v.warn_fg_color = inks.warn;
    v.error_fg_color = inks.bad;
    v.selection.bg_fill = inks.accent;
    v.selection.stroke = Stroke::new(1.0, inks.on_accent);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    let radius = CornerRadius::same(5);
    let w = &mut v.widgets;
    for (widget, fill, deep, stroke) in [
        (&mut w.noninteractive, inks.panel, inks.line, inks.line),
        (&mut w.inactive, inks.raised, inks.line, inks.line),
        (&mut w.hovered, inks.raised, inks.line, inks.accent),
        (&mut w.active, inks.line, inks.line, inks.accent),
        (&mut w.open, inks.raised, inks.line, inks.accent),
    ] {
        // egui fills buttons with the weak one; the other is under sliders and ticks.
        (widget.weak_bg_fill, widget.bg_fill) = (fill, deep);
        widget.bg_stroke = Stroke::new(1.0, stroke);
        widget.fg_stroke = Stroke::new(1.0, inks.ink);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
    v.weak_text_color = Some(inks.soft);
    v.slider_trailing_fill = true;
    v.handle_shape = egui::style::HandleShape::Circle;
    for shadow in [&mut v.window_shadow, &mut v.popup_shadow] {
        *shadow = Shadow {
            offset: [0, 3],
            blur: 14,
            spread: 0,
            color: Color32::from_black_alpha(if v.dark_mode { 110 } else { 40 }),
        };
    }
    style.interaction.selectable_labels = false;
    style.spacing.combo_height = 320.0;
}
