//! Notes: valid but questionable settings of a file.

use std::fmt;

use glam::Vec2;

use super::file_error::Diagnostic;

/// A questionable setting of a file whose values are all valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// How serious it is.
    pub level: NoteLevel,
    /// The field, what is questionable about it, and the fix.
    pub diagnostic: Diagnostic,
    /// Where on the map it is, in m; `None` if it concerns no single place.
    pub position_m: Option<Vec2>,
}

/// The level of a note.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoteLevel {
    /// Unusual, but perhaps intended.
    Note,
    /// Training will fail, or will achieve less than it could.
    Warning,
}

impl Note {
    /// A note about a field, without a place on the map.
    #[must_use]
    pub fn new(level: NoteLevel, path: impl Into<String>, message: impl Into<String>) -> Self {
        let diagnostic = Diagnostic { path: path.into(), message: message.into() };
        Self { level, diagnostic, position_m: None }
    }
}

impl fmt::Display for Note {
    /// Such as "warning: `task.max_episode_steps` is 3: ...".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.level, self.diagnostic)
    }
}

impl fmt::Display for NoteLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Note => "note",
            Self::Warning => "warning",
        })
    }
}
