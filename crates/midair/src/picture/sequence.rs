//! Numbered stills: `frames/%04d.png`.

use super::FileError;
use std::path::{Path, PathBuf};

/// A pattern of file names with a frame's number in it, written as `%d` or, filled with zeros to a width, `%04d`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    folder: PathBuf,
    before: String,
    width: usize,
    after: String,
}

impl Sequence {
    /// The pattern that a path is; `None` if it holds no number.
    pub fn of_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        // Two of them stand for a percent sign, as ffmpeg has it.
        let at = name.match_indices('%').map(|(at, _)| at);
        let mut escaped = None;
        let at = at.filter(|&at| {
            let second = escaped == Some(at);
            escaped = (!second && name[at + 1..].starts_with('%')).then_some(at + 1);
            !second && escaped.is_none()
        });
        let at = at.collect::<Vec<_>>().first().copied()?;
        let (before, rest) = (&name[..at], &name[at + 1..]);
        let (width, after) = rest.split_once('d')?;
        let plain = |text: &str| text.replace("%%", "%");
        let (before, after) = (plain(before), plain(after));
        let width = match width {
            "" => 0,
            _ => width.strip_prefix('0')?.parse().ok().filter(|width| (1..=18).contains(width))?,
        };
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Some(Self { folder, before, width, after })
    }

    /// The folder that the files lie in.
    pub fn folder(&self) -> &Path {
        if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder }
    }

    /// The file of a frame.
    pub fn file(&self, number: u64) -> PathBuf {
        self.folder.join(format!(
            "{}{number:0width$}{}",
            self.before,
            self.after,
            width = self.width
        ))
    }

    /// The numbers of the files that there are, in order.
    ///
    /// # Errors
    /// [`FileError`] where the folder cannot be read, or holds no file of the pattern.
    pub fn numbers(&self) -> Result<Vec<u64>, FileError> {
        let read = |error| FileError::io(self.folder(), "read", error);
        let mut numbers = Vec::new();
        for entry in std::fs::read_dir(self.folder()).map_err(read)? {
            let name = entry.map_err(read)?.file_name();
            numbers.extend(name.to_str().and_then(|name| self.number(name)));
        }
        numbers.sort_unstable();
        if numbers.is_empty() {
            let pattern =
                self.folder.join(format!("{}%0{}d{}", self.before, self.width, self.after));
            let problem = "no file has a name of this pattern";
            return Err(FileError::unsupported(
                &pattern,
                problem,
                "name files such as frames/%04d.png",
            ));
        }
        Ok(numbers)
    }

    /// The number in a file's name.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let fits = digits.len() == self.width
            || digits.len() > self.width && !digits.starts_with('0')
            || digits == "0";
        (fits && digits.bytes().all(|byte| byte.is_ascii_digit())).then(|| digits.parse().ok())?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_told_from_names() {
        let sequence = Sequence::of_path(Path::new("a/f-%04d.png")).unwrap();
        assert_eq!(sequence.file(12), Path::new("a/f-0012.png"));
        assert_eq!(sequence.file(123_456), Path::new("a/f-123456.png"));
        assert_eq!(Sequence::of_path(Path::new("%d.exr")).unwrap().file(7), Path::new("7.exr"));
        let percent = Sequence::of_path(Path::new("100%%-%02d%%.png")).unwrap();
        assert_eq!(percent.file(7), Path::new("100%-07%.png"));
        for name in ["a.png", "100%.png", "100%%d.png", "%4d.png", "%x.png", "a/%s.png"] {
            assert!(Sequence::of_path(Path::new(name)).is_none(), "{name}");
        }
    }

    #[test]
    fn files_are_found_in_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in [
            "f003.png",
            "f010.png",
            "f001.png",
            "f1.png",
            "g002.png",
            "f12.png",
            "fxyz.png",
            "f1000.png",
        ] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let sequence = Sequence::of_path(&folder.path().join("f%03d.png")).unwrap();
        assert_eq!(sequence.numbers().unwrap(), [1, 3, 10, 1000]);
        let none = Sequence::of_path(&folder.path().join("h%03d.png")).unwrap();
        assert!(none.numbers().unwrap_err().to_string().contains("h%03d.png"));
    }
}
