//! The positions of all fields in a RON text.

use std::ops::Range;

use crate::tokens::token;

/// A value in the text, with its key.
struct Entry {
    /// The index of the entry that contains it.
    parent: usize,
    step: Step,
    /// The offset of its key, or of the value if it has no key.
    start: usize,
    /// The offset of its value.
    value: usize,
    /// The offset of its end (exclusive).
    end: usize,
}

/// The last part of an entry's path.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    /// The start and end of the key.
    Field((usize, usize)),
    Index(usize),
}

/// An open bracket.
struct Open {
    entry: usize,
    /// The number of commas so far.
    count: usize,
    /// The entry between the last comma and the next, once it has begun.
    child: Option<usize>,
}

/// A map between the byte offsets of a RON text and the paths of its fields, in both directions.
///
/// A path looks like `obstacles[2].shape.radius_m`. Names of structs and enum variants are not part of it. Invalid text is
/// accepted, because error messages need positions in it.
///
/// ```
/// use wayfield_ron_patch::SourceMap;
///
/// let text = "(name: \"Empty\", starts: [(0.0, 0.0), (1.0, 0.0)])";
/// let map = SourceMap::new(text);
/// let offset = map.offset_of("starts[1][0]").ok_or("not found")?;
/// assert!(text[offset..].starts_with("1.0"));
/// assert_eq!(map.path_at(offset), "starts[1][0]");
/// # Ok::<(), &str>(())
/// ```
pub struct SourceMap<'a> {
    text: &'a str,
    /// In the order of the text; the first is the whole value.
    entries: Vec<Entry>,
}

/// An offset in [`Entry`] that is not known yet.
const UNKNOWN: usize = usize::MAX;

impl<'a> SourceMap<'a> {
    /// The entry of the whole value.
    pub(crate) const ROOT: usize = 0;

    /// The source map of `text`.
    #[must_use]
    pub fn new(text: &'a str) -> Self {
        let root = Entry { parent: 0, step: Step::Index(0), start: 0, value: UNKNOWN, end: UNKNOWN };
        let mut map = Self { text, entries: vec![root] };
        let mut open = vec![Open { entry: 0, count: 0, child: Some(0) }];
        let mut at = 0;
        while let Some((start, end)) = token(text, at) {
            map.add_token(&mut open, at, (start, end));
            at = end;
        }
        map
    }

    /// Adds the token from `start` to `end`; the previous token ends at `previous_end`.
    fn add_token(&mut self, open: &mut Vec<Open>, previous_end: usize, (start, end): (usize, usize)) {
        let depth = open.len();
        let Some(inner) = open.last_mut() else { return };
        match self.text.as_bytes()[start] {
            b',' if depth > 1 => {
                self.end_child(inner, start);
                inner.count += 1;
            }
            b':' if depth > 1 => self.turn_child_into_key(inner, previous_end),
            b')' | b']' | b'}' if depth > 1 => {
                self.end_child(inner, start);
                self.entries[inner.entry].end = end;
                open.pop();
            }
            first => {
                let child = self.child(inner, start);
                if matches!(first, b'(' | b'[' | b'{') {
                    open.push(Open { entry: child, count: 0, child: None });
                }
            }
        }
    }

    /// The open child of `inner`, which the token at `start` belongs to. If there is none, the token starts one.
    fn child(&mut self, inner: &mut Open, start: usize) -> usize {
        let child = *inner.child.get_or_insert_with(|| {
            let step = Step::Index(inner.count);
            self.entries.push(Entry { parent: inner.entry, step, start, value: start, end: UNKNOWN });
            self.entries.len() - 1
        });
        let entry = &mut self.entries[child];
        entry.value = entry.value.min(start);
        child
    }

    /// Turns the open child, whose last token ends at the offset `end`, into a key. Its value follows.
    fn turn_child_into_key(&mut self, inner: &Open, end: usize) {
        if let Some(entry) = inner.child.map(|child| &mut self.entries[child]) {
            let key = &self.text[entry.start..end];
            let unquoted = key.trim_start_matches('"');
            let from = entry.start + key.len() - unquoted.len();
            entry.step = Step::Field((from, from + unquoted.trim_end_matches('"').len()));
            entry.value = UNKNOWN;
        }
    }

    fn end_child(&mut self, inner: &mut Open, at: usize) {
        if let Some(child) = inner.child.take() {
            let entry = &mut self.entries[child];
            entry.end = entry.end.min(at);
            entry.value = entry.value.min(at);
        }
    }

    /// The path of the innermost field around `offset`; empty for the top level.
    #[must_use]
    pub fn path_at(&self, offset: usize) -> String {
        self.path_of(self.innermost(offset))
    }

    /// The path of the struct or list that contains the innermost field around `offset`.
    #[must_use]
    pub fn parent_path_at(&self, offset: usize) -> String {
        self.path_of(self.entries[self.innermost(offset)].parent)
    }

    /// The offset at which the value of the innermost field around `offset` starts; `offset` if the value starts later.
    #[must_use]
    pub fn value_start_at(&self, offset: usize) -> usize {
        self.entries[self.innermost(offset)].value.min(offset)
    }

    /// The range of the value of the innermost field around `offset`.
    #[must_use]
    pub fn value_at(&self, offset: usize) -> Range<usize> {
        self.value_of(self.innermost(offset))
    }

    /// The range of the innermost field around `offset`: its name and its value.
    #[must_use]
    pub fn field_at(&self, offset: usize) -> Range<usize> {
        let Entry { start, end, .. } = self.entries[self.innermost(offset)];
        self.trimmed(start..end)
    }

    /// The names of the fields of the top-level value.
    pub fn field_names(&self) -> impl Iterator<Item = &'a str> {
        self.fields_of(Self::ROOT).map(|(name, _)| name)
    }

    /// The range of the value of `entry`.
    pub(crate) fn value_of(&self, entry: usize) -> Range<usize> {
        let Entry { value, end, .. } = self.entries[entry];
        self.trimmed(value..end)
    }

    /// The text of the value of `entry`.
    pub(crate) fn text_of(&self, entry: usize) -> &'a str {
        &self.text[self.value_of(entry)]
    }

    /// The field `name` of the struct or variant `entry`.
    pub(crate) fn field_of(&self, entry: usize, name: &str) -> Option<usize> {
        self.fields_of(entry).find(|&(field, _)| field == name).map(|(_, child)| child)
    }

    /// The fields of the struct or variant `entry`, by name.
    pub(crate) fn fields_of(&self, entry: usize) -> impl Iterator<Item = (&'a str, usize)> {
        self.children_of(entry).filter_map(|child| match self.entries[child].step {
            Step::Field((from, to)) => Some((&self.text[from..to], child)),
            Step::Index(_) => None,
        })
    }

    /// The elements of `entry`: a list, a tuple or a variant with unnamed fields.
    pub(crate) fn elements_of(&self, entry: usize) -> impl Iterator<Item = usize> {
        self.children_of(entry).filter(|&child| matches!(self.entries[child].step, Step::Index(_)))
    }

    /// The entries directly inside `entry`, in the order of the text.
    fn children_of(&self, entry: usize) -> impl Iterator<Item = usize> {
        (entry + 1..self.entries.len()).filter(move |&child| self.entries[child].parent == entry)
    }

    /// The offset after the opening round bracket of the struct or variant `entry`.
    pub(crate) fn bracket_of(&self, entry: usize) -> Option<usize> {
        let Range { start, .. } = self.value_of(entry);
        let (word_start, word_end) = token(self.text, start)?;
        let after_bracket = |at: usize| self.text[at..].starts_with('(').then_some(at + 1);
        let (after_word, _) = token(self.text, word_end)?;
        after_bracket(word_start).or_else(|| {
            let is_name = self.text[word_start..].starts_with(|c: char| c.is_alphabetic());
            is_name.then(|| after_bracket(after_word)).flatten()
        })
    }

    /// `range` within the text, without the spaces at its end.
    fn trimmed(&self, range: Range<usize>) -> Range<usize> {
        let end = range.end.min(self.text.len());
        let start = range.start.min(end);
        start..start + self.text[start..end].trim_end().len()
    }

    /// The offset of the value at `path`; the end of the text if it ends before the value. If the text does not contain the
    /// field, the offset of the innermost field on the path that it does contain; `None` if it contains no field of the path.
    #[must_use]
    pub fn offset_of(&self, path: &str) -> Option<usize> {
        let mut found = 0;
        for step in path.split(['.', '[']) {
            let Some(child) = self.child_at(found, step) else { break };
            found = child;
        }
        (found != 0).then(|| self.entries[found].value.min(self.text.len()))
    }

    /// The entry in `parent` with the name or index `step`, written `field` or `2]`.
    fn child_at(&self, parent: usize, step: &str) -> Option<usize> {
        let index = step.strip_suffix(']').and_then(|digits| digits.parse::<usize>().ok());
        let is_named = |entry: &Entry| match (entry.step, index) {
            (Step::Field((from, to)), None) => &self.text[from..to] == step,
            (Step::Index(i), Some(index)) => i == index,
            _ => false,
        };
        self.children_of(parent).find(|&child| is_named(&self.entries[child]))
    }

    /// The offset of the top-level value, after leading comments; `None` if the text contains no value.
    #[must_use]
    pub fn start(&self) -> Option<usize> {
        self.entries.first().map(|root| root.value).filter(|&value| value != UNKNOWN)
    }

    /// The innermost entry that contains `offset`. It is the last such entry in the order of the text.
    fn innermost(&self, offset: usize) -> usize {
        self.entries.iter().rposition(|entry| entry.start <= offset && offset < entry.end).unwrap_or(0)
    }

    /// The path of `entry`; empty for the top level.
    pub(crate) fn path_of(&self, mut entry: usize) -> String {
        let mut steps = Vec::new();
        while entry != 0 {
            steps.push(self.entries[entry].step);
            entry = self.entries[entry].parent;
        }
        let mut path = String::new();
        for step in steps.into_iter().rev() {
            match step {
                Step::Index(index) => path.push_str(&format!("[{index}]")),
                Step::Field((from, to)) => {
                    path.push_str(if path.is_empty() { "" } else { "." });
                    path.push_str(&self.text[from..to]);
                }
            }
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r##"#![enable(implicit_some)]
// a ( comment
World(
    name: "a \" ( name", /* nested /* ( */ */
    raw: r#"a " ( raw"#, letter: '(', quote: '\'',
    obstacles: [
        (shape: Circle(radius_m: 0.15), position_m: (0.6, -0.6)),
        (shape: Box(width_m: 1.0)),
    ],
)"##;

    #[test]
    fn paths_and_offsets_convert_both_ways() {
        let map = SourceMap::new(TEXT);
        for (path, value) in [
            ("name", "\"a \\\""),
            ("obstacles[0].shape", "Circle("),
            ("obstacles[0].shape.radius_m", "0.15"),
            ("obstacles[0].position_m[1]", "-0.6"),
            ("obstacles[1]", "(shape: Box"),
            ("obstacles[1].shape.width_m", "1.0"),
        ] {
            let offset = map.offset_of(path).expect(path);
            assert!(TEXT[offset..].starts_with(value), "{path} is at {value}, not {}", &TEXT[offset..]);
            assert_eq!(map.path_at(offset), path);
        }
    }

    #[test]
    fn fields_and_values_have_ranges() {
        let map = SourceMap::new(TEXT);
        let names: Vec<_> = map.field_names().collect();
        assert_eq!(names, ["name", "raw", "letter", "quote", "obstacles"]);
        let at = TEXT.find("0.15").expect("the radius");
        assert_eq!((&TEXT[map.field_at(at)], &TEXT[map.value_at(at)]), ("radius_m: 0.15", "0.15"));
        let at = TEXT.find("Box").expect("the shape");
        assert_eq!(&TEXT[map.value_at(at)], "Box(width_m: 1.0)");
        let open = "(a: (b: 1 ";
        assert_eq!(SourceMap::new(open).value_at(8), 8..9, "an open value ends with the text");
        let commented = SourceMap::new("(a /* b */: 1)");
        assert_eq!(commented.field_names().collect::<Vec<_>>(), ["a"], "a comment is not part of the name");
    }

    #[test]
    fn a_missing_field_is_located_at_its_nearest_parent() {
        let map = SourceMap::new(TEXT);
        assert_eq!(map.offset_of("obstacles[1].rotation_rad"), map.offset_of("obstacles[1]"));
        assert_eq!(map.offset_of("task.goal_radius_m"), None);
        assert_eq!(map.start(), TEXT.find("World("));
    }

    #[test]
    fn invalid_keys_do_not_panic() {
        assert_eq!(
            SourceMap::new("(a:").offset_of("a"),
            Some(3),
            "a missing value is at the end of the text"
        );
        let quotes = "(\"\"\"éa\": 1)";
        assert_eq!(SourceMap::new(quotes).path_at(quotes.len() - 2), "éa");
    }

    #[test]
    fn deep_nesting_does_not_overflow_the_stack() {
        let text = "[".repeat(200_000);
        let map = SourceMap::new(&text);
        assert!(map.path_at(50).ends_with("[0]"));
    }
}
