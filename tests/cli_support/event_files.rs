//! A reader of TensorBoard event files, independent of the program's own code. It reads what TensorBoard would read, in the same
//! order.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The points of each curve: step, and bits of the value.
pub type Curves = BTreeMap<String, Vec<(u64, u32)>>;

/// The event files in `folder`, in TensorBoard's order.
pub fn event_files(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_event_file =
        |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().starts_with("events.out.tfevents.");
    let mut files: Vec<PathBuf> = paths.filter(is_event_file).collect();
    files.sort();
    files
}

/// The curves in the event files of `folder`. Panics if a record is incomplete.
pub fn curves(folder: &Path) -> Curves {
    let mut curves = Curves::new();
    for file in event_files(folder) {
        let bytes = fs::read(&file).unwrap();
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let length = u64::from_le_bytes(rest[..8].try_into().unwrap()) as usize;
            let event = rest.get(12..12 + length).unwrap_or_else(|| panic!("{} is cut off", file.display()));
            rest = &rest[16 + length..];
            // After the wall time comes the step; in the first event of a file, the version.
            if event[9] == 0x10 {
                let (step, value) = varint(&event[10..]);
                // The keys and lengths of two messages, the key and length of the tag, the tag, a key and the value.
                let (tag_length, tag) = varint(&value[5..]);
                let tag = String::from_utf8(tag[..tag_length as usize].to_vec()).unwrap();
                let value = u32::from_le_bytes(event[length - 4..].try_into().unwrap());
                curves.entry(tag).or_default().push((step, value));
            }
        }
    }
    curves
}

/// Asserts that the steps of each curve never decrease.
pub fn assert_curves_never_go_back(folder: &Path) {
    let curves = curves(folder);
    assert!(curves.contains_key("episode/return"), "{folder:?}: {:?}", curves.keys());
    for (tag, points) in curves {
        let back = points.windows(2).find(|pair| pair[1].0 < pair[0].0);
        assert_eq!(back, None, "{}: {tag} goes back", folder.display());
    }
}

/// A number of seven bits per byte, and the bytes after it.
fn varint(bytes: &[u8]) -> (u64, &[u8]) {
    let end = bytes.iter().position(|byte| *byte < 0x80).unwrap();
    let value = bytes[..=end].iter().rev().fold(0, |value, byte| value << 7 | u64::from(byte & 0x7F));
    (value, &bytes[end + 1..])
}
