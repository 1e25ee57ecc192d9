//! Python with ONNX Runtime, for tests: the virtual environment that `.ci/python setup` makes. Without it, a test prints one
//! line and is skipped; where `CI` is set, it fails.

#![allow(dead_code, reason = "each test file uses part of this module")]

mod measurements;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub use measurements::Measurements;

/// The Python interpreter of the tests' virtual environment; `None` if it or one of its packages is missing.
pub fn python() -> Option<PathBuf> {
    let cache = std::env::var_os("XDG_CACHE_HOME").filter(|path| !path.is_empty()).map(PathBuf::from);
    let cache = cache.or_else(|| std::env::home_dir().map(|home| home.join(".cache"))).unwrap_or_default();
    let python = cache.join("wayfield/venv/bin/python");
    let imports = Command::new(&python).args(["-c", "import numpy, onnx, onnxruntime"]).output();
    if imports.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    let test = std::thread::current().name().unwrap_or("test").to_string();
    let why = "no Python with numpy, onnx and onnxruntime; help: run `.ci/python setup`";
    assert!(std::env::var_os("CI").is_none(), "{test} must not be skipped in CI: {why}");
    eprintln!("skipped {test}: {why}");
    None
}

/// Runs a Python script in `folder`. It must succeed; the result is what it prints.
pub fn run(python: &Path, folder: &Path, script: &Path) -> String {
    let Output { status, stdout, stderr } =
        Command::new(python).arg(script).current_dir(folder).output().expect("Python starts");
    let (stdout, stderr) = (String::from_utf8_lossy(&stdout), String::from_utf8_lossy(&stderr));
    assert!(status.success(), "{}: {stdout}{stderr}", script.display());
    stdout.into_owned()
}
