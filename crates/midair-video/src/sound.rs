//! A film's sound, by ffplay as a sub-process.

use super::tool::{VideoError, file_argument, not_started};
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Sound that is being played; it ends when this is dropped.
#[derive(Debug)]
pub struct Sound(Child);

impl Sound {
    /// Plays a film's sound from so many seconds after its beginning on, once.
    ///
    /// ffplay opens the sound device by itself, which takes it a few tenths of a second: lips do not quite move with the words.
    ///
    /// # Errors
    /// [`VideoError::Missing`] where there is no ffplay.
    pub fn play(path: &Path, from: f64) -> Result<Self, VideoError> {
        Self::by("ffplay".as_ref(), path, from)
    }

    /// By a program that takes ffplay's options.
    fn by(program: &OsStr, path: &Path, from: f64) -> Result<Self, VideoError> {
        let mut command = Command::new(program);
        command.args(["-nodisp", "-vn", "-autoexit", "-loglevel", "quiet", "-ss"]);
        command.arg(format!("{:.3}", from.max(0.0)));
        command.arg("-i").arg(file_argument(path));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().map(Self).map_err(|error| not_started("ffplay", path, error))
    }
}

impl Drop for Sound {
    fn drop(&mut self) {
        // It may have come to its end by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt as _;
    use std::time::{Duration, Instant};

    /// A program in ffplay's place that notes what it is asked for, and plays for a minute.
    #[test]
    fn sound_begins_where_it_is_asked_to_and_ends_when_it_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let (player, asked) = (folder.path().join("player"), folder.path().join("asked"));
        let script = format!(
            "#!/bin/sh\necho $$ \"$@\" > {0}.new\nmv {0}.new {0}\nexec sleep 60\n",
            asked.display()
        );
        std::fs::write(&player, script).unwrap();
        std::fs::set_permissions(&player, std::fs::Permissions::from_mode(0o755)).unwrap();
        let sound = Sound::by(player.as_ref(), "-a film.mp4".as_ref(), 12.5).unwrap();
        let start = Instant::now();
        while !asked.exists() && start.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(10));
        }
        let said = std::fs::read_to_string(&asked).unwrap();
        assert!(said.contains("-ss 12.500 -i file:-a film.mp4"), "{said}");
        let process = said.split(' ').next().unwrap().to_owned();
        let runs = || std::path::Path::new("/proc").join(&process).join("stat").exists();
        // Without /proc there is nothing to be seen.
        assert!(runs() || !std::path::Path::new("/proc/self/stat").exists());
        drop(sound);
        assert!(!runs());
        let missing = Sound::by("no-such-player".as_ref(), "a.mp4".as_ref(), 0.0).unwrap_err();
        assert!(matches!(missing, VideoError::Missing { .. }), "{missing}");
    }
}
