//! `midair studio`: the page, served to this machine.

mod page;
mod server;

use crate::failure::Failure;
use crate::summary::Voice;
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use midair::scene::{load, scene_file_text};
use page::Page;
use serde_json::json;
use std::io::Write as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::path::{Path, PathBuf};

/// Open the studio in the browser: see a set-up in three dimensions, drag it, take its map
///
/// The page computes by itself: nothing is sent anywhere. It is served to this machine only; with --host also to a tablet, which can then be the light source. `cargo xtask studio` builds the page.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair studio\n  midair studio scene.toml\n  midair studio scene.toml --host 192.168.1.20"
)]
pub struct Arguments {
    /// Scene file to open (TOML)
    scene: Option<PathBuf>,
    /// Address of this machine to serve at, so that others reach it; 0.0.0.0: all of them. The address is shown as a QR code
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    host: IpAddr,
    /// Port to serve at; left out: 8473, or a free one if that is taken
    #[arg(long)]
    port: Option<u16>,
    /// Folder of the built page; left out: the one that `cargo xtask studio` made, or share/midair/studio beside the program's folder
    #[arg(long, value_name = "FOLDER")]
    page: Option<PathBuf>,
    /// Do not open the browser
    #[arg(long)]
    no_browser: bool,
}

/// The port that is asked for first: one address has one memory in the browser.
const PORT: u16 = 8473;

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let scene = arguments.scene.as_deref().map(fragment).transpose()?;
    let page = Page::read(&folder(arguments.page.as_deref())?)?;
    let listener = listen(arguments.host, arguments.port)?;
    let own = listener.local_addr().map_err(|error| no_port(arguments.host, &error))?;
    let address = format!("http://{}/{}", seen_at(own), scene.unwrap_or_default());
    let told = json!({ "address": address, "files": page.count() });
    let far = !own.ip().is_loopback();
    let code = if far { qr_code(&address) } else { String::new() };
    voice.tell(&format!("{code}The studio is at {address}\nCtrl-C ends it.\n"), &told)?;
    if let (Some(file), false) = (&arguments.scene, voice.json) {
        note_files(file, voice);
    }
    if !arguments.no_browser && open::that_detached(&address).is_err() {
        voice.note(&["no browser could be opened: open the address by hand".to_owned()]);
    }
    server::serve(&listener, &page);
    Ok(())
}

/// A scene's text as the page takes it from its address: deflated, in base64.
fn fragment(path: &Path) -> Result<String, Failure> {
    // What is wrong with it is said here, with the line.
    load(path)?;
    let text = scene_file_text(path)?;
    let mut packer = DeflateEncoder::new(Vec::new(), Compression::best());
    let packed = packer.write_all(text.as_bytes()).and_then(|()| packer.finish());
    let packed = packed.map_err(|error| Failure::new(error.to_string(), "free some memory"))?;
    let link = format!("#1={}", URL_SAFE_NO_PAD.encode(packed));
    // What systems hand to a program in one word; browsers take more.
    if link.len() > 100_000 {
        return Err(Failure::new(
            format!("{}: the scene is too long for a link", path.display()),
            "start the studio without it, and drop the file onto the page",
        ));
    }
    Ok(link)
}

/// Files that the scene names do not fit into a link.
fn note_files(scene: &Path, voice: Voice) {
    let files = load(scene).map(|loaded| loaded.files).unwrap_or_default();
    if let [first, ..] = &files[..] {
        let first = first.display();
        voice.note(&[format!(
            "the scene names files, such as {first}: drop them onto the page together with the scene"
        )]);
    }
}

/// Where the built page lies.
fn folder(named: Option<&Path>) -> Result<PathBuf, Failure> {
    if let Some(folder) = named {
        return Ok(folder.to_owned());
    }
    let program = std::env::current_exe().ok().and_then(|program| program.canonicalize().ok());
    let beside = program.as_deref().and_then(Path::parent).and_then(Path::parent);
    // Of a working copy: target/debug/midair and target/studio. Of an installed program: bin/midair and share/midair/studio.
    let places = beside.map(|above| [above.join("studio"), above.join("share/midair/studio")]);
    let found = places.into_iter().flatten().find(|folder| folder.join("index.html").is_file());
    found.ok_or_else(|| {
        Failure::new(
            "the studio's page is not there",
            "build it with `cargo xtask studio`; an installed program finds it by --page target/studio",
        )
    })
}

fn listen(host: IpAddr, port: Option<u16>) -> Result<TcpListener, Failure> {
    let bound = match port {
        Some(port) => TcpListener::bind((host, port)),
        None => TcpListener::bind((host, PORT)).or_else(|_| TcpListener::bind((host, 0))),
    };
    bound.map_err(|error| no_port(host, &error))
}

fn no_port(host: IpAddr, error: &std::io::Error) -> Failure {
    Failure::new(
        format!("nothing can be served at {host}: {error}"),
        "give an address of this machine as --host, and another --port",
    )
}

/// The address as others call it.
fn seen_at(own: SocketAddr) -> SocketAddr {
    if !own.ip().is_unspecified() {
        return own;
    }
    // The way out of the machine tells its address; nothing is sent (the place is one of documentation's, RFC 5737).
    let ask = || -> std::io::Result<IpAddr> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9))?;
        Ok(socket.local_addr()?.ip())
    };
    SocketAddr::new(ask().unwrap_or(Ipv4Addr::LOCALHOST.into()), own.port())
}

/// For a camera; empty where the address is longer than a code holds.
fn qr_code(address: &str) -> String {
    let code = fast_qr::QRBuilder::new(address).build();
    code.map(|code| code.to_str() + "\n").unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::DeflateDecoder;
    use std::io::Read as _;

    #[test]
    fn a_link_holds_the_scene_s_text() {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/ball.toml");
        let link = fragment(scene.as_ref()).unwrap();
        let packed = URL_SAFE_NO_PAD.decode(link.strip_prefix("#1=").unwrap()).unwrap();
        let mut text = String::new();
        DeflateDecoder::new(&packed[..]).read_to_string(&mut text).unwrap();
        assert_eq!(text, std::fs::read_to_string(scene).unwrap());
    }

    #[test]
    fn an_address_for_all_is_told_as_one() {
        let seen = seen_at("0.0.0.0:80".parse().unwrap());
        assert!(!seen.ip().is_unspecified() && seen.port() == 80);
        let own = "127.0.0.1:9".parse().unwrap();
        assert_eq!(seen_at(own), own);
        assert!(qr_code("http://192.168.1.20:8473/").lines().count() > 10);
    }
}
