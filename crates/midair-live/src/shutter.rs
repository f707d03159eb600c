//! A command that photographs what the display shows.

use std::process::{Command, Stdio};

/// What a command is told of the picture that it photographs: its name, without a file's ending.
const NAME: &str = "MIDAIR_PATTERN";

/// Runs a command line by the system's shell on a thread of its own, with a picture's name in its environment. `done` is told whether it ended well, and
/// else why not. What the command writes goes to standard error: standard output is ours.
pub fn release(
    command: &str,
    picture: &str,
    done: impl FnOnce(Result<(), String>) + Send + 'static,
) {
    let mut shell = if cfg!(windows) { Command::new("cmd") } else { Command::new("sh") };
    shell.arg(if cfg!(windows) { "/C" } else { "-c" }).arg(command).env(NAME, picture);
    shell.stdin(Stdio::null()).stdout(std::io::stderr());
    let command = command.to_owned();
    std::thread::spawn(move || {
        done(match shell.status() {
            Ok(status) if status.success() => Ok(()),
            // "exit status: 1", or which signal ended it.
            Ok(status) => Err(format!("`{command}` ended with {status}")),
            Err(error) => Err(format!("`{command}` cannot be run: {error}")),
        });
    });
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn the_shell_runs_it_and_its_end_is_told() {
        let ends = |command: &str| {
            let (tell, told) = channel();
            release(command, "07-gray-s-4", move |end| drop(tell.send(end)));
            told.recv().expect("it is told")
        };
        assert_eq!(ends("test \"$MIDAIR_PATTERN\" = 07-gray-s-4"), Ok(()));
        let why = ends("sh -c 'exit 3'").unwrap_err();
        assert!(why.contains("sh -c 'exit 3'") && why.contains("exit status: 3"), "{why}");
        let why = ends("no-such-camera --shoot 2>/dev/null").unwrap_err();
        assert!(why.contains("exit status: 127"), "{why}");
    }
}
