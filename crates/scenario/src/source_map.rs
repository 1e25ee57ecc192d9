//! Which field of a RON text stands where: a tolerant walk over brackets, keys and commas.
//!
//! In: RON text, broken or not. Out: from a byte offset the field around it, from a field's path
//! (`obstacles[2].shape.radius_m`) its offset. Names of structs and enum variants are no part of a path. It
//! judges nothing: ron has parsed the text, or says where it gave up.

/// One value of the text.
struct Node {
    parent: usize,
    step: Step,
    /// Where its key starts, or the value itself when it has no key.
    start: usize,
    /// Where its value starts.
    value: usize,
    /// Where it ends (exclusive).
    end: usize,
}

/// How one gets from the parent to a node.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    Field((usize, usize)),
    Index(usize),
}

/// An open bracket.
struct Open {
    node: usize,
    count: usize,
    child: Option<usize>,
}

/// The values of a RON text. Node 0 is the whole.
pub(super) struct SourceMap<'a> {
    text: &'a str,
    nodes: Vec<Node>,
}

const UNKNOWN: usize = usize::MAX;

impl<'a> SourceMap<'a> {
    /// Walks `text` once.
    pub fn new(text: &'a str) -> Self {
        let root = Node { parent: 0, step: Step::Index(0), start: 0, value: UNKNOWN, end: UNKNOWN };
        let mut outline = Self { text, nodes: vec![root] };
        let mut open = vec![Open { node: 0, count: 0, child: Some(0) }];
        let mut at = 0;
        while let Some((start, end)) = token(text, at) {
            at = end;
            outline.take(&mut open, start, end);
        }
        outline
    }

    fn take(&mut self, open: &mut Vec<Open>, start: usize, end: usize) {
        let depth = open.len();
        let Some(inner) = open.last_mut() else { return };
        match self.text.as_bytes()[start] {
            b',' if depth > 1 => {
                self.close_child(inner, start);
                inner.count += 1;
            }
            b':' if depth > 1 => {
                if let Some(node) = inner.child.map(|child| &mut self.nodes[child]) {
                    let key = self.text[node.start..start].trim_end().trim_matches('"');
                    let from = node.start + usize::from(self.text[node.start..].starts_with('"'));
                    node.step = Step::Field((from, from + key.len()));
                    node.value = UNKNOWN;
                }
            }
            b')' | b']' | b'}' if depth > 1 => {
                self.close_child(inner, start);
                self.nodes[inner.node].end = end;
                open.pop();
            }
            first => {
                let child = *inner.child.get_or_insert_with(|| {
                    let step = Step::Index(inner.count);
                    self.nodes.push(Node { parent: inner.node, step, start, value: start, end: UNKNOWN });
                    self.nodes.len() - 1
                });
                let node = &mut self.nodes[child];
                node.value = node.value.min(start);
                if matches!(first, b'(' | b'[' | b'{') {
                    open.push(Open { node: child, count: 0, child: None });
                }
            }
        }
    }

    fn close_child(&mut self, inner: &mut Open, at: usize) {
        if let Some(child) = inner.child.take() {
            let node = &mut self.nodes[child];
            node.end = node.end.min(at);
            node.value = node.value.min(at);
        }
    }

    /// The path of the innermost field around `offset`, empty for the whole.
    pub fn path_at(&self, offset: usize) -> String {
        self.path(self.around(offset))
    }

    /// The path of what holds the innermost field around `offset`.
    pub fn parent_path_at(&self, offset: usize) -> String {
        self.path(self.nodes[self.around(offset)].parent)
    }

    /// Where the value of the innermost field around `offset` starts.
    pub fn value_start_at(&self, offset: usize) -> usize {
        self.nodes[self.around(offset)].value.min(offset)
    }

    /// Where the value at `path` starts, or the nearest one above it that the text has (but not the whole).
    pub fn offset_of(&self, path: &str) -> Option<usize> {
        let mut node = 0;
        for step in path.split(['.', '[']) {
            let index = step.strip_suffix(']').and_then(|digits| digits.parse::<usize>().ok());
            let is_it = |other: &Node| match (other.step, index) {
                (Step::Field((from, to)), None) => &self.text[from..to] == step,
                (Step::Index(i), Some(index)) => i == index,
                _ => false,
            };
            let below =
                (node + 1..self.nodes.len()).find(|&k| self.nodes[k].parent == node && is_it(&self.nodes[k]));
            let Some(below) = below else { break };
            node = below;
        }
        (node != 0).then(|| self.nodes[node].value)
    }

    /// Where the whole begins, comments passed over.
    pub fn start(&self) -> Option<usize> {
        self.nodes.first().map(|whole| whole.value).filter(|&value| value != UNKNOWN)
    }

    /// The last node in the text's order that contains `offset`, which is the innermost.
    fn around(&self, offset: usize) -> usize {
        self.nodes.iter().rposition(|node| node.start <= offset && offset < node.end).unwrap_or(0)
    }

    fn path(&self, mut node: usize) -> String {
        let mut steps = Vec::new();
        while node != 0 {
            steps.push(self.nodes[node].step);
            node = self.nodes[node].parent;
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

/// The next token at or after `at`, as (start, end); spaces, comments and `#![...]` lie between tokens.
pub(super) fn token(text: &str, mut at: usize) -> Option<(usize, usize)> {
    loop {
        let rest = &text[at..];
        let first = rest.chars().next()?;
        if first.is_whitespace() {
            at += first.len_utf8();
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += block_comment(rest);
        } else if rest.starts_with("#!") {
            at += rest.find(']').map_or(rest.len(), |end| end + 1);
        } else {
            return Some((at, at + token_length(rest, first)));
        }
    }
}

/// The length of the token at the start of `rest`, whose first character is `first`.
fn token_length(rest: &str, first: char) -> usize {
    match first {
        '"' => quoted(rest),
        '\'' => match rest.strip_prefix("'\\") {
            Some(escaped) => {
                let closing = escaped.char_indices().skip(1).find(|&(_, c)| c == '\'');
                closing.map_or(rest.len(), |(end, _)| end + 3)
            }
            None => rest.char_indices().nth(2).filter(|&(_, c)| c == '\'').map_or(1, |(end, _)| end + 1),
        },
        c if c.is_alphanumeric() || matches!(c, '_' | '+' | '-') => {
            let word = rest[first.len_utf8()..]
                .find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')))
                .map_or(rest.len(), |end| end + first.len_utf8());
            let hashes = rest[word..].bytes().take_while(|&b| b == b'#').count();
            if matches!(&rest[..word], "r" | "br") && rest[word + hashes..].starts_with('"') {
                let body = word + hashes + 1;
                let closing = format!("\"{}", "#".repeat(hashes));
                return rest[body..].find(&closing).map_or(rest.len(), |end| body + end + closing.len());
            }
            word
        }
        c => c.len_utf8(),
    }
}

/// The length of a string literal with escapes, up to the text's end if it has no closing quote.
fn quoted(rest: &str) -> usize {
    let mut escaped = false;
    for (at, byte) in rest.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    rest.len()
}

/// The length of a block comment, which may hold others.
pub(super) fn block_comment(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" if depth == 1 => return at + 2,
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    rest.len()
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
    fn paths_and_offsets_agree_both_ways() {
        let outline = SourceMap::new(TEXT);
        for (path, value) in [
            ("name", "\"a \\\""),
            ("obstacles[0].shape", "Circle("),
            ("obstacles[0].shape.radius_m", "0.15"),
            ("obstacles[0].position_m[1]", "-0.6"),
            ("obstacles[1]", "(shape: Box"),
            ("obstacles[1].shape.width_m", "1.0"),
        ] {
            let offset = outline.offset_of(path).expect(path);
            assert!(TEXT[offset..].starts_with(value), "{path} is at {value}, not {}", &TEXT[offset..]);
            assert_eq!(outline.path_at(offset), path);
        }
    }

    #[test]
    fn a_path_the_text_lacks_is_placed_at_what_it_has_of_it() {
        let outline = SourceMap::new(TEXT);
        assert_eq!(outline.offset_of("obstacles[1].rotation_rad"), outline.offset_of("obstacles[1]"));
        assert_eq!(outline.offset_of("task.goal_radius_m"), None);
        assert_eq!(outline.start(), TEXT.find("World("));
    }

    #[test]
    fn a_deep_text_is_walked_without_recursion() {
        let text = "[".repeat(200_000);
        let outline = SourceMap::new(&text);
        assert!(outline.path_at(50).ends_with("[0]"));
    }
}
