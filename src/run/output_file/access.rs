//! Permissions, owner and group of written files.

use std::fs::{File, Metadata};
use std::io;
use std::path::Path;

/// Creates a file with the default permissions, without those that the file `replaced` lacks: a private file must not be
/// readable by others, not even for a moment. The group gets no permissions before [`copy`], because the new file may
/// belong to another group than the replaced one.
#[cfg(unix)]
pub fn create(path: &Path, replaced: Option<&Metadata>) -> io::Result<File> {
    use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
    let mode = replaced.map_or(0o666, |file| file.mode() & 0o606);
    File::options().read(true).write(true).create_new(true).mode(mode).open(path)
}

/// Gives the file `to` the permissions of the file that it replaces and, where the system permits it, its owner and group.
#[cfg(unix)]
pub fn copy(from: &Metadata, to: &File) -> io::Result<()> {
    use std::fs::Permissions;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let new = to.metadata()?;
    if new.uid() != from.uid() {
        // Only root may give a file away.
        let _ = fchown(to, Some(from.uid()), None);
    }
    let same_group = new.gid() == from.gid() || fchown(to, None, Some(from.gid())).is_ok();
    // Permissions for one group must not pass to another.
    let mode = from.mode() & if same_group { 0o777 } else { 0o707 };
    if new.mode() & 0o777 != mode {
        // File systems without permissions, such as FAT, refuse this. The file then keeps their default permissions.
        let _ = to.set_permissions(Permissions::from_mode(mode));
    }
    Ok(())
}

#[cfg(not(unix))]
pub fn create(path: &Path, _: Option<&Metadata>) -> io::Result<File> {
    File::options().read(true).write(true).create_new(true).open(path)
}

#[cfg(not(unix))]
pub fn copy(_: &Metadata, _: &File) -> io::Result<()> {
    Ok(())
}
