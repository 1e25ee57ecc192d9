//! Functions of the web page that the app calls: the object `wayfieldPage` in `web/page.js`.

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// Value of the query parameter `key` in the address.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn query_parameter(key: &str) -> Option<String>;
    /// Reports that the app has started, so that the page hides its loading screen.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn started();
    /// Reports the error that stopped the app.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn failed(text: &str);
    /// Opens the browser's file picker.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn open_file_picker();
    /// Downloads a file.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn save(name: &str, bytes: &[u8]);
    /// Reports the status of the training run, as JSON.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn report(json: &str);
    /// Makes the address a link that starts the same training run. `embedded` is the scenario's text, unless it is shipped.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn set_share_link(scenario: &str, preset: &str, seed: &str, embedded: Option<String>);
    /// Removes all parameters from the address.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn clear_share_link();
    /// Text of the scenario embedded in the address, if there is one.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn embedded_scenario() -> Option<String>;
    /// Passes a file of the next autosave to the page.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn autosave_file(name: &str, bytes: &[u8]);
    /// Replaces the training run's autosave with the files passed since the last call. `note` describes it, as JSON.
    /// The page reports the result together with `number`.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn autosave(number: u32, note: &str);
    /// Deletes the training run's autosave.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn delete_autosave();
    /// Begins the autosave of another training run; the previous one is kept.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn begin_autosave();
    /// The description of the autosave to offer, as JSON, if there is one.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn last_session() -> Option<String>;
    /// Whether the user asked, before the page was reloaded, to continue from the offered autosave.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn continues_last_session() -> bool;
    /// Requests the files of the offered autosave.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn load_session();
    /// Makes the offered autosave this training run's own: the next autosave replaces it.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn adopt_last_session();
    /// The backups of the editor that may be offered, newest first, as a JSON list.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn last_backups() -> String;
    /// Makes the backup with this key this tab's own.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn adopt_backup(key: &str);
    /// Stores the backup of the editor. Returns an error message if that fails.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn store_backup(text: &str) -> Option<String>;
    /// Deletes the backup of the editor.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn delete_backup();
    /// A font file with these characters; `None` if the browser does not let pages read what they draw.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn font_with(characters: &str) -> Option<Vec<u8>>;
    /// Enables input methods at the text cursor, given by its left, top and height in points; `None` if no text is edited.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn edit_text(cursor: Option<Vec<f32>>);
    /// Stores the preferences for the next visit.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn save_preferences(text: &str);
    /// The stored preferences.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn load_preferences() -> Option<String>;
}
