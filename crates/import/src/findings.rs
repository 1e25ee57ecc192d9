//! Findings: the parts of a file that a scenario cannot represent.

use wayfield_scenario::printable;

/// The maximum number of names listed for one kind.
const MAX_NAMES: usize = 8;

/// The maximum number of characters that a message shows of a text from a file.
const MAX_SHOWN_CHARS: usize = 60;

/// A text from a file, for a message: with unprintable characters escaped, and cut off if it is long.
pub fn shown(text: &str) -> String {
    let start: String = text.chars().take(MAX_SHOWN_CHARS).collect();
    let more = if start.len() < text.len() { "..." } else { "" };
    format!("{}{more}", printable(&start))
}

/// What could not be represented, by kind, in the order in which it was found.
#[derive(Clone, Debug, Default)]
pub struct Findings(Vec<Kind>);

/// Things of one kind: what became of them, the names of the first few, and how many there are.
#[derive(Clone, Debug)]
struct Kind {
    what: String,
    names: Vec<String>,
    count: usize,
}

impl Findings {
    /// Adds the thing `name`. `what` states what became of things of its kind, as in "meshes are left out".
    pub fn add(&mut self, what: &str, name: &str) {
        let known = self.0.iter().position(|kind| kind.what == what);
        let index = known.unwrap_or_else(|| {
            self.0.push(Kind { what: what.into(), names: Vec::new(), count: 0 });
            self.0.len() - 1
        });
        let kind = &mut self.0[index];
        kind.count += 1;
        if kind.names.len() < MAX_NAMES {
            kind.names.push(shown(name));
        }
    }

    /// One line for each kind, with the names of the first few.
    pub fn lines(&self) -> Vec<String> {
        let line = |Kind { what, names, count }: &Kind| {
            let more = count - names.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{what}: {}{more}", names.join(", "))
        };
        self.0.iter().map(line).collect()
    }
}
