//! What a file has that a scenario cannot represent.

use wayfield_scenario::printable;

/// Most names that are listed of one kind.
const MAX_NAMES: usize = 8;

/// What could not be represented, by kind, in the order in which it was found.
#[derive(Clone, Debug, Default)]
pub struct Findings(Vec<(String, Vec<String>)>);

impl Findings {
    /// Adds the thing `name`; `what` says what became of things of its kind, as in "meshes are left out".
    pub fn add(&mut self, what: &str, name: &str) {
        let known = self.0.iter().position(|(other, _)| other == what);
        let index = known.unwrap_or_else(|| {
            self.0.push((what.into(), Vec::new()));
            self.0.len() - 1
        });
        self.0[index].1.push(printable(name).into_owned());
    }

    /// One line for each kind, with the names of the first few.
    pub fn lines(&self) -> Vec<String> {
        let line = |(what, names): &(String, Vec<String>)| {
            let shown: Vec<&str> = names.iter().take(MAX_NAMES).map(String::as_str).collect();
            let more = names.len().saturating_sub(MAX_NAMES);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{what}: {}{more}", shown.join(", "))
        };
        self.0.iter().map(line).collect()
    }
}
