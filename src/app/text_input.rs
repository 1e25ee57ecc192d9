//! Text from an input method, an emoji picker or a virtual keyboard in a browser. They write into a hidden text field of the
//! page (`web/text_input.js`).
//!
//! In: text from the page. Out: events for egui, and, for the page, the position of egui's text cursor.

use std::cell::RefCell;
use std::sync::{Mutex, PoisonError};

use bevy::prelude::*;
use bevy::winit::{EventLoopProxyWrapper, WinitUserEvent};
use bevy_egui::{EguiInput, EguiOutput, EguiPreUpdateSet};
use egui::{Event, ImeEvent};
use wasm_bindgen::prelude::*;

use super::page;

/// Text that egui has not received yet.
static EVENTS: Mutex<Vec<Event>> = Mutex::new(Vec::new());

thread_local! {
    /// Requests a frame.
    static REDRAW: RefCell<Option<Box<dyn Fn()>>> = const { RefCell::new(None) };
}

/// The plugin that connects the page's text field with egui.
pub(super) struct TextInputPlugin;

impl Plugin for TextInputPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, keep_event_loop)
            .add_systems(
                PreUpdate,
                pass_on_text.after(EguiPreUpdateSet::ProcessInput).before(EguiPreUpdateSet::BeginPass),
            )
            .add_systems(Last, report_cursor);
    }
}

/// Shows text that the user is still composing; an empty text ends the composition.
#[wasm_bindgen]
pub fn compose_text(text: String) {
    receive(ImeEvent::Preedit { text, active_range_chars: None });
}

/// Inserts `text`, in place of the text that was being composed.
#[wasm_bindgen]
pub fn insert_text(text: String) {
    receive(ImeEvent::Commit(text));
}

fn receive(event: ImeEvent) {
    EVENTS.lock().unwrap_or_else(PoisonError::into_inner).push(Event::Ime(event));
    REDRAW.with_borrow(|redraw| redraw.as_ref().map(|redraw| redraw()));
}

fn keep_event_loop(event_loop: Res<EventLoopProxyWrapper>) {
    let event_loop = (**event_loop).clone();
    let redraw = move || {
        // If the app has ended, there is nothing to draw.
        let _ = event_loop.send_event(WinitUserEvent::WakeUp);
    };
    REDRAW.set(Some(Box::new(redraw)));
}

fn pass_on_text(mut inputs: Query<&mut EguiInput>) {
    let events = std::mem::take(&mut *EVENTS.lock().unwrap_or_else(PoisonError::into_inner));
    for mut input in &mut inputs {
        input.events.extend(events.iter().cloned());
    }
}

/// Reports the position of egui's text cursor to the page when it has changed.
fn report_cursor(outputs: Query<&EguiOutput>, mut reported: Local<Option<egui::Rect>>) {
    let cursor = outputs.iter().find_map(|output| Some(output.platform_output.ime?.cursor_rect));
    if *reported != cursor {
        *reported = cursor;
        page::edit_text(cursor.map(|rect| vec![rect.left(), rect.top(), rect.height()]));
    }
}
