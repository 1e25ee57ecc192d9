//! The buttons of the setup panel that open and save files.
//!
//! In: the session state. Out: commands.

use egui::containers::menu::MenuButton;
use egui::{Atom, Button, Ui, vec2};

use crate::app::app_status::{AppStatus, BestSoFar};
use crate::app::commands::{Command, SaveKind};
use crate::app::screen::key_bindings::{Shortcut, with_key_hint};
use crate::app::screen::numbers::{format_count, format_percent};
use crate::app::screen::widgets::buttons::wide_button_ui;
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::drivers::{DriverClass, DriverConfig};

/// The height of the buttons, in points.
const HEIGHT: f32 = 26.0;

const OPEN_HELP: &str =
    "Open a policy or a classical driver to compare with, a saved run to resume, a scenario or a preset";

/// The tooltip without a disk, where no run can be opened.
const OPEN_HELP_WITHOUT_DISK: &str = "Open a policy or a classical driver to compare with, a scenario or a preset. The file stays on your machine";

const SAVE_POLICY: &str = "Save policy…";

/// Draws the section. Without a disk no run can be saved.
pub(super) fn files_ui(ui: &mut Ui, status: &AppStatus, commands: &mut Vec<Command>) {
    section_title_ui(ui, "Files");
    expert_button_ui(ui, status, commands);
    driver_menu_ui(ui, status, commands);
    let open = if status.has_disk { OPEN_HELP } else { OPEN_HELP_WITHOUT_DISK };
    let run = "Save the whole run, so that it can be resumed";
    let scenario = "Save the scenario, including objects you moved";
    // Less padding, so that the longest text fits.
    ui.spacing_mut().button_padding.x = 4.0;
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    ui.horizontal(|ui| {
        button_ui(ui, width, "Open…", &with_key_hint(open, Shortcut::Open), Command::OpenDialog, commands);
        save_policy_ui(ui, width, status, commands);
    });
    ui.horizontal(|ui| {
        if status.has_disk {
            button_ui(ui, width, "Save run…", run, Command::SaveDialog(SaveKind::Run), commands);
        }
        if !status.is_set {
            button_ui(
                ui,
                width,
                "Save scenario…",
                scenario,
                Command::SaveDialog(SaveKind::Scenario),
                commands,
            );
        }
    });
}

fn expert_button_ui(ui: &mut Ui, status: &AppStatus, commands: &mut Vec<Command>) {
    let Some(expert) = &status.expert else { return };
    let (text, about) = if expert.is_new_here {
        let about =
            format!("Compare the current policy with the {}, which was not trained here", expert.name);
        (format!("Watch the {}", expert.name), about)
    } else {
        ("Watch an expert".into(), format!("Compare the current policy with a shipped one: {}", expert.name))
    };
    if wide_button_ui(ui, &text, HEIGHT).on_hover_text(about).clicked() {
        commands.push(Command::OpenExpert);
    }
}

/// Draws the menu of the classical drivers and of policies with a map, by class.
fn driver_menu_ui(ui: &mut Ui, status: &AppStatus, commands: &mut Vec<Command>) {
    let text = (Atom::grow(), "Watch a classical driver", Atom::grow());
    let button = Button::new(text).min_size(vec2(ui.available_width(), HEIGHT));
    let (response, _) = MenuButton::from_button(button).ui(ui, |ui| {
        let mut class = None;
        for (name, driver) in
            DriverConfig::NAMES.iter().filter_map(|name| Some((name, DriverConfig::shipped(name)?)))
        {
            if class.replace(driver.class()) != Some(driver.class()) {
                ui.label(weak_text(driver.class().about()));
                if driver.class() == DriverClass::B {
                    policies_with_map_ui(ui, status, commands);
                }
            }
            if ui.button(driver.title()).clicked() {
                commands.push(Command::OpenDriver(name));
            }
        }
    });
    response.on_hover_text(
        "Compare the current policy with a classical driver, or a policy with a map, on the same goals",
    );
}

/// Draws the buttons of the policies that get a map.
fn policies_with_map_ui(ui: &mut Ui, status: &AppStatus, commands: &mut Vec<Command>) {
    if ui.button("This policy with a map").clicked() {
        commands.push(Command::OpenWithMap);
    }
    let Some(expert) = &status.expert else { return };
    if ui.button(format!("The {} with a map", expert.name)).clicked() {
        commands.push(Command::OpenExpertWithMap);
    }
}

fn button_ui(
    ui: &mut Ui,
    width: f32,
    text: &str,
    about: &str,
    command: Command,
    commands: &mut Vec<Command>,
) {
    if ui.add_sized(vec2(width, HEIGHT), Button::new(text)).on_hover_text(about).clicked() {
        commands.push(command);
    }
}

/// Draws the button that saves the current policy; once there is a best one, a menu of both.
fn save_policy_ui(ui: &mut Ui, width: f32, status: &AppStatus, commands: &mut Vec<Command>) {
    let current = Command::SaveDialog(SaveKind::Policy);
    let about = with_key_hint("Save the current network as .safetensors", Shortcut::Save);
    let Some(BestSoFar { success_rate, env_steps }) = status.best else {
        return button_ui(ui, width, SAVE_POLICY, &about, current, commands);
    };
    let best = format!("Best so far, {} at {} steps…", format_percent(success_rate), format_count(env_steps));
    let button = Button::new(SAVE_POLICY).min_size(vec2(width, HEIGHT));
    let (response, _) = MenuButton::from_button(button).ui(ui, |ui| {
        if ui.button(best).on_hover_text("Save the best network, by evaluation, as .safetensors").clicked() {
            commands.push(Command::SaveDialog(SaveKind::BestPolicy));
        }
        let text = format!("Current, at {} steps…", format_count(status.env_steps));
        if ui.button(text).on_hover_text(about).clicked() {
            commands.push(current);
        }
    });
    response.on_hover_text("Save the best network so far, or the current one");
}
