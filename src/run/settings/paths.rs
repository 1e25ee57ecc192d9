//! The paths of the fields of presets and scenarios, to complete a path that lacks its beginning: `gamma` to `learning.gamma`.

use serde_json::Value;

use crate::run::preset::Preset;
use crate::scenario::Scenario;

/// The maximum number of paths in a message.
const MAX_LISTED: usize = 3;

/// The paths that end with `path`, at most `MAX_LISTED`, shortest first, for a message: "`learning.gamma`". `None` if there are
/// none.
pub(super) fn paths_ending_with(
    path: &str,
    preset: Option<&Preset>,
    scenario: Option<&Scenario>,
) -> Option<String> {
    let (named, index) = path.split_at(path.find('[').unwrap_or(path.len()));
    let mut paths = Vec::new();
    if let Some(value) = preset.and_then(|preset| serde_json::to_value(preset).ok()) {
        collect("", &value, &mut paths);
    }
    if let Some(value) = scenario.and_then(|scenario| serde_json::to_value(scenario).ok()) {
        collect("scenario", &value, &mut paths);
    }
    let end = format!(".{named}");
    paths.retain(|path| path.ends_with(&end));
    paths.sort_by_key(|path| path.matches('.').count());
    let listed: Vec<String> = paths.iter().take(MAX_LISTED).map(|path| format!("`{path}{index}`")).collect();
    (!listed.is_empty()).then(|| listed.join(" or "))
}

/// Adds the paths of the fields in `value`, which is at `path`. The name of an enum's variant is not part of them; fields of a
/// list's elements are left out.
fn collect(path: &str, value: &Value, paths: &mut Vec<String>) {
    let Value::Object(fields) = value else { return };
    for (name, value) in fields {
        if name.starts_with(|c: char| c.is_ascii_uppercase()) {
            collect(path, value, paths);
            continue;
        }
        let inside = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        collect(&inside, value, paths);
        paths.push(inside);
    }
}
