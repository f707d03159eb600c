//! A web server for the page's files and nothing else: GET and HEAD, one request a connection.

use super::page::Page;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Connections at once; a browser opens six.
const MOST_CONNECTIONS: usize = 64;
/// A request's head is no longer than this.
const MOST_HEAD: usize = 16 << 10;
/// How long a client may take to ask, and to take what it is sent.
const PATIENCE: Duration = Duration::from_secs(20);

/// What the page may do: its own files and its own core. WebAssembly has no weaker word than `wasm-unsafe-eval`.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'; worker-src 'self'; \
     media-src blob:; img-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Serves until the program ends.
pub fn serve(listener: &TcpListener, page: &Page) {
    let open = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for connection in listener.incoming() {
            // One that was given up before it was taken.
            let Ok(connection) = connection else { continue };
            if open.load(Ordering::Relaxed) >= MOST_CONNECTIONS {
                continue;
            }
            open.fetch_add(1, Ordering::Relaxed);
            let open = &open;
            scope.spawn(move || {
                // Whoever asked has gone: nobody is left to be told.
                let _ = answer(connection, page);
                open.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
}

fn answer(mut connection: TcpStream, page: &Page) -> std::io::Result<()> {
    connection.set_read_timeout(Some(PATIENCE))?;
    connection.set_write_timeout(Some(PATIENCE))?;
    let mut head = Vec::new();
    let mut part = [0; 4096];
    loop {
        let count = connection.read(&mut part)?;
        head.extend_from_slice(&part[..count]);
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&head) {
            Ok(httparse::Status::Complete(_)) => {
                let response = respond(&request, page);
                connection.write_all(&response.head)?;
                connection.write_all(response.body)?;
                return connection.flush();
            }
            Ok(httparse::Status::Partial) if count > 0 && head.len() < MOST_HEAD => {}
            _ => {
                connection.write_all(&refusal("400 Bad Request").head)?;
                return connection.flush();
            }
        }
    }
}

struct Response<'a> {
    head: Vec<u8>,
    body: &'a [u8],
}

fn respond<'a>(request: &httparse::Request<'_, '_>, page: &'a Page) -> Response<'a> {
    let method = request.method.unwrap_or_default();
    if method != "GET" && method != "HEAD" {
        return refusal("405 Method Not Allowed");
    }
    let path = request.path.unwrap_or_default();
    let path = path.split(['?', '#']).next().unwrap_or_default();
    let Some(file) = page.find(path) else { return refusal("404 Not Found") };
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {}\r\nContent-Length: {}\r\nContent-Security-Policy: {POLICY}\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCache-Control: no-cache\r\nConnection: close\r\n\r\n",
        file.kind,
        file.bytes.len()
    );
    let body = if method == "HEAD" { &[][..] } else { &file.bytes };
    Response { head: head.into_bytes(), body }
}

fn refusal(status: &str) -> Response<'static> {
    let head = format!("HTTP/1.1 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    Response { head: head.into_bytes(), body: &[] }
}
