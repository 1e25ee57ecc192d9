//! The look: one typeface, one scale of type, one accent, for light and dark.
//!
//! In: whether it is dark. Out: colours by what they mean ([`Palette`]), and egui's style set up with them.

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
pub const DISPLAY: f32 = 22.0;

/// Space between things that belong together; groups are two or three of it apart.
pub const GAP: f32 = 6.0;

/// Colours by what they mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Behind everything.
    pub background: Color32,
    /// Panels.
    pub panel: Color32,
    /// What can be pressed.
    pub control: Color32,
    /// The floor of an arena.
    pub floor: Color32,
    /// Its lines: fainter than the faintest beam.
    pub grid: Color32,
    /// Text and outlines.
    pub text: Color32,
    /// Captions, axes: what is to be read second.
    pub weak_text: Color32,
    /// Hairlines.
    pub border: Color32,
    /// The one accent: what is active, the robot, the chosen action.
    pub accent: Color32,
    /// Text on the accent.
    pub on_accent: Color32,
    /// Walls and obstacles.
    pub obstacle: Color32,
    /// Success: the goal, a reached trail.
    pub success: Color32,
    /// Failure: a collision.
    pub error: Color32,
    /// Neither: out of time, an exploring action, a warning.
    pub warning: Color32,
    /// Fields over the plane, least and greatest: a hue that nothing else has.
    pub field_colors: [Color32; 2],
}

impl Palette {
    /// For a light or a dark screen.
    #[must_use]
    pub const fn new(dark: bool) -> Self {
        let rgb = Color32::from_rgb;
        if dark {
            Self {
                background: rgb(0x0f, 0x13, 0x17),
                panel: rgb(0x17, 0x1c, 0x21),
                control: rgb(0x23, 0x2a, 0x32),
                floor: rgb(0x1b, 0x21, 0x27),
                grid: rgb(0x23, 0x2a, 0x31),
                text: rgb(0xe2, 0xe7, 0xec),
                weak_text: rgb(0x98, 0xa4, 0xb0),
                border: rgb(0x2f, 0x37, 0x40),
                accent: rgb(0x56, 0xb4, 0xe9),
                on_accent: rgb(0x08, 0x1a, 0x26),
                obstacle: rgb(0x5b, 0x67, 0x73),
                success: rgb(0x2b, 0xc2, 0x93),
                error: rgb(0xf0, 0x7a, 0x3c),
                warning: rgb(0xe6, 0xb4, 0x2e),
                field_colors: [rgb(0x22, 0x21, 0x39), rgb(0xc4, 0x90, 0xd3)],
            }
        } else {
            Self {
                background: rgb(0xec, 0xef, 0xf2),
                panel: rgb(0xf8, 0xf9, 0xfb),
                control: rgb(0xff, 0xff, 0xff),
                floor: rgb(0xff, 0xff, 0xff),
                grid: rgb(0xf1, 0xf4, 0xf6),
                text: rgb(0x1c, 0x21, 0x26),
                weak_text: rgb(0x5a, 0x63, 0x6d),
                border: rgb(0xd4, 0xda, 0xe0),
                accent: rgb(0x00, 0x72, 0xb2),
                on_accent: rgb(0xff, 0xff, 0xff),
                obstacle: rgb(0x8a, 0x94, 0x9e),
                success: rgb(0x00, 0x8a, 0x64),
                error: rgb(0xc8, 0x4d, 0x00),
                warning: rgb(0xa8, 0x76, 0x00),
                field_colors: [rgb(0xf6, 0xf6, 0xfc), rgb(0x96, 0x5a, 0xac)],
            }
        }
    }

    /// The accent as a wash over `under`: behind what is chosen.
    #[must_use]
    pub fn selected_background(&self, under: Color32) -> Color32 {
        under.lerp_to_gamma(self.accent, 0.16)
    }

    /// Those of the style that `ui` is drawn with.
    #[must_use]
    pub fn from_ui(ui: &egui::Ui) -> Self {
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
        ctx.style_mut_of(theme, |style| apply_palette(style, Palette::new(dark)));
    }
}

fn apply_palette(style: &mut egui::Style, palette: Palette) {
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
    v.panel_fill = palette.panel;
    v.window_fill = palette.panel;
    v.extreme_bg_color = palette.floor;
    v.faint_bg_color = palette.background;
    v.window_stroke = Stroke::new(1.0, palette.border);
    v.hyperlink_color = palette.accent;
    v.warn_fg_color = palette.warning;
    v.error_fg_color = palette.error;
    v.selection.bg_fill = palette.accent;
    v.selection.stroke = Stroke::new(1.0, palette.on_accent);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    let radius = CornerRadius::same(5);
    let w = &mut v.widgets;
    for (widget, fill, deep, stroke) in [
        (&mut w.noninteractive, palette.panel, palette.border, palette.border),
        (&mut w.inactive, palette.control, palette.border, palette.border),
        (&mut w.hovered, palette.control, palette.border, palette.accent),
        (&mut w.active, palette.border, palette.border, palette.accent),
        (&mut w.open, palette.control, palette.border, palette.accent),
    ] {
        // egui fills buttons with the weak one; the other is under sliders and ticks.
        (widget.weak_bg_fill, widget.bg_fill) = (fill, deep);
        widget.bg_stroke = Stroke::new(1.0, stroke);
        widget.fg_stroke = Stroke::new(1.0, palette.text);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
    v.weak_text_color = Some(palette.weak_text);
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
