//! Where the viewer is, by UDP.

use midair::geometry::{Frame, Vec3};
use std::net::{Ipv4Addr, UdpSocket};
use std::time::Instant;

/// Who tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// opentrack's "UDP over network": six little-endian doubles, x, y, z in cm, yaw, pitch, roll in degrees.
    OpenTrack,
    /// Open Sound Control 1.0: `/midair/viewpoint x y z` in mm, as floats, doubles or integers, alone or in a bundle.
    Osc,
}

/// What a packet says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// In the tracker's frame, mm.
    pub position: Vec3,
    /// Yaw, pitch and roll in degrees, where they are told.
    pub angles: [f64; 3],
}

/// Six little-endian doubles; `None` for a packet of another length, or of numbers that are not finite.
pub fn parse_opentrack(packet: &[u8]) -> Option<Reading> {
    let (numbers, rest) = packet.as_chunks::<8>();
    if numbers.len() != 6 || !rest.is_empty() {
        return None;
    }
    let n: [f64; 6] = std::array::from_fn(|i| f64::from_le_bytes(numbers[i]));
    let position = Vec3::new(n[0], n[1], n[2]) * 10.0;
    sensible(Reading { position, angles: [n[3], n[4], n[5]] })
}

/// The last `/midair/viewpoint` of an OSC packet; `None` if it has none, or none that makes sense.
pub fn parse_osc(packet: &[u8]) -> Option<Reading> {
    parse_osc_within(packet, 8)
}

fn parse_osc_within(packet: &[u8], depth: usize) -> Option<Reading> {
    let Some(elements) = packet.strip_prefix(b"#bundle\0") else { return parse_message(packet) };
    // A time tag, then elements, each after its size.
    let mut rest = elements.get(8..)?;
    let mut last = None;
    while depth > 0 && rest.len() >= 4 {
        let (size, after) = rest.split_first_chunk::<4>()?;
        let element = after.get(..u32::from_be_bytes(*size) as usize)?;
        last = parse_osc_within(element, depth - 1).or(last);
        rest = &after[element.len()..];
    }
    last
}

/// A string that is filled with zeros to a multiple of four, and what follows.
fn osc_string(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|&byte| byte == 0)?;
    Some((&bytes[..end], bytes.get((end / 4 + 1) * 4..)?))
}

fn parse_message(packet: &[u8]) -> Option<Reading> {
    let (address, rest) = osc_string(packet)?;
    let (types, mut rest) = osc_string(rest)?;
    if address != b"/midair/viewpoint" || types.first() != Some(&b',') || types.len() < 4 {
        return None;
    }
    let mut numbers = [0.0; 3];
    for (number, kind) in numbers.iter_mut().zip(&types[1..]) {
        let size = if *kind == b'd' { 8 } else { 4 };
        let bytes = rest.get(..size)?;
        rest = &rest[size..];
        *number = match kind {
            b'f' => f64::from(f32::from_be_bytes(*bytes.first_chunk()?)),
            b'i' => f64::from(i32::from_be_bytes(*bytes.first_chunk()?)),
            b'd' => f64::from_be_bytes(*bytes.first_chunk()?),
            _ => return None,
        };
    }
    sensible(Reading { position: Vec3::from_array(numbers), angles: [0.0; 3] })
}

/// As far away as a scene may reach.
fn sensible(reading: Reading) -> Option<Reading> {
    let p = reading.position;
    let near = [p.x, p.y, p.z].iter().all(|c| c.is_finite() && c.abs() <= 1e6);
    (near && reading.angles.iter().all(|angle| angle.is_finite())).then_some(reading)
}

/// From the tracker's frame to the scene's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Where the tracker stands and how it is turned.
    pub frame: Frame,
    /// From the point that it tracks to the eye, in the scene's frame.
    pub offset: Vec3,
}

impl Calibration {
    /// The tracker's place in the scene: mm, and degrees (Rx Ry Rz).
    pub fn new(position: [f64; 3], rotation: [f64; 3]) -> Self {
        Self { frame: Frame::new(Vec3::from_array(position), rotation), offset: Vec3::ZERO }
    }

    /// The viewpoint that a reading stands for.
    pub fn viewpoint(&self, reading: &Reading) -> Vec3 {
        let [x, y, z] = self.frame.axes;
        let p = reading.position;
        self.frame.origin + x * p.x + y * p.y + z * p.z + self.offset
    }

    /// The calibration under which this reading is that viewpoint, with the tracker turned as before.
    pub fn taking(self, reading: &Reading, viewpoint: Vec3) -> Self {
        Self { offset: self.offset + viewpoint - self.viewpoint(reading), ..self }
    }
}

/// Listens on a port and hands each reading over with the time at which it came; packets of another kind are passed over. Ends when
/// `hear` says no.
///
/// # Errors
/// What the system says of a port that cannot be had.
pub fn listen(
    protocol: Protocol,
    port: u16,
    mut hear: impl FnMut(Reading, Instant) -> bool + Send + 'static,
) -> std::io::Result<u16> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, port))?;
    let port = socket.local_addr()?.port();
    std::thread::spawn(move || {
        let mut packet = [0; 4096];
        while let Ok((length, _)) = socket.recv_from(&mut packet) {
            let now = Instant::now();
            let reading = match protocol {
                Protocol::OpenTrack => parse_opentrack(&packet[..length]),
                Protocol::Osc => parse_osc(&packet[..length]),
            };
            if reading.is_some_and(|reading| !hear(reading, now)) {
                return;
            }
        }
    });
    Ok(port)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opentracks_packet_is_cm_and_degrees() {
        let packet: Vec<u8> =
            [1.5f64, -2.0, 60.0, 10.0, -5.0, 0.5].iter().flat_map(|n| n.to_le_bytes()).collect();
        let reading = parse_opentrack(&packet).unwrap();
        assert_eq!(reading.position, Vec3::new(15.0, -20.0, 600.0));
        assert_eq!(reading.angles, [10.0, -5.0, 0.5]);
        assert!(parse_opentrack(&packet[..40]).is_none());
        let nan: Vec<u8> = [f64::NAN; 6].iter().flat_map(|n| n.to_le_bytes()).collect();
        assert!(parse_opentrack(&nan).is_none());
    }

    /// By the specification's own rules: strings end in zeros up to a multiple of four, numbers are big-endian.
    fn message(address: &str, types: &str, numbers: &[u8]) -> Vec<u8> {
        let padded = |text: &str| {
            let mut bytes = text.as_bytes().to_vec();
            bytes.resize((text.len() / 4 + 1) * 4, 0);
            bytes
        };
        [padded(address), padded(types), numbers.to_vec()].concat()
    }

    #[test]
    fn osc_messages_and_bundles_are_read() {
        let floats: Vec<u8> = [1.5f32, -2.0, 800.0].iter().flat_map(|n| n.to_be_bytes()).collect();
        let wanted = Vec3::new(1.5, -2.0, 800.0);
        let plain = message("/midair/viewpoint", ",fff", &floats);
        assert_eq!(parse_osc(&plain).unwrap().position, wanted);
        let doubles: Vec<u8> = [1.5f64, -2.0, 800.0].iter().flat_map(|n| n.to_be_bytes()).collect();
        assert_eq!(
            parse_osc(&message("/midair/viewpoint", ",ddd", &doubles)).unwrap().position,
            wanted
        );
        let other = message("/other", ",fff", &floats);
        assert!(parse_osc(&other).is_none());
        let mut bundle = b"#bundle\0\0\0\0\0\0\0\0\x01".to_vec();
        for element in [&other, &plain] {
            bundle.extend((element.len() as u32).to_be_bytes());
            bundle.extend(element);
        }
        assert_eq!(parse_osc(&bundle).unwrap().position, wanted);
        // Cut anywhere, it is passed over and nothing breaks.
        for end in 0..plain.len() {
            assert!(parse_osc(&plain[..end]).is_none());
        }
        for end in 0..bundle.len() {
            let _ = parse_osc(&bundle[..end]);
        }
    }

    #[test]
    fn calibration_turns_moves_and_is_taken_from_a_reading() {
        // A tracker above the display that looks at the viewer: turned by half a turn about the vertical.
        let calibration = Calibration::new([0.0, 300.0, 100.0], [0.0, 180.0, 0.0]);
        let reading = Reading { position: Vec3::new(10.0, -20.0, -700.0), angles: [0.0; 3] };
        let eye = calibration.viewpoint(&reading);
        // x and z are reversed, y stays.
        for (a, b) in [(eye.x, -10.0), (eye.y, 280.0), (eye.z, 800.0)] {
            assert!((a - b).abs() < 1e-9, "{eye:?}");
        }
        let wanted = Vec3::new(1.0, 2.0, 3.0);
        let taken = calibration.taking(&reading, wanted).viewpoint(&reading);
        assert!((taken - wanted).dot(taken - wanted) < 1e-20);
    }

    #[test]
    fn real_packets_arrive() {
        let (sender, heard) = std::sync::mpsc::channel();
        let port =
            listen(Protocol::OpenTrack, 0, move |reading, _| sender.send(reading).is_ok()).unwrap();
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.send_to(b"nonsense", (Ipv4Addr::LOCALHOST, port)).unwrap();
        let packet: Vec<u8> =
            [1.0f64, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|n| n.to_le_bytes()).collect();
        socket.send_to(&packet, (Ipv4Addr::LOCALHOST, port)).unwrap();
        let reading = heard.recv_timeout(std::time::Duration::from_secs(5)).unwrap();
        assert_eq!(reading.position, Vec3::new(10.0, 20.0, 30.0));
    }
}
