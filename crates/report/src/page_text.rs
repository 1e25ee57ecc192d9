//! Headings and text functions that the HTML and Markdown reports share.

/// The heading above the summary of claims.
pub(crate) const CLAIMS: &str = "Claim results";
/// The heading above the settings.
pub(crate) const SETTINGS: &str = "Exact settings";
/// The heading above the provenance.
pub(crate) const PROVENANCE: &str = "How this report was made";

/// The paragraphs of a text, separated by blank lines, each as a single line.
pub(crate) fn paragraphs(text: &str) -> impl Iterator<Item = String> {
    let mut parts = vec![String::new()];
    for line in text.lines().map(str::trim) {
        match parts.last_mut() {
            Some(part) if !line.is_empty() => {
                if !part.is_empty() {
                    part.push(' ');
                }
                part.push_str(line);
            }
            _ => parts.push(String::new()),
        }
    }
    parts.into_iter().filter(|part| !part.is_empty())
}

/// The percent-encoded path of a file relative to the report.
pub(crate) fn relative_url(folder: &str, name: &str, extension: &str) -> String {
    format!("{folder}/{}.{extension}", percent_encoded(name))
}

/// The percent-encoding of a name for a link.
pub(crate) fn percent_encoded(name: &str) -> String {
    let mut text = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => text.push(char::from(byte)),
            _ => text.push_str(&format!("%{byte:02X}")),
        }
    }
    text
}
