//! The theme: one typeface, one set of font sizes, and a light and a dark palette.
//!
//! In: light or dark. Out: colours named by their role ([`Palette`]), and egui's style set up with them.

use egui::{Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Shadow, Stroke, TextStyle};

/// The typeface, shared with the reports: metrics of Arial, digits of equal width.
const FONT: &[u8] = include_bytes!("../../../assets/fonts/wayfield-sans.ttf");

/// Font size of captions, in points.
pub const SMALL: f32 = 11.0;
/// Font size of body text, in points.
pub const BODY: f32 = 13.0;
/// Font size of headings, in points.
pub const HEADING: f32 = 16.0;
/// Font size of the success rate in the toolbar, in points.
pub const DISPLAY: f32 = 22.0;

/// Space between related elements, in points; groups are two or three times as far apart.
pub const GAP: f32 = 6.0;

/// Colours named by their role.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Behind everything.
    pub background: Color32,
    /// Background of panels.
    pub panel: Color32,
    /// Background of buttons and fields.
    pub control: Color32,
    /// The floor of an arena.
    pub floor: Color32,
    /// Grid lines of the floor, fainter than the faintest beam.
    pub grid: Color32,
    /// Text and outlines.
    pub text: Color32,
    /// Captions, axes and other secondary text.
    pub weak_text: Color32,
    /// Borders and separators.
    pub border: Color32,
    /// The accent: the active control, the robot, the chosen action.
    pub accent: Color32,
    /// Text on the accent colour.
    pub on_accent: Color32,
    /// Walls and obstacles.
    pub obstacle: Color32,
    /// Success: the goal, a path that reached it.
    pub success: Color32,
    /// Failure: a collision, an error.
    pub error: Color32,
    /// Warning: a timeout, a random action, a question.
    pub warning: Color32,
    /// Field overlays, at low and high values: violet, which nothing else in the arena uses.
    pub field_colors: [Color32; 2],
}

impl Palette {
    /// The palette of the light or the dark theme.
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

    /// Background of a selected element: `under` with a tint of the accent.
    #[must_use]
    pub fn selected_background(&self, under: Color32) -> Color32 {
        under.lerp_to_gamma(self.accent, 0.16)
    }

    /// The palette of the theme that `ui` is drawn with.
    #[must_use]
    pub fn from_ui(ui: &egui::Ui) -> Self {
        Self::new(ui.visuals().dark_mode)
    }
}

/// The project's own typeface, for all font families.
#[must_use]
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    fonts.font_data.insert("wayfield-sans".into(), FontData::from_static(FONT).into());
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec!["wayfield-sans".into()]);
    }
    fonts
}

/// Installs typeface, font sizes and colours in `ctx`.
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
    for (widget, fill, track, stroke) in [
        (&mut w.noninteractive, palette.panel, palette.border, palette.border),
        (&mut w.inactive, palette.control, palette.border, palette.border),
        (&mut w.hovered, palette.control, palette.border, palette.accent),
        (&mut w.active, palette.border, palette.border, palette.accent),
        (&mut w.open, palette.control, palette.border, palette.accent),
    ] {
        // egui fills buttons with `weak_bg_fill`, sliders and checkboxes with `bg_fill`.
        (widget.weak_bg_fill, widget.bg_fill) = (fill, track);
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
