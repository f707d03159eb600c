//! `midair studio`: what it serves, and what not.

use crate::{Bench, scene};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};

/// A running server, ended when it is dropped.
struct Studio {
    child: Child,
    /// Host and port.
    at: String,
    fragment: String,
}

impl Drop for Studio {
    fn drop(&mut self) {
        // It may have ended by itself, which the test has seen.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Studio {
    fn start(bench: &Bench, more: &[&str]) -> Self {
        let mut command =
            bench.command(&["studio", "--no-browser", "--port", "0", "--page", "page"]);
        command.args(more).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let mut found = lines.filter_map(|line| Some(line.split_once("http://")?.1.to_owned()));
        let address = found.next().expect("it says where it is");
        let (at, fragment) = address.split_once('/').unwrap();
        Self { child, at: at.to_owned(), fragment: fragment.to_owned() }
    }

    /// The head and the body of what is answered.
    fn ask(&self, request: &str) -> (String, Vec<u8>) {
        let mut connection = TcpStream::connect(&self.at).unwrap();
        connection.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        connection.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("a head") + 4;
        (String::from_utf8(answer[..end].to_vec()).unwrap(), answer[end..].to_vec())
    }

    fn get(&self, path: &str) -> (String, Vec<u8>) {
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: here\r\n\r\n"))
    }
}

/// A page of two files, with a secret beside it and a link to that within.
fn bench() -> Bench {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("page/assets")).unwrap();
    bench.write("page/index.html", "<!doctype html>");
    bench.write("page/assets/core.wasm", [0, 1, 2, 255]);
    bench.write("secret", "secret");
    #[cfg(unix)]
    std::os::unix::fs::symlink(bench.path("secret"), bench.path("page/link")).unwrap();
    bench
}

#[test]
fn it_serves_the_page_s_files_and_nothing_else() {
    let bench = bench();
    let studio = Studio::start(&bench, &[]);
    assert!(studio.at.starts_with("127.0.0.1:"), "{}", studio.at);
    let (head, body) = studio.get("/");
    assert!(head.starts_with("HTTP/1.1 200 ") && head.contains("text/html"), "{head}");
    assert!(head.contains("default-src 'none'") && body == b"<!doctype html>");
    let (head, body) = studio.get("/assets/core.wasm?1");
    assert!(head.contains("application/wasm") && body == [0, 1, 2, 255], "{head}");
    let (head, body) = studio.ask("HEAD /assets/core.wasm HTTP/1.1\r\n\r\n");
    assert!(head.contains("Content-Length: 4") && body.is_empty(), "{head}");

    let outside = bench.path("secret").display().to_string();
    for way in [
        "/../secret",
        "/assets/../../secret",
        "/%2e%2e/secret",
        "//../secret",
        "/link",
        "/assets",
        "/none",
        &outside,
    ] {
        let (head, body) = studio.get(way);
        assert!(head.starts_with("HTTP/1.1 404 ") && body.is_empty(), "{way}: {head}");
    }
    // More than a head may have: it is answered before all of it is read, so only the answer's first line is sure to arrive.
    let long = format!("GET / HTTP/1.1\r\nA: {}\r\n\r\n", "x".repeat((16 << 10) - 20));
    for (request, status) in [
        ("POST / HTTP/1.1\r\n\r\n", "405"),
        ("nonsense\r\n\r\n", "400"),
        (&long[..16 << 10], "400"),
    ] {
        let (head, _) = studio.ask(request);
        assert_eq!(head.get(9..12), Some(status), "{request:.40}");
    }
    // It goes on.
    assert!(studio.get("/").0.starts_with("HTTP/1.1 200 "));
}

#[test]
fn a_scene_comes_in_the_address_and_a_wrong_one_is_refused() {
    let bench = bench();
    let studio = Studio::start(&bench, &[&scene("ball.toml")]);
    assert!(studio.fragment.starts_with("#1="), "{}", studio.fragment);

    bench.write("a.toml", "[viewpoint]\nposition = 3\n");
    for (more, words) in [
        (&["a.toml"][..], ["a.toml:2", "position"]),
        (&["--page", "none"], ["none", "cargo xtask studio"]),
        (&["--page", "."], ["index.html", "cargo xtask studio"]),
        (&["--page", "page", "--host", "192.0.2.1"], ["192.0.2.1", "--host"]),
    ] {
        let said = bench.refuse(&[&["studio", "--no-browser"], more].concat());
        assert!(words.iter().all(|word| said.contains(word)), "{more:?}: {said}");
    }
}
