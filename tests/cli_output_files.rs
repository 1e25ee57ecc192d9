//! Tests of output files that the user names: links, permissions and owners are kept, read-only files are refused, and a failure
//! leaves the old file.
#![cfg(target_os = "linux")]

mod cli_support;
#[path = "support/requirements.rs"]
mod requirements;
#[path = "support/small_disk.rs"]
mod small_disk;

use std::fs::{self, Permissions};
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, chown, symlink};
use std::path::Path;

use cli_support::{Workspace, quick_fast};
use small_disk::{can_mount, fill_disk, with_small_disk};

/// The permissions of a file.
fn mode(path: &Path) -> u32 {
    path.metadata().unwrap().mode() & 0o7777
}

fn set_mode(path: &Path, mode: u32) {
    fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
}

fn is_svg(bytes: &[u8]) -> bool {
    bytes.starts_with(b"<svg") && bytes.trim_ascii_end().ends_with(b"</svg>")
}

#[test]
fn a_link_stays_a_link_and_the_file_behind_it_is_replaced() {
    let workspace = Workspace::new();
    fs::create_dir(workspace.path("store")).unwrap();
    workspace.write("store/real.svg", "old");
    // A link, a link to a link, and a link to a file that does not exist yet.
    for (link, destination) in
        [("link.svg", "store/real.svg"), ("chain.svg", "link.svg"), ("dangling.svg", "store/new.svg")]
    {
        symlink(destination, workspace.path(link)).unwrap();
        workspace.run_ok(&format!("--draw {link}"));
        assert_eq!(fs::read_link(workspace.path(link)).unwrap(), Path::new(destination), "{link}");
        let behind = if link == "dangling.svg" { "store/new.svg" } else { "store/real.svg" };
        assert!(is_svg(&workspace.read(behind)), "{link}");
        workspace.write(behind, "old");
    }
    let left: Vec<_> = fs::read_dir(workspace.path("store")).unwrap().collect();
    assert_eq!(left.len(), 2, "no temporary file is left: {left:?}");
}

#[test]
fn a_replaced_file_keeps_its_permissions_owner_and_group() {
    let workspace = Workspace::new();
    let file = workspace.path("map.svg");
    workspace.write("map.svg", "old");
    // Only root can give a file to another user; for others the test is that the owner stays the same.
    let _ = chown(&file, Some(65_534), Some(65_534));
    let before = file.metadata().unwrap();
    for permissions in [0o600, 0o640, 0o664, 0o606, 0o755] {
        set_mode(&file, permissions);
        workspace.run_ok("--draw map.svg");
        assert!(is_svg(&workspace.read("map.svg")));
        let after = file.metadata().unwrap();
        assert_eq!(mode(&file), permissions, "{:o} instead of {permissions:o}", mode(&file));
        assert_eq!((after.uid(), after.gid()), (before.uid(), before.gid()));
    }
}

#[test]
fn new_files_have_the_permissions_that_the_umask_leaves() {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    for (umask, file_mode, folder_mode) in
        [("077", 0o600, 0o700), ("002", 0o664, 0o775), ("022", 0o644, 0o755)]
    {
        let done = workspace.shell(&format!(
            "umask {umask}; mkdir {umask}; cd {umask}; $WAYFIELD --draw map.svg; $WAYFIELD --train --preset ../quick.ron --steps 16 --out run"
        ));
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        let mut paths = vec![workspace.path(&format!("{umask}/map.svg"))];
        for folder in ["run", "run/checkpoint"] {
            let folder = workspace.path(&format!("{umask}/{folder}"));
            assert_eq!(mode(&folder), folder_mode, "{}", folder.display());
            let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
            paths.extend(entries.filter(|path| path.is_file()));
        }
        assert!(paths.len() > 9, "{paths:?}");
        for path in paths {
            assert_eq!(mode(&path), file_mode, "umask {umask}: {} has {:o}", path.display(), mode(&path));
        }
    }
}

#[test]
fn a_new_file_in_a_setgid_folder_gets_the_group_of_the_folder() {
    let workspace = Workspace::new();
    let folder = workspace.path("shared");
    fs::create_dir(&folder).unwrap();
    let _ = chown(&folder, None, Some(65_534));
    set_mode(&folder, 0o2775);
    workspace.run_ok("--draw shared/map.svg");
    assert_eq!(folder.join("map.svg").metadata().unwrap().gid(), folder.metadata().unwrap().gid());
}

/// A backup often shares files with the original through hard links. It must not change when the original is replaced.
#[test]
fn another_hard_link_keeps_the_old_contents() {
    let workspace = Workspace::new();
    workspace.write("map.svg", "old");
    fs::hard_link(workspace.path("map.svg"), workspace.path("backup.svg")).unwrap();
    workspace.run_ok("--draw map.svg");
    assert!(is_svg(&workspace.read("map.svg")));
    assert_eq!(workspace.text("backup.svg"), "old");
}

#[test]
fn a_read_only_file_is_refused_before_any_work_even_for_root() {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    workspace.run_ok("--train --preset quick.ron --steps 16 --out run");
    workspace.write("map.svg", "old");
    symlink("map.svg", workspace.path("link.svg")).unwrap();
    for file in ["map.svg", "run/policy.safetensors", "run/learning-curve.svg", "run/episodes.csv"] {
        set_mode(&workspace.path(file), 0o444);
        let commands = match file {
            "map.svg" => vec!["--draw map.svg", "--draw link.svg"],
            _ => vec!["--train --resume run --steps 5000"],
        };
        for command in commands {
            let message = cli_support::messages::rejection(&workspace, command);
            assert!(message.contains("can't be written: the file is read-only; help: "), "{message}");
            assert!(message.contains(file) || command.contains("link"), "{message}");
        }
        assert_eq!(mode(&workspace.path(file)), 0o444);
        set_mode(&workspace.path(file), 0o644);
    }
    workspace.run_ok("--train --resume run --steps 5000");
}

#[test]
fn devices_pipes_and_standard_output_are_written_directly() {
    let workspace = Workspace::new();
    workspace.run_ok("--draw expected.svg");
    let expected = workspace.read("expected.svg");

    let printed = workspace.run_ok("--draw /dev/stdout");
    assert!(printed.stdout.as_bytes() == expected, "nothing but the figure is on stdout: {}", printed.stdout);
    let done = workspace.shell(
        "$WAYFIELD --draw /dev/stdout >redirected; echo before >appended; $WAYFIELD --draw /dev/stdout >>appended; \
         $WAYFIELD --draw /proc/self/fd/3 3>descriptor; $WAYFIELD --draw /dev/stdout | cat >piped; \
         ln -s /dev/stdout link.svg; $WAYFIELD --draw link.svg >linked; $WAYFIELD --draw /dev/stdout | head -c 5 >part",
    );
    assert_eq!((done.status, done.stdout.as_str(), done.stderr.as_str()), (Some(0), "", ""));
    for name in ["redirected", "descriptor", "piped", "linked"] {
        assert!(workspace.read(name) == expected, "{name}: {}", workspace.text(name));
    }
    assert!(workspace.read("appended") == [b"before\n", &expected[..]].concat());
    assert_eq!(workspace.read("part"), expected[..5]);
    assert!(fs::symlink_metadata(workspace.path("link.svg")).unwrap().is_symlink());

    let done = workspace.shell("mkfifo pipe.svg; cat pipe.svg >read & $WAYFIELD --draw pipe.svg; wait");
    assert_eq!((done.status, done.stderr.as_str()), (Some(0), ""));
    assert!(workspace.read("read") == expected);
    assert!(fs::metadata(workspace.path("pipe.svg")).unwrap().file_type().is_fifo());

    workspace.run_ok("--draw /dev/null");
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let full = workspace.run("--draw /dev/full");
    assert_eq!(full.status, Some(1));
    assert_eq!(full.stderr, "error: /dev/full: can't be written: No space left on device (os error 28)\n");
}

/// Width and height in the head of a PNG file.
fn png_size(bytes: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
fn an_image_has_the_format_of_its_name_and_the_size_that_is_asked_for() {
    let workspace = Workspace::new();
    for (arguments, size) in
        [("--plain", [480, 360]), ("--size 300x500", [300, 500]), ("--plain --size 64x32", [64, 32])]
    {
        workspace.run_ok(&format!("--draw map.png --scenario hall {arguments}"));
        assert_eq!(png_size(&workspace.read("map.png")), size, "{arguments}");
    }
    workspace.run_ok("--draw map.png --scenario hall");
    assert_eq!(png_size(&workspace.read("map.png"))[0], 2560, "large enough for print");
    workspace.run_ok("--draw map.pdf --scenario hall --size 1920x1080");
    let pdf = String::from_utf8_lossy(&workspace.read("map.pdf")).into_owned();
    assert!(pdf.starts_with("%PDF-") && pdf.trim_end().ends_with("%%EOF"));
    assert!(pdf.contains("/MediaBox [0 0 1440 810]"), "96 pixels are an inch, 72 points");
    for size in ["0x10", "10", "9000x9000", "axb", "-5x20"] {
        let done = workspace.run(&format!("--draw map.png --size={size}"));
        assert_eq!(done.status, Some(2), "{size}: {}", done.stderr);
        assert!(done.stderr.contains("give width and height, 16x16 to 8192x8192"), "{size}: {}", done.stderr);
    }
}

#[test]
fn an_image_of_a_scenario_has_its_name_a_legend_and_a_scale() {
    let workspace = Workspace::new();
    workspace.run_ok("--draw map.svg --scenario hall");
    let labels = ["Hall", "start", "goal", "moving obstacle on its path", "x and y in m"];
    let svg = workspace.text("map.svg");
    for label in labels {
        assert!(svg.lines().any(|line| line == label), "`{label}` is not in\n{svg}");
    }
    workspace.run_ok("--draw map.svg --scenario hall --plain");
    assert!(!workspace.text("map.svg").contains("<text"), "only the image");
    workspace.run_ok("--draw level.svg --scenario clutter --seed 5 --plain");
    workspace.run_ok("--draw same.svg --scenario clutter:5 --plain");
    assert!(workspace.read("level.svg") == workspace.read("same.svg"), "--seed selects the level");
}

#[test]
fn symlink_loops_and_names_that_are_too_long_are_reported() {
    let workspace = Workspace::new();
    let long = format!("{}.svg", "x".repeat(252));
    symlink("b.svg", workspace.path("a.svg")).unwrap();
    symlink("a.svg", workspace.path("b.svg")).unwrap();
    for (file, expected) in
        [("a.svg", "Too many levels of symbolic links"), (long.as_str(), "File name too long")]
    {
        let done = workspace.run(&format!("--draw {file}"));
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""));
        assert!(
            done.stderr.starts_with(&format!("error: {file}: can't be written: {expected}")),
            "{}",
            done.stderr
        );
    }
    // The longest possible name works.
    workspace.run_ok(&format!("--draw {}.svg", "x".repeat(251)));
}

#[test]
fn a_name_with_a_trailing_slash_is_refused_before_any_work() {
    let workspace = Workspace::new();
    let message = cli_support::messages::rejection(&workspace, "--draw new.svg/");
    let expected = "new.svg/: can't be written: this is the name of a folder; help: give the name of a file";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn a_full_disk_or_a_read_only_one_leaves_the_old_file() {
    if !can_mount() {
        return;
    }
    let workspace = Workspace::new();
    let draw = "s=0; $WAYFIELD --draw small/map.svg 2>log || s=$?; echo $s; cat small/map.svg; ls -A small";
    let full = with_small_disk(
        &workspace,
        "size=64k",
        &format!("echo old >small/map.svg; {}; {draw}", fill_disk(0)),
    );
    assert_eq!(full.stdout, "1\nold\nfill\nmap.svg\n", "{}", full.stderr);
    assert!(
        workspace.text("log").contains("error: small/map.svg: can't be written: No space left on device")
    );
    let remount = "mount -o remount,ro small";
    let read_only =
        with_small_disk(&workspace, "size=64k", &format!("echo old >small/map.svg; {remount}; {draw}"));
    assert_eq!(read_only.stdout, "2\nold\nmap.svg\n", "{}", read_only.stderr);
    let log = workspace.text("log");
    let expected = "error: small/map.svg: can't be written: Read-only file system";
    assert!(log.starts_with(expected), "{log}");
}
