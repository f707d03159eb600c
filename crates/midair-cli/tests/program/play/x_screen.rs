//! A virtual screen, with keys and screenshots.

use super::*;

pub(super) const SIDE: usize = 240;

/// A screen of its own.
pub(super) struct XScreen {
    server: Child,
    name: String,
}

impl Drop for XScreen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl XScreen {
    pub(super) fn open() -> Option<Self> {
        if !midair_peers::screen() {
            return None;
        }
        // Without -noreset it begins anew when its last client leaves: when xwd has made the first shot, as the show may be about to connect.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "400x300x24", "-nolisten", "tcp"])
            .arg("-noreset")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Self { server, name: format!(":{}", number.trim()) })
    }

    pub(super) fn command(&self, bench: &Bench, arguments: &[&str]) -> Command {
        let mut command = bench.command(&[&["play"], arguments].concat());
        command
            .env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub(super) fn play(&self, bench: &Bench, arguments: &[&str]) -> Child {
        self.command(bench, arguments).spawn().unwrap()
    }

    /// The window's pixels, RGB: it stands at the screen's upper left.
    pub(super) fn shot(&self) -> Vec<u8> {
        let output = Command::new("xwd")
            .args(["-root", "-silent", "-display", &self.name])
            .output()
            .unwrap();
        pixels(&output.stdout)
    }

    /// Waits until the window shows this, within so many codes.
    pub(super) fn await_picture(&self, what: &str, expected: &[u8], tolerance: u8) {
        let start = Instant::now();
        loop {
            let shot = self.shot();
            let worst = shot.iter().zip(expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            if worst <= tolerance {
                return;
            }
            assert!(start.elapsed() < Duration::from_secs(30), "{what}: off by {worst}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until the window shows something, the same for half a second.
    pub(super) fn await_stillness(&self) -> Vec<u8> {
        self.await_change(&vec![0; 3 * SIDE * SIDE])
    }

    /// Waits until the window shows something else than this, the same for half a second.
    pub(super) fn await_change(&self, before: &[u8]) -> Vec<u8> {
        let start = Instant::now();
        let mut last = self.shot();
        loop {
            std::thread::sleep(Duration::from_millis(500));
            let shot = self.shot();
            if shot != before && shot == last {
                return shot;
            }
            assert!(start.elapsed() < Duration::from_secs(30), "the window does not come to rest");
            last = shot;
        }
    }

    pub(super) fn xdotool(&self, arguments: &[&str]) {
        let output =
            Command::new("xdotool").args(arguments).env("DISPLAY", &self.name).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    /// Gives the window the keys: without a window manager nobody else does.
    pub(super) fn focus(&self) {
        self.xdotool(&[
            "mousemove",
            "50",
            "50",
            "search",
            "--name",
            "midair",
            "windowfocus",
            "--sync",
        ]);
        std::thread::sleep(Duration::from_millis(500));
    }

    pub(super) fn key(&self, keys: &[&str]) {
        self.xdotool(&[&["key"], keys].concat());
    }
}

pub(super) fn end(mut show: Child) {
    show.kill().unwrap();
    show.wait().unwrap();
}

/// The window's pixels in what xwd wrote of the screen.
pub(super) fn pixels(dump: &[u8]) -> Vec<u8> {
    // The XWD header: big-endian words; its size, then among others depth, width, height, line length, colours.
    let word = |i: usize| u32::from_be_bytes(dump[4 * i..4 * i + 4].try_into().unwrap()) as usize;
    let (line, start) = (word(12), word(0) + 12 * word(19));
    assert_eq!((word(4), word(5), word(11)), (400, 300, 32));
    let pixel = |x: usize, y: usize| {
        let at = start + y * line + 4 * x;
        [dump[at + 2], dump[at + 1], dump[at]]
    };
    (0..SIDE * SIDE).flat_map(|i| pixel(i % SIDE, i / SIDE)).collect()
}
