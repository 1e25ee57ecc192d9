//! Checkpoints of a learner, from which it continues exactly as if it had never stopped.
//!
//! In: a learner and a writer, or a reader and the config of the saved learner. Out: bytes, or a learner.
//!
//! Layout, little-endian: a header ([`HeaderFormat`] without checksum), the arrays of the replay buffer (states, transitions,
//! leaves of the sum tree), and the CRC-32C of everything before it. The header holds the config (`checkpoint/config.rs`),
//! sizes, counters with the random stream, weights, optimizer moments, trajectories, positions in the replay buffer, and with
//! mirror augmentation its random stream.
//!
//! The lengths of the arrays follow from the config and the counters, and are checked before memory is allocated. The
//! checksum detects accidental damage only, so every value is also checked before the learner uses it.

mod arrays;
mod checksum;
mod config;
mod header;

use std::io::{self, Read, Write};
use std::ops::RangeInclusive;

use wayfield_random::Stream;

use self::arrays::write_array;
use self::checksum::ChecksummedStream;
use self::header::Header;
use super::config::{ConfigError, LearningConfig};
use super::framing::{HeaderError, HeaderFormat, decode, encode, read_array};
use super::learner::Learner;
use super::limits::MAX_HEADER_BYTES;

/// The versions of the file that can be read.
const VERSIONS: RangeInclusive<u32> = 1..=5;

/// The header format of a file of this `version`.
const fn format(version: u32) -> HeaderFormat {
    HeaderFormat { magic: b"wayfield", version, max_bytes: MAX_HEADER_BYTES, checksum: false }
}

/// An error from writing or reading a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file could not be written or read, or ends too early.
    #[error("checkpoint: {0}")]
    Io(#[from] io::Error),
    /// The file is not a checkpoint.
    #[error("not a wayfield checkpoint")]
    NotCheckpoint,
    /// The file has a format version that this wayfield does not read.
    #[error(
        "checkpoint version {found} is not supported; this wayfield reads versions {} to {}",
        VERSIONS.start(),
        VERSIONS.end()
    )]
    Version {
        /// The file's version.
        found: u32,
    },
    /// The saved learner has a different config.
    #[error("the checkpoint's `{field}` differs from the config's; help: resume with the original config")]
    ConfigMismatch {
        /// The part of the config that differs.
        field: &'static str,
    },
    /// The file contains invalid values.
    #[error("the checkpoint is damaged: {0}")]
    Corrupt(&'static str),
    /// The given config is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

impl From<HeaderError> for CheckpointError {
    fn from(error: HeaderError) -> Self {
        match error {
            HeaderError::Io(error) => Self::Io(error),
            HeaderError::WrongMagic => Self::NotCheckpoint,
            // The config determines the version, so another valid version belongs to another config.
            HeaderError::Version { found } if VERSIONS.contains(&found) => {
                Self::ConfigMismatch { field: "learning" }
            }
            HeaderError::Version { found } => Self::Version { found },
            HeaderError::Corrupt(what) => Self::Corrupt(what),
        }
    }
}

impl Learner {
    /// Writes the whole learner: networks, optimizer moments, replay buffer with priorities, trajectories, counters and random
    /// streams.
    ///
    /// # Errors
    /// The writer failed.
    pub fn save(&self, writer: impl Write) -> Result<(), CheckpointError> {
        let replay = &self.replay;
        let mut out = ChecksummedStream::new(writer);
        let (version, mut content) = config::encoded(&self.config)?;
        content.extend(encode(&Header::of(self))?);
        if let Some(stream) = &self.mirror_stream {
            content.extend(encode(stream)?);
        }
        format(version).write_content(&mut out, &content)?;
        let states = &replay.states.values[..replay.states.used() * self.online.shape().inputs];
        write_array(&mut out, states.iter().map(|v| v.to_le_bytes()))?;
        write_array(&mut out, replay.transitions.iter().map(|t| t.to_bytes()))?;
        let leaves = (0..replay.transitions.len()).map(|slot| replay.priority(slot).to_le_bytes());
        write_array(&mut out, leaves)?;
        let (mut writer, crc) = out.into_parts();
        writer.write_all(&crc.to_le_bytes())?;
        writer.flush()?;
        Ok(())
    }

    /// Reads a learner that [`Learner::save`] wrote. The config and the sizes must be those of the saved learner: `inputs` values
    /// per observation, `actions` actions and `num_envs` environments. The mirror is not saved: set it as after [`Learner::new`],
    /// with [`Learner::set_mirror`].
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or belongs to another config. No input makes this panic.
    pub fn restore(
        config: &LearningConfig,
        inputs: usize,
        actions: usize,
        num_envs: usize,
        reader: impl Read,
    ) -> Result<Self, CheckpointError> {
        let mut learner = Self::new(config, inputs, actions, num_envs, 0)?;
        let mut file = ChecksummedStream::new(reader);
        let (version, config) = config::encoded(config)?;
        let content = format(version).read_content(&mut file)?;
        let content = content.strip_prefix(&config[..]);
        let content = content.ok_or(CheckpointError::ConfigMismatch { field: "learning" })?;
        let (header, mirror_stream) = if learner.mirror_stream.is_some() {
            let (header, stream): (Header, Stream) = decode(content)?;
            (header, Some(stream))
        } else {
            (decode::<Header>(content)?, None)
        };
        header.check(&learner)?;
        if !mirror_stream.as_ref().is_none_or(wayfield_random::is_valid) {
            return Err(CheckpointError::Corrupt("the state of its mirror's random stream is invalid"));
        }
        learner.replay.read(&header, inputs, actions, &mut file)?;
        let (reader, crc) = file.into_parts();
        if crc != u32::from_le_bytes(read_array(reader)?) {
            return Err(CheckpointError::Corrupt("its checksum does not match"));
        }
        header.apply_to(&mut learner);
        learner.mirror_stream = mirror_stream;
        Ok(learner)
    }
}

#[cfg(test)]
mod tests;
