//! Where the viewer is, by UDP.

use crate::clock::Clock;
use midair::geometry::{Frame, Vec3};
use rosc::{OscPacket, OscType};
use std::net::{Ipv4Addr, UdpSocket};
use std::time::Duration;

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

impl Reading {
    /// The number of a trial's packet, which stands in the place of the yaw.
    pub(crate) fn number(&self) -> u64 {
        self.angles[0].max(0.0) as u64
    }
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
    viewpoint_of(&rosc::decoder::decode_udp(packet).ok()?.1)
}

fn viewpoint_of(packet: &OscPacket) -> Option<Reading> {
    let message = match packet {
        OscPacket::Message(message) => message,
        OscPacket::Bundle(bundle) => return bundle.content.iter().rev().find_map(viewpoint_of),
    };
    if message.addr != "/midair/viewpoint" {
        return None;
    }
    let number = |argument: &OscType| match *argument {
        OscType::Float(number) => Some(f64::from(number)),
        OscType::Double(number) => Some(number),
        OscType::Int(number) => Some(f64::from(number)),
        _ => None,
    };
    let [x, y, z] = message.args.first_chunk()?;
    let position = Vec3::new(number(x)?, number(y)?, number(z)?);
    sensible(Reading { position, angles: [0.0; 3] })
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
    /// Where the tracker stands in the scene, mm.
    pub position: [f64; 3],
    /// How it is turned, degrees (Rx Ry Rz).
    pub rotation: [f64; 3],
    /// From the point that it tracks to the eye, along the scene's axes, mm.
    pub offset: Vec3,
}

impl Calibration {
    /// The tracker's place in the scene: mm, and degrees (Rx Ry Rz).
    pub fn new(position: [f64; 3], rotation: [f64; 3]) -> Self {
        Self { position, rotation, offset: Vec3::ZERO }
    }

    /// The viewpoint that a reading stands for.
    pub fn viewpoint(&self, reading: &Reading) -> Vec3 {
        let frame = Frame::new(Vec3::from_array(self.position), self.rotation);
        frame.to_world(reading.position) + self.offset
    }

    /// The calibration under which this reading is that viewpoint, with the tracker turned as before.
    pub fn taking(self, reading: &Reading, viewpoint: Vec3) -> Self {
        Self { offset: self.offset + viewpoint - self.viewpoint(reading), ..self }
    }
}

/// A packet of the tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard {
    /// One that tells where the viewer is.
    Reading(Reading),
    /// One that does not, of so many bytes.
    Other(usize),
}

/// What has come from a tracker; it tells when nothing of use does.
#[derive(Clone, Debug)]
pub(crate) struct Reception {
    protocol: Protocol,
    port: u16,
    /// Readings, and other packets.
    counts: [u64; 2],
    /// Bytes of the last packet that was no reading.
    bytes: usize,
    /// Since when there was none but such.
    waiting: Option<Duration>,
    told: bool,
}

/// So long nothing of use may come before it is told.
const USELESS: Duration = Duration::from_secs(3);

impl Reception {
    /// Of a show that begins.
    pub fn new(protocol: Protocol, port: u16) -> Self {
        let waiting = Some(Duration::ZERO);
        Self { protocol, port, counts: [0; 2], bytes: 0, waiting, told: false }
    }

    /// Readings, and other packets.
    pub fn packets(&self) -> [u64; 2] {
        self.counts
    }

    pub fn count(&mut self, heard: &Heard, now: Duration) {
        match *heard {
            Heard::Reading(_) => {
                self.counts[0] += 1;
                (self.waiting, self.told) = (None, false);
            }
            Heard::Other(bytes) => {
                self.counts[1] += 1;
                self.bytes = bytes;
                self.waiting.get_or_insert(now);
            }
        }
    }

    /// When it will be told that nothing of use comes.
    pub fn complains_at(&self) -> Option<Duration> {
        self.waiting.filter(|_| !self.told).map(|since| since + USELESS)
    }

    /// That nothing of use comes, once.
    pub fn complaint(&mut self, now: Duration) -> Option<String> {
        self.complains_at().filter(|&then| now >= then)?;
        self.told = true;
        let Self { port, counts: [_, others], bytes, .. } = self;
        let awaited = match self.protocol {
            Protocol::OpenTrack => "48 bytes from opentrack's output UDP over network",
            Protocol::Osc => "OSC messages /midair/viewpoint x y z",
        };
        Some(match others {
            0 => format!("nothing comes from a tracker on port {port}: awaited are {awaited}"),
            _ => format!(
                "no reading on port {port}: {others} packets came, the last of {bytes} bytes; awaited are {awaited}"
            ),
        })
    }
}

/// Listens on a port and hands each packet over with the time at which it came. Ends when `hear` says no.
///
/// # Errors
/// What the system says of a port that cannot be had.
pub fn listen(
    protocol: Protocol,
    port: u16,
    clock: Clock,
    mut hear: impl FnMut(Heard, Duration) -> bool + Send + 'static,
) -> std::io::Result<u16> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, port))?;
    let port = socket.local_addr()?.port();
    std::thread::spawn(move || {
        let mut packet = [0; 4096];
        while let Ok((length, _)) = socket.recv_from(&mut packet) {
            let now = clock.now();
            let reading = match protocol {
                Protocol::OpenTrack => parse_opentrack(&packet[..length]),
                Protocol::Osc => parse_osc(&packet[..length]),
            };
            if !hear(reading.map_or(Heard::Other(length), Heard::Reading), now) {
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
        // Bundles within bundles, as many as a packet holds.
        let mut nested = plain.clone();
        while nested.len() + 20 <= 4096 {
            let mut outer = b"#bundle\0\0\0\0\0\0\0\0\x01".to_vec();
            outer.extend((nested.len() as u32).to_be_bytes());
            outer.extend(nested);
            nested = outer;
        }
        assert_eq!(parse_osc(&nested).unwrap().position, wanted);
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
    fn that_nothing_of_use_comes_is_told_once() {
        let s = Duration::from_secs_f64;
        let reading = Heard::Reading(Reading { position: Vec3::ZERO, angles: [0.0; 3] });
        let mut silent = Reception::new(Protocol::Osc, 9000);
        assert_eq!(silent.complaint(s(2.9)), None);
        assert!(silent.complaint(s(3.0)).unwrap().contains("nothing comes"));
        assert_eq!(silent.complaint(s(4.0)), None);
        let mut reception = Reception::new(Protocol::OpenTrack, 4242);
        reception.count(&reading, s(1.0));
        assert_eq!(reception.complaint(s(60.0)), None);
        (0..50).for_each(|i| reception.count(&Heard::Other(24), s(60.0 + 0.1 * f64::from(i))));
        assert_eq!(reception.complaint(s(62.9)), None);
        let told = reception.complaint(s(63.0)).unwrap();
        for part in ["port 4242", "50 packets", "24 bytes", "48 bytes"] {
            assert!(told.contains(part), "{told}");
        }
        assert_eq!(reception.packets(), [1, 50]);
        // What was told is told again only after a reading.
        reception.count(&Heard::Other(24), s(70.0));
        assert_eq!(reception.complaint(s(80.0)), None);
        reception.count(&reading, s(81.0));
        reception.count(&Heard::Other(24), s(82.0));
        assert!(reception.complaint(s(85.0)).is_some());
    }

    #[test]
    fn real_packets_arrive() {
        let (sender, heard) = std::sync::mpsc::channel();
        let hear = move |heard, _| sender.send(heard).is_ok();
        let port = listen(Protocol::OpenTrack, 0, Clock::start(), hear).unwrap();
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let next = || heard.recv_timeout(Duration::from_secs(5)).unwrap();
        socket.send_to(b"nonsense", (Ipv4Addr::LOCALHOST, port)).unwrap();
        assert_eq!(next(), Heard::Other(8));
        let packet: Vec<u8> =
            [1.0f64, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|n| n.to_le_bytes()).collect();
        socket.send_to(&packet, (Ipv4Addr::LOCALHOST, port)).unwrap();
        let Heard::Reading(reading) = next() else { panic!("no reading") };
        assert_eq!(reading.position, Vec3::new(10.0, 20.0, 30.0));
    }
}
