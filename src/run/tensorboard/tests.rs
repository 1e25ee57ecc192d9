//! Tests of the format and of cutting files back.

use super::event::{FRAME_BYTES, masked_crc};
use super::*;

/// CRC-32C bit by bit, from its polynomial.
fn slow_crc(data: &[u8]) -> u32 {
    !data.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0x82F6_3B78 * (c & 1)))
    })
}

/// Removes the first `n` bytes of `data` and returns them.
fn take<'a>(data: &mut &'a [u8], n: usize) -> &'a [u8] {
    let (head, tail) = data.split_at(n);
    *data = tail;
    head
}

fn take_varint(data: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..).step_by(7) {
        let byte = take(data, 1)[0];
        value |= u64::from(byte & 0x7F) << shift;
        if byte < 0x80 {
            break;
        }
    }
    value
}

/// The fields of a message: the field number, and the content as bytes (a varint as 8 bytes).
fn fields(mut data: &[u8]) -> Vec<(u64, Vec<u8>)> {
    let mut found = Vec::new();
    while !data.is_empty() {
        let key = take_varint(&mut data);
        let content = match key & 7 {
            0 => take_varint(&mut data).to_le_bytes().to_vec(),
            1 => take(&mut data, 8).to_vec(),
            2 => {
                let length = take_varint(&mut data);
                take(&mut data, length as usize).to_vec()
            }
            5 => take(&mut data, 4).to_vec(),
            wire => panic!("wire type {wire}"),
        };
        found.push((key >> 3, content));
    }
    found
}

/// The records of a file, with both checksums verified.
fn records(mut data: &[u8]) -> Vec<Vec<u8>> {
    let unmasked = |bytes: &[u8]| {
        let masked = u32::from_le_bytes(bytes.try_into().expect("4 bytes"));
        masked.wrapping_sub(0xA282_EAD8).rotate_left(15)
    };
    let mut found = Vec::new();
    while !data.is_empty() {
        let length = take(&mut data, 8);
        assert_eq!(unmasked(take(&mut data, 4)), slow_crc(length), "checksum of the length");
        let content = take(&mut data, u64::from_le_bytes(length.try_into().expect("8 bytes")) as usize);
        assert_eq!(unmasked(take(&mut data, 4)), slow_crc(content), "checksum of the content");
        found.push(content.to_vec());
    }
    found
}

#[test]
fn the_checksum_mask_matches_the_format() {
    assert_eq!(slow_crc(b"123456789"), 0xE306_9283, "the check value in CRC catalogues");
    // 0xE3069283 rotated right by 15 bits is 0x2507C60D; plus 0xA282EAD8 that is 0xC78AB0E5.
    assert_eq!(masked_crc(b"123456789"), 0xC78A_B0E5);
}

#[test]
fn written_scalars_can_be_read_back() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let mut writer = EventWriter::create(dir.path(), 0.0).expect("a new file");
    let points = [("episode/return", 0, -1.5_f32), ("loss", 300, 0.25), ("loss", 1 << 40, f32::MAX)];
    for (tag, step, value) in points {
        writer.scalar(tag, step, value).expect("a scalar");
    }
    writer.flush().expect("flushed");

    let entry =
        std::fs::read_dir(dir.path()).expect("the folder").next().expect("one file").expect("is there");
    let name = entry.file_name().into_string().expect("a plain name");
    assert!(name.starts_with("events.out.tfevents.") && name.ends_with(".wayfield"), "{name}");
    let records = records(&std::fs::read(entry.path()).expect("the file"));
    assert_eq!(records.len(), 1 + points.len());
    assert_eq!(fields(&records[0])[1], (3, b"brain.Event:2".to_vec()), "the first event holds the version");
    for (record, (tag, step, value)) in records[1..].iter().zip(points) {
        let event = fields(record);
        assert_eq!(event.iter().map(|f| f.0).collect::<Vec<_>>(), [1, 2, 5]);
        let wall = f64::from_le_bytes(event[0].1.clone().try_into().expect("8 bytes"));
        assert!(wall > 1.7e9, "wall time is in seconds since 1970, not {wall}");
        assert_eq!(event[1].1, u64::to_le_bytes(step));
        let summary = fields(&event[2].1);
        assert_eq!((summary.len(), summary[0].0), (1, 1));
        let point = fields(&summary[0].1);
        assert_eq!(point, [(1, tag.as_bytes().to_vec()), (2, value.to_le_bytes().to_vec())]);
    }
}

#[test]
fn a_new_file_comes_after_all_others_even_if_the_clock_was_set_back() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let latest = "events.out.tfevents.4000000000.wayfield";
    std::fs::write(dir.path().join(latest), "").expect("written");
    for number in 1..=3 {
        EventWriter::create(dir.path(), 0.0).expect("a new file");
        let files = files(dir.path());
        let name = files.last().and_then(|file| file.file_name()).expect("there are files");
        assert_eq!(name, format!("events.out.tfevents.{}.wayfield", 4_000_000_000_u64 + number).as_str());
        assert_eq!(files.len() as u64, 1 + number);
    }
}

#[test]
fn no_event_is_earlier_than_the_events_before_it() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let mut writer = EventWriter::create(dir.path(), 5e9).expect("a new file");
    writer.scalar("loss", 1, 0.0).expect("a scalar");
    writer.flush().expect("flushed");
    assert_eq!(
        cut_back(dir.path(), |_, _| true).expect("read"),
        5e9,
        "although the clock shows an earlier time"
    );
}

/// Creates an event file with a point of "a" and one of "b" at each step in `steps`.
fn write_points(dir: &Path, steps: std::ops::Range<u64>) -> PathBuf {
    let mut writer = EventWriter::create(dir, 0.0).expect("a new file");
    for step in steps {
        writer.scalar("a", step, 1.0).expect("a scalar");
        writer.scalar("b", step, 2.0).expect("a scalar");
    }
    files(dir).pop().expect("the new file")
}

/// The tag and the step of each point in a file.
fn points(file: &Path) -> Vec<(String, u64)> {
    let records = records(&std::fs::read(file).expect("the file"));
    let points = records.iter().filter_map(|record| event::point(record));
    points.map(|point| (point.tag.to_owned(), point.step)).collect()
}

#[test]
fn files_are_cut_back_to_the_points_that_are_kept() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (first, second) = (write_points(dir.path(), 1..100), write_points(dir.path(), 100..200));
    let third = write_points(dir.path(), 200..300);
    let unrelated = dir.path().join("events.out.tfevents.1.other");
    std::fs::write(&unrelated, "of another program").expect("written");
    let before = std::fs::read(&first).expect("the file");

    // One curve may have to end earlier than another.
    cut_back(dir.path(), |tag, step| step <= if tag == "b" { 149 } else { 150 }).expect("cut");
    assert_eq!(std::fs::read(&first).expect("the file"), before, "a file with kept points only is unchanged");
    let kept = points(&second);
    assert_eq!(kept.len(), 101);
    assert_eq!(kept[99..], [("b".to_owned(), 149), ("a".to_owned(), 150)]);
    assert!(!third.exists(), "a file without a point is deleted");
    assert!(unrelated.exists());
}

#[test]
fn a_damaged_or_incomplete_record_is_cut_off() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let file = write_points(dir.path(), 1..10);
    let whole = std::fs::read(&file).expect("the file");
    let expected = points(&file);
    let last = records(&whole).last().expect("a record").len() + FRAME_BYTES as usize;
    let changed = |position: usize| {
        let mut bytes = whole.clone();
        bytes[position] ^= 1;
        bytes
    };
    let zeros = [&whole[..whole.len() - last], &[0; 4096]].concat();
    let mut cases = vec![zeros];
    cases.extend((1..last).map(|missing| whole[..whole.len() - missing].to_vec()));
    cases.extend((whole.len() - last..whole.len()).map(changed));
    for damaged in cases {
        std::fs::write(&file, &damaged).expect("written");
        cut_back(dir.path(), |_, _| true).expect("cut");
        assert_eq!(points(&file), expected[..expected.len() - 1]);
    }
}

#[test]
fn the_error_for_a_missing_folder_names_it() {
    let error = EventWriter::create(Path::new("/no/such/folder"), 0.0).expect_err("there is no folder");
    assert!(error.to_string().contains("/no/such/folder"), "{error}");
}
