//! Files that are either whole or not there.

use crate::error::ExchangeError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Bytes gathered before each system call.
const BUFFER: usize = 1 << 16;

/// Writes a file so that a failure leaves what was there before: to a temporary file in the same directory, which is
/// forced to the disk and then takes the name. A symbolic link is followed; the permissions of an old file are kept.
///
/// # Errors
/// [`ExchangeError::NoDirectory`], [`ExchangeError::NotADirectory`], [`ExchangeError::NotAFile`] or [`ExchangeError::Io`]; errors of `fill` arrive as
/// the last. No temporary file remains.
pub fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<T>,
) -> Result<T, ExchangeError> {
    let Target {
        file,
        directory,
        old,
    } = target(path)?;
    let io = |action| failed(path, action);
    let mut temporary = temporary(path, &directory)?;
    let mut out = BufWriter::with_capacity(BUFFER, temporary.as_file_mut());
    let result = fill(&mut out)
        .and_then(|r| out.flush().map(|()| r))
        .map_err(io("write"))?;
    drop(out);
    if let Some(meta) = old {
        temporary
            .as_file()
            .set_permissions(meta.permissions())
            .map_err(io("keep the permissions"))?;
    }
    temporary
        .as_file()
        .sync_all()
        .map_err(io("write to the disk"))?;
    temporary
        .persist(&file)
        .map_err(|e| io("replace the file")(e.error))?;
    sync_directory(&directory);
    Ok(result)
}

/// Says before the work is done what would keep a file from being written: a directory that does not exist or cannot be
/// written to, or a path that is no file. Nothing is changed.
///
/// # Errors
/// Those of [`write_atomically`].
pub fn check_target(path: &Path) -> Result<(), ExchangeError> {
    temporary(path, &target(path)?.directory).map(drop)
}

/// Where a file will be.
struct Target {
    /// The file itself, behind any symbolic links.
    file: PathBuf,
    directory: PathBuf,
    /// What is there now.
    old: Option<fs::Metadata>,
}

fn target(path: &Path) -> Result<Target, ExchangeError> {
    let old = fs::metadata(path).ok();
    if let Some(meta) = &old
        && !meta.is_file()
    {
        let what = if meta.is_dir() {
            "a directory"
        } else {
            "a device or pipe"
        };
        return Err(ExchangeError::NotAFile {
            path: path.to_owned(),
            what,
        });
    }
    let file = if old.is_some() {
        fs::canonicalize(path).map_err(failed(path, "resolve the path"))?
    } else {
        path.to_owned()
    };
    let directory = directory_of(&file);
    // The nearest part of the path that is there at all.
    let there = directory.ancestors().find(|d| d.exists());
    if let Some(there) = there.filter(|d| !d.is_dir()) {
        return Err(ExchangeError::NotADirectory {
            path: path.to_owned(),
            directory: there.to_owned(),
        });
    }
    if !directory.is_dir() {
        return Err(ExchangeError::NoDirectory {
            path: path.to_owned(),
            directory,
        });
    }
    Ok(Target {
        file,
        directory,
        old,
    })
}

fn temporary(path: &Path, directory: &Path) -> Result<tempfile::NamedTempFile, ExchangeError> {
    builder().tempfile_in(directory).map_err(|e| {
        // The reason without the name of the temporary file, which tells nobody anything.
        let e = io::Error::from(e.kind());
        failed(path, "create a file in the directory (is it writable?)")(e)
    })
}

fn failed(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> ExchangeError {
    move |source| ExchangeError::Io {
        path: path.to_owned(),
        action,
        source,
    }
}

fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(unix)]
fn builder() -> tempfile::Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt;
    let mut builder = tempfile::Builder::new();
    // As any new file: the system takes the user's mask off. The crate's default would let nobody else read it.
    builder
        .prefix(".nappe-")
        .suffix(".tmp")
        .permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".nappe-").suffix(".tmp");
    builder
}

/// Makes the new name last through a power cut. Not all file systems can; the file itself is safe either way.
fn sync_directory(directory: &Path) {
    if let Ok(d) = File::open(directory) {
        let _ = d.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(dir: &Path) -> Vec<String> {
        let mut n: Vec<_> = fs::read_dir(dir)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        n.sort();
        n
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.stl");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let e = write_atomically(&path, |w| -> io::Result<()> {
            w.write_all(&vec![7; 3 * BUFFER])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(
            matches!(&e, ExchangeError::Io { path: p, .. } if *p == path),
            "{e}"
        );
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(dir.path()), ["a.stl"]);
        write_atomically(&path, |w| w.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn a_check_finds_what_writing_would_and_changes_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.stl");
        check_target(&path).unwrap();
        assert!(names(dir.path()).is_empty());
        fs::write(&path, "old").unwrap();
        check_target(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        for bad in [dir.path().to_owned(), dir.path().join("none/a.stl")] {
            let (a, b) = (
                check_target(&bad).unwrap_err(),
                write_atomically(&bad, |_| Ok(())).unwrap_err(),
            );
            assert_eq!(a.to_string(), b.to_string());
        }
    }

    #[test]
    fn a_missing_directory_and_a_directory_as_target_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let missing = dir.path().join("none");
        let e = write_atomically(&missing.join("a.stl"), |_| Ok(())).unwrap_err();
        assert!(
            matches!(&e, ExchangeError::NoDirectory { directory, .. } if *directory == missing),
            "{e}"
        );
        let e = write_atomically(dir.path(), |_| Ok(())).unwrap_err();
        assert!(
            matches!(
                e,
                ExchangeError::NotAFile {
                    what: "a directory",
                    ..
                }
            ),
            "{e}"
        );
        assert!(names(dir.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let (path, link) = (dir.path().join("a"), dir.path().join("b"));
        write_atomically(&path, |_| Ok(())).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomically(&link, |w| w.write_all(b"x")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"x");
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o640
        );
    }
}
