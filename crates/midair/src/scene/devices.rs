//! Plates and displays that people have: their sizes as data sheets state them.

/// A micro-mirror array plate that is sold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateDevice {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Width and height, mm.
    pub size: [f64; 2],
}

/// A display that is sold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayDevice {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Its pixels as it is held or stands as usual: width, height.
    pub resolution: [usize; 2],
    /// How fine they are, as its data sheet says.
    pub fineness: Fineness,
}

/// How fine a display's pixels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fineness {
    /// Pixels in an inch.
    PerInch(f64),
    /// The diagonal of its lit area, inches.
    Diagonal(f64),
}

/// A millimetre is 1 / 25.4 of an inch.
const INCH: f64 = 25.4;

impl Fineness {
    /// Width and height in mm of so many square pixels.
    pub fn size(self, resolution: [usize; 2]) -> [f64; 2] {
        let [w, h] = resolution.map(|side| side as f64);
        let pitch = match self {
            Self::PerInch(count) => INCH / count,
            Self::Diagonal(inches) => inches * INCH / w.hypot(h),
        };
        [w * pitch, h * pitch]
    }
}

impl DisplayDevice {
    /// Width and height of its lit area, mm.
    pub fn size(&self) -> [f64; 2] {
        self.fineness.size(self.resolution)
    }
}

/// Plates by their makers' names.
pub static PLATES: [PlateDevice; 2] = [
    PlateDevice { name: "aska3d-488", size: [488.0, 488.0] },
    PlateDevice { name: "aska3d-200nt", size: [200.0, 200.0] },
];

const fn tablet(name: &'static str, resolution: [usize; 2], per_inch: f64) -> DisplayDevice {
    DisplayDevice { name, resolution, fineness: Fineness::PerInch(per_inch) }
}

const fn monitor(name: &'static str, resolution: [usize; 2], diagonal: f64) -> DisplayDevice {
    DisplayDevice { name, resolution, fineness: Fineness::Diagonal(diagonal) }
}

/// How many displays there are.
const COUNT: usize = 14;

/// Displays: tablets lying, telephones upright, monitors.
pub static DISPLAYS: [DisplayDevice; COUNT] = [
    tablet("ipad-10.9", [2360, 1640], 264.0),
    tablet("ipad-pro-11", [2388, 1668], 264.0),
    tablet("ipad-pro-12.9", [2732, 2048], 264.0),
    tablet("ipad-mini-8.3", [2266, 1488], 326.0),
    tablet("galaxy-tab-s9-11", [2560, 1600], 274.0),
    tablet("surface-pro-13", [2880, 1920], 267.0),
    tablet("iphone-15", [1179, 2556], 460.0),
    tablet("galaxy-s23", [1080, 2340], 425.0),
    tablet("pixel-8", [1080, 2400], 428.0),
    monitor("portable-15.6-fhd", [1920, 1080], 15.6),
    monitor("monitor-24-fhd", [1920, 1080], 23.8),
    monitor("monitor-27-qhd", [2560, 1440], 27.0),
    monitor("monitor-27-4k", [3840, 2160], 27.0),
    monitor("monitor-32-4k", [3840, 2160], 31.5),
];

/// The names of [`DISPLAYS`].
pub(super) static DISPLAY_NAMES: [&str; COUNT] = {
    let mut names = [""; COUNT];
    let mut index = 0;
    while index < names.len() {
        names[index] = DISPLAYS[index].name;
        index += 1;
    }
    names
};

/// The device of a name, whatever its case; `Err` with the nearest name where one is near.
fn named<T>(
    devices: &'static [T],
    name: impl Fn(&T) -> &'static str,
    wanted: &str,
) -> Result<&'static T, Option<&'static str>> {
    let wanted = wanted.to_lowercase().replace([' ', '_'], "-");
    if let Some(device) = devices.iter().find(|device| name(device) == wanted) {
        return Ok(device);
    }
    let near = |device: &&T| strsim::normalized_damerau_levenshtein(name(device), &wanted);
    let nearest = devices.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
    Err(nearest.filter(|device| near(device) > 0.5).map(name))
}

/// The plate of a name.
///
/// # Errors
/// Where there is none: the nearest name, if one is near.
pub fn plate(name: &str) -> Result<&'static PlateDevice, Option<&'static str>> {
    named(&PLATES, |device| device.name, name)
}

/// The display of a name.
///
/// # Errors
/// Where there is none: the nearest name, if one is near.
pub fn display(name: &str) -> Result<&'static DisplayDevice, Option<&'static str>> {
    named(&DISPLAYS, |device| device.name, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lit areas as makers and reviewers measured them, mm: to a millimetre, which is what rounding of pixels per inch leaves.
    #[test]
    fn sizes_are_those_of_the_things() {
        for (name, known) in [
            ("ipad-10.9", [227.1, 157.8]),
            ("ipad-pro-12.9", [262.9, 197.0]),
            ("iphone-15", [65.1, 141.1]),
            ("monitor-24-fhd", [527.0, 296.5]),
            ("monitor-27-qhd", [597.7, 336.2]),
            ("portable-15.6-fhd", [345.4, 194.3]),
        ] {
            let size = display(name).unwrap().size();
            for axis in 0..2 {
                assert!((size[axis] - known[axis]).abs() < 1.0, "{name} {size:?}");
            }
        }
    }

    #[test]
    fn every_display_has_square_pixels_and_a_name_of_its_own() {
        for (i, device) in DISPLAYS.iter().enumerate() {
            let ([w, h], [columns, rows]) = (device.size(), device.resolution);
            assert!((w / columns as f64 / (h / rows as f64) - 1.0).abs() < 1e-12);
            // From a telephone to a large monitor, 3 to 35 inches.
            assert!((75.0..900.0).contains(&w.hypot(h)), "{}", device.name);
            assert!(DISPLAYS.iter().skip(i + 1).all(|other| other.name != device.name));
        }
    }

    #[test]
    fn names_are_found_as_people_write_them_and_near_misses_are_told() {
        assert_eq!(display("iPad 10.9").unwrap().resolution, [2360, 1640]);
        assert_eq!(plate("ASKA3D-488").unwrap().size, [488.0; 2]);
        assert_eq!(display("ipad-10"), Err(Some("ipad-10.9")));
        assert_eq!(display("toaster"), Err(None));
    }
}
