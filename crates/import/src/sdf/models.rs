//! The files of included models.

use std::path::{Component, Path, PathBuf};

use wayfield_scenario::is_file;

/// The names of models that are only ground and light.
const SCENERY: [&str; 3] = ["ground_plane", "ground plane", "sun"];

/// Whether a model is only ground or light, so that it need not be found. Its name may be followed by a version, a number or
/// `tip`.
pub fn is_scenery(uri: &str) -> bool {
    let is_version = |part: &str| part == "tip" || part.bytes().all(|byte| byte.is_ascii_digit());
    // The part after a slash at the end is empty, and so also skipped.
    let name = uri.trim().rsplit('/').find(|part| !is_version(part));
    name.is_some_and(|name| SCENERY.iter().any(|scenery| name.eq_ignore_ascii_case(scenery)))
}

/// The SDF file of the model `uri`, such as `model://table`. A model is a folder with a file `model.sdf`; it may be in one
/// of the `folders`, or else in the folder of one of the files `from`, in `models` there, or in `../models`.
pub fn find(uri: &str, from: [&Path; 2], folders: &[PathBuf]) -> Option<PathBuf> {
    let relative = uri.strip_prefix("model://").unwrap_or(uri.rsplit('/').next()?);
    let relative = Path::new(relative);
    // Nothing outside of the folders is read.
    let is_plain = relative.components().all(|part| matches!(part, Component::Normal(_)));
    if !is_plain || relative.as_os_str().is_empty() {
        return None;
    }
    let near = from.into_iter().flat_map(|file| {
        let folder = file.parent().unwrap_or(Path::new(""));
        [folder.to_path_buf(), folder.join("models"), folder.join("../models")]
    });
    let file = |folder: PathBuf| folder.join(relative).join("model.sdf");
    folders.iter().cloned().chain(near).map(file).find(|file| is_file(file))
}
