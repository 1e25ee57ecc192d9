//! Collects diagnostics: checks of numbers, counts and texts that report a field's path.

use std::collections::BTreeSet;

use crate::limits::experiment::MAX_VALUE;
use crate::scenario::Diagnostic;

/// The diagnostics found so far.
#[derive(Default)]
pub(super) struct Collector {
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Whether a list is too long. Then nothing but sizes is checked.
    pub(super) is_too_large: bool,
}

impl Collector {
    pub(super) fn add(&mut self, path: &str, message: impl Into<String>) {
        self.diagnostics.push(Diagnostic { path: path.into(), message: message.into() });
    }

    pub(super) fn count(&mut self, path: &str, count: usize, max: usize) {
        if count > max {
            self.add(path, format!("has {count} entries; help: give at most {max}"));
            self.is_too_large = true;
        }
    }

    pub(super) fn text(&mut self, path: &str, text: &str, max: usize) {
        let length = text.chars().count();
        if length > max {
            self.add(path, format!("has {length} characters; help: write at most {max}"));
        }
    }

    pub(super) fn value(&mut self, path: &str, value: f64) {
        if !(-MAX_VALUE..=MAX_VALUE).contains(&value) {
            self.add(path, format!("is {value}; help: give a number from {} to {MAX_VALUE}", -MAX_VALUE));
        }
    }

    pub(super) fn range(&mut self, path: &str, value: u64, min: u64, max: u64) {
        if !(min..=max).contains(&value) {
            self.add(path, format!("is {value}; help: give {min} to {max}"));
        }
    }

    /// Checks that names are unique and not empty.
    pub(super) fn names<'a>(&mut self, path: &str, names: impl Iterator<Item = &'a str>) {
        let mut seen = BTreeSet::new();
        for name in names {
            if name.trim().is_empty() {
                self.add(path, "has an entry with an empty name; help: give it a name");
            } else if !seen.insert(name) {
                self.add(path, format!("has two entries called \"{name}\"; help: rename one of them"));
            }
        }
    }

    /// Checks a name that becomes the name of a file.
    pub(super) fn file_name(&mut self, path: &str, name: &str) {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if name.is_empty() || name.len() > 60 || !name.chars().all(fits) {
            let help = "it becomes a file name; help: give 1 to 60 characters of a-z, 0-9 and -";
            self.add(path, format!("is \"{name}\", but {help}"));
        }
    }
}
