//! A reader or writer that computes a checksum of everything that passes through.

use std::io::{self, Read, Write};

/// A stream with the CRC-32C of all bytes so far.
pub(super) struct ChecksummedStream<T> {
    inner: T,
    crc: u32,
}

impl<T> ChecksummedStream<T> {
    pub(super) fn new(inner: T) -> Self {
        Self { inner, crc: 0 }
    }

    /// The inner stream and the checksum.
    pub(super) fn into_parts(self) -> (T, u32) {
        (self.inner, self.crc)
    }
}

impl<T: Write> Write for ChecksummedStream<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.crc = crc32c::crc32c_append(self.crc, &bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for ChecksummedStream<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let n = self.inner.read(bytes)?;
        self.crc = crc32c::crc32c_append(self.crc, &bytes[..n]);
        Ok(n)
    }
}
