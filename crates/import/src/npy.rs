//! Points in a NumPy file (`.npy`).

use glam::{DVec2, dvec2};

use crate::findings::shown;
use crate::limits::COORDINATE_M;

/// The rows of an array of n x 2 numbers (int64, int32 or float64, little-endian, in C order).
///
/// # Errors
/// The file or array is of another kind, is incomplete, or has numbers out of range.
pub fn points(bytes: &[u8]) -> Result<Vec<DVec2>, String> {
    let (header, data) = split(bytes).ok_or("not a .npy file")?;
    let wrong = || {
        let header = shown(header.trim());
        format!("not an array of n x 2 numbers (int64, int32 or float64) in C order: {header}")
    };
    let kind = between(header, "'descr':", ",").ok_or_else(wrong)?;
    let shape = between(header, "'shape':", ")").ok_or_else(wrong)?;
    let is_in_order = between(header, "'fortran_order':", ",").is_some_and(|order| order == "False");
    let mut sides = shape.trim_start_matches('(').split(',').map(str::trim);
    let rows: usize = sides.next().and_then(|rows| rows.parse().ok()).ok_or_else(wrong)?;
    if sides.next() != Some("2") || !is_in_order {
        return Err(wrong());
    }
    let values: Vec<f64> = match kind.trim_matches('\'') {
        "<i8" => data.chunks_exact(8).map(|part| i64::from_le_bytes(fixed(part)) as f64).collect(),
        "<f8" => data.chunks_exact(8).map(|part| f64::from_le_bytes(fixed(part))).collect(),
        "<i4" => data.chunks_exact(4).map(|part| f64::from(i32::from_le_bytes(fixed(part)))).collect(),
        _ => return Err(wrong()),
    };
    if rows.checked_mul(2) != Some(values.len()) {
        return Err(format!("it has {} numbers instead of {rows} x 2", values.len()));
    }
    if !values.iter().all(|value| COORDINATE_M.contains(value)) {
        return Err("it has a number that is not finite or is beyond a million".into());
    }
    Ok(values.chunks_exact(2).map(|pair| dvec2(pair[0], pair[1])).collect())
}

/// The header, a Python dict, and the data after it.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let (&[major, _], rest) = rest.split_first_chunk::<2>()?;
    let (length, rest) = if major == 1 {
        let (&length, rest) = rest.split_first_chunk::<2>()?;
        (usize::from(u16::from_le_bytes(length)), rest)
    } else {
        let (&length, rest) = rest.split_first_chunk::<4>()?;
        (u32::from_le_bytes(length) as usize, rest)
    };
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

fn between<'a>(text: &'a str, start: &str, end: &str) -> Option<&'a str> {
    Some(text.split_once(start)?.1.split_once(end)?.0.trim())
}

/// `part`, which has N bytes, as an array.
fn fixed<const N: usize>(part: &[u8]) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(part);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, values: &[i64]) -> Vec<u8> {
        let head =
            [&b"\x93NUMPY\x01\0"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
        head.into_iter().chain(values.iter().flat_map(|value| value.to_le_bytes())).collect()
    }

    #[test]
    fn rows_of_two_numbers_are_read_and_everything_else_is_rejected() {
        let header = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }\n";
        assert_eq!(points(&file(header, &[1, 2, 3, -4])), Ok(vec![dvec2(1.0, 2.0), dvec2(3.0, -4.0)]));
        for (bytes, expected) in [
            (file(header, &[1, 2, 3]), "it has 3 numbers instead of 2 x 2"),
            (file(header, &[1, 2, 3, i64::MAX]), "it has a number that is not finite or is beyond a million"),
            (file(&header.replace("False", "True"), &[1, 2, 3, 4]), "not an array of n x 2 numbers"),
            (
                file(&header.replace("<i8", "<f4\u{1b}"), &[1, 2, 3, 4]),
                "not an array of n x 2 numbers (int64, int32 or float64) in C order: {'descr': '<f4\\u{1b}', ",
            ),
            (file(&header.replace("(2, 2)", "(99999999999999999999, 2)"), &[]), "not an array"),
            (b"\x93NUMPY\x01\0\xff\xff{}".to_vec(), "not a .npy file"),
            (b"PK\x03\x04".to_vec(), "not a .npy file"),
        ] {
            let error = points(&bytes).expect_err("invalid");
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
