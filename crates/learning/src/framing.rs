//! The header of a binary file: magic, version, length, an optional checksum, and the content.
//!
//! Layout, little-endian: magic (8 bytes), version (u32), length of the content (u64), CRC-32C of the content (u32, only
//! with [`HeaderFormat::checksum`]), the content (postcard). The learner's checkpoint and the run's checkpoint both start
//! with such a header.

use std::io::{self, ErrorKind, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The header of one kind of file.
#[derive(Debug, Clone, Copy)]
pub struct HeaderFormat {
    /// The first bytes of the file, which identify its kind.
    pub magic: &'static [u8; 8],
    /// The version of the file's layout. Readers accept only their own.
    pub version: u32,
    /// The maximum length of the content that a reader accepts, in bytes.
    pub max_bytes: u64,
    /// Whether a CRC-32C of the content is written before it.
    pub checksum: bool,
}

/// An error from reading a header.
#[derive(Debug, thiserror::Error)]
pub enum HeaderError {
    /// The reader failed, or the file ends inside the header.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is of another kind.
    #[error("wrong magic bytes")]
    WrongMagic,
    /// The file has another version.
    #[error("version {found} is not supported")]
    Version {
        /// The file's version.
        found: u32,
    },
    /// The content is damaged.
    #[error("{0}")]
    Corrupt(&'static str),
}

impl HeaderFormat {
    /// Writes the header with `content`.
    ///
    /// # Errors
    /// The writer failed.
    pub fn write(&self, out: impl Write, content: &impl Serialize) -> io::Result<()> {
        self.write_content(out, &encode(content)?)
    }

    /// Writes the header with `content`, which is already encoded.
    pub(crate) fn write_content(&self, mut out: impl Write, content: &[u8]) -> io::Result<()> {
        out.write_all(self.magic)?;
        out.write_all(&self.version.to_le_bytes())?;
        out.write_all(&(content.len() as u64).to_le_bytes())?;
        if self.checksum {
            out.write_all(&crc32c::crc32c(content).to_le_bytes())?;
        }
        out.write_all(content)
    }

    /// Reads the header, and returns its content.
    ///
    /// # Errors
    /// See [`HeaderError`].
    pub fn read<T: DeserializeOwned>(&self, file: impl Read) -> Result<T, HeaderError> {
        decode(&self.read_content(file)?)
    }

    /// Reads the header, and returns its content, still encoded.
    pub(crate) fn read_content(&self, mut file: impl Read) -> Result<Vec<u8>, HeaderError> {
        if &read_array(&mut file)? != self.magic {
            return Err(HeaderError::WrongMagic);
        }
        let found = u32::from_le_bytes(read_array(&mut file)?);
        if found != self.version {
            return Err(HeaderError::Version { found });
        }
        let length = u64::from_le_bytes(read_array(&mut file)?);
        let crc = if self.checksum { Some(u32::from_le_bytes(read_array(&mut file)?)) } else { None };
        if length > self.max_bytes {
            return Err(HeaderError::Corrupt("its header is too long"));
        }
        // `read_to_end` allocates as bytes arrive, so a wrong length does not reserve memory.
        let mut content = Vec::new();
        file.take(length).read_to_end(&mut content)?;
        if content.len() as u64 != length {
            return Err(HeaderError::Io(ErrorKind::UnexpectedEof.into()));
        }
        if crc.is_some_and(|crc| crc != crc32c::crc32c(&content)) {
            return Err(HeaderError::Corrupt("the checksum of its header does not match"));
        }
        Ok(content)
    }
}

/// Encodes the content of a header.
pub(crate) fn encode(content: &impl Serialize) -> io::Result<Vec<u8>> {
    postcard::to_allocvec(content).map_err(io::Error::other)
}

/// Decodes the content of a header.
pub(crate) fn decode<T: DeserializeOwned>(content: &[u8]) -> Result<T, HeaderError> {
    postcard::from_bytes(content).map_err(|_| HeaderError::Corrupt("its header cannot be decoded"))
}

/// Reads the next `N` bytes.
pub(crate) fn read_array<const N: usize>(mut file: impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMAT: HeaderFormat =
        HeaderFormat { magic: b"testfile", version: 3, max_bytes: 16, checksum: true };

    fn written(format: &HeaderFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        format.write(&mut bytes, &(7_u8, 300_u16)).expect("memory can be written");
        bytes
    }

    fn read(bytes: &[u8]) -> Result<(u8, u16), HeaderError> {
        FORMAT.read(bytes)
    }

    #[test]
    fn a_header_is_read_as_it_was_written() {
        let bytes = written(&FORMAT);
        assert_eq!(bytes.len(), 8 + 4 + 8 + 4 + 3);
        assert_eq!(bytes[..20], *b"testfile\x03\0\0\0\x03\0\0\0\0\0\0\0");
        assert_eq!(read(&bytes).expect("a valid header"), (7, 300));
        let plain = HeaderFormat { checksum: false, ..FORMAT };
        assert_eq!(written(&plain).len(), bytes.len() - 4);
        assert_eq!(plain.read::<(u8, u16)>(&written(&plain)[..]).expect("a valid header"), (7, 300));
    }

    #[test]
    fn every_kind_of_damage_is_an_error() {
        let bytes = written(&FORMAT);
        for length in 0..bytes.len() {
            assert!(matches!(read(&bytes[..length]), Err(HeaderError::Io(_))), "{length} bytes");
        }
        assert!(matches!(read(b"something else"), Err(HeaderError::WrongMagic)));
        for (at, damage) in [(8, "version"), (19, "too long"), (20, "checksum"), (26, "checksum")] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x55;
            let error = read(&damaged).expect_err(damage).to_string();
            assert!(error.contains(damage), "byte {at}: {error}");
        }
    }
}
