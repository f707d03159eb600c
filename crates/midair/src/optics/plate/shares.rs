//! What becomes of light from one direction, averaged over where it enters the lattice: closed
//! forms, no rays.

use super::SlitMirrorPlate;
use crate::geometry::Vec3;
use crate::optics::interface::{beer_lambert, fresnel};

/// Shares of the light from one direction, by linear R, G, B; the four add up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Forms the mid-air image: odd in both layers.
    pub real: [f64; 3],
    /// Forms stray images: odd in one layer.
    pub stray: [f64; 3],
    /// Goes on as through a window: even in both layers.
    pub through: [f64; 3],
    /// Is lost: in mirrors and at their ends, in the glass, and by reflection at the faces.
    pub absorbed: [f64; 3],
}

/// Luminance of linear R, G, B (the weights of Rec. ITU-R BT.709).
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// How light divides in one layer.
#[derive(Clone, Copy, Debug)]
struct Parity {
    /// Fewest mirrors met; the rest of the light meets one more.
    least: f64,
    /// Share that meets one more.
    more: f64,
}

impl Parity {
    fn is_odd(&self) -> bool {
        self.least % 2.0 == 1.0
    }

    /// Share that meets an odd number of mirrors: a triangle wave of the mean number.
    fn odd(&self) -> f64 {
        if self.is_odd() { 1.0 - self.more } else { self.more }
    }

    /// Light left after the mirrors, met an odd and an even number of times.
    fn left(&self, reflectance: f64) -> (f64, f64) {
        let least = reflectance.powf(self.least);
        let (few, many) = ((1.0 - self.more) * least, self.more * least * reflectance);
        if self.is_odd() { (few, many) } else { (many, few) }
    }
}

/// What is left of light from one direction, factor by factor.
struct Arriving {
    /// After both faces.
    faces: f64,
    /// Of that, after the glass, by linear R, G, B.
    glass: [f64; 3],
    /// Of that, beside the mirrors' ends.
    open: f64,
    /// Of that, after the mirrors of the two layers, met an odd and an even number of times, by linear R, G, B.
    left: [[(f64, f64); 2]; 3],
}

impl SlitMirrorPlate {
    /// Share of the light with unit direction `d` (plate's frame) that meets an odd number of
    /// mirrors in layer 0 and in layer 1, of that which misses the mirrors' ends.
    ///
    /// With N = depth / clear width * |slope in the glass across the mirrors|, a share 1 - f meets
    /// k = floor N mirrors and a share f = N - k one more; the odd share is f if k is even and
    /// 1 - f if it is odd (Kiuchi and Koizumi, Computers & Graphics 96, 2021). NaN along the plate.
    pub fn odd_shares(&self, d: Vec3) -> [f64; 2] {
        self.parities(d).map(|p| p.odd())
    }

    fn parities(&self, d: Vec3) -> [Parity; 2] {
        let p = self.parameters();
        let cos_t = fresnel(d.z.abs(), 1.0 / p.ior).cos_t;
        let clear = p.pitch - p.mirror_thickness;
        self.across([d.x, d.y]).map(|along| {
            let mean = p.layer_depth / clear * (along / (p.ior * cos_t)).abs();
            let least = mean.floor();
            Parity { least, more: mean - least }
        })
    }

    /// What becomes of light with unit direction `d` (plate's frame, from either side), averaged
    /// over where it enters.
    ///
    /// The two layers are crossed independently, because their mirrors are at right angles: the
    /// mean over the plate of [`pass`](Self::pass)'s weights is exactly this.
    pub fn shares(&self, d: Vec3) -> Shares {
        let Some(Arriving { faces, glass, open, left }) = self.arriving(d) else {
            let none = [0.0; 3];
            return Shares { real: none, stray: none, through: none, absorbed: [1.0; 3] };
        };
        let mut shares =
            Shares { real: [0.0; 3], stray: [0.0; 3], through: [0.0; 3], absorbed: [0.0; 3] };
        for c in 0..3 {
            let entering = faces * glass[c] * open;
            let [(odd0, even0), (odd1, even1)] = left[c];
            shares.real[c] = entering * odd0 * odd1;
            shares.stray[c] = entering * (odd0 * even1 + even0 * odd1);
            shares.through[c] = entering * even0 * even1;
            // Loss by loss, in the order in which light meets them.
            let mirrors = 1.0 - (odd0 + even0) * (odd1 + even1);
            shares.absorbed[c] = (1.0 - faces)
                + faces * (1.0 - glass[c])
                + faces * glass[c] * (1.0 - open)
                + entering * mirrors;
        }
        shares
    }

    /// Share of the light with unit direction `d` (plate's frame, from either side) that is turned across layer 0's and layer 1's
    /// mirrors as `odd` says, by linear R, G, B: both odd is [`Shares::real`], one odd is a part of [`Shares::stray`].
    pub fn share(&self, d: Vec3, odd: [bool; 2]) -> [f64; 3] {
        let Some(Arriving { faces, glass, open, left }) = self.arriving(d) else {
            return [0.0; 3];
        };
        std::array::from_fn(|c| {
            let [first, second] = left[c];
            let of =
                |(turned, straight): (f64, f64), odd: bool| if odd { turned } else { straight };
            faces * glass[c] * open * of(first, odd[0]) * of(second, odd[1])
        })
    }

    /// What the faces, the glass and the mirrors' ends let on, and what mirrors leave of that; `None` where the faces let nothing in.
    fn arriving(&self, d: Vec3) -> Option<Arriving> {
        let p = self.parameters();
        let f = fresnel(d.z.abs(), 1.0 / p.ior);
        let faces = f.transmittance() * f.transmittance();
        (!(faces <= 0.0)).then(|| {
            let parities = self.parities(d);
            Arriving {
                faces,
                glass: beer_lambert(p.absorption, p.thickness() / f.cos_t),
                open: (1.0 - p.mirror_thickness / p.pitch).powi(2),
                left: p.reflectance.map(|reflectance| parities.map(|x| x.left(reflectance))),
            }
        })
    }

    /// Luminance of the mid-air image over the display's, for light with unit direction `d`
    /// (plate's frame, from either side): the real share of [`Self::shares`], weighted by colour.
    pub fn efficiency(&self, d: Vec3) -> f64 {
        luminance(self.shares(d).real)
    }

    /// Where light from `source` to `eye` (plate's frame, on opposite sides of it) crosses the
    /// plate, if it is reversed across layer 0's and layer 1's mirrors as `odd` says: local x and y.
    ///
    /// For a thin plate. With depths d of the source and e of the eye, and S and E their
    /// coordinates across the mirrors of one layer: (S e - E d) / (e - d) if odd, (S e + E d) /
    /// (e + d) if even. `[true, true]` is the mid-air image, `[false, false]` the view through;
    /// the two others are the stray images, astigmatic and moving with the eye. `None` if the eye
    /// is as far away as the source, where an odd passage has no single crossing, or if both are
    /// on one side.
    pub fn thin_crossing(&self, source: Vec3, eye: Vec3, odd: [bool; 2]) -> Option<[f64; 2]> {
        let (d, e) = (source.z.abs(), eye.z.abs());
        if source.z * eye.z >= 0.0 || (d == e && odd.contains(&true)) {
            return None;
        }
        let s = self.across([source.x, source.y]);
        let v = self.across([eye.x, eye.y]);
        Some(self.across_inverse(std::array::from_fn(|layer| {
            let (s, v) = (s[layer], v[layer]);
            if odd[layer] { (s * e - v * d) / (e - d) } else { (s * e + v * d) / (e + d) }
        })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::plate::slit_mirror::tests::Random;
    use crate::optics::plate::{Class, SlitMirror};

    fn lossless() -> SlitMirror {
        SlitMirror { reflectance: [1.0; 3], ..SlitMirror::default() }
    }

    /// Light in the plane of local x and z: at 45 degrees of azimuth to both layers' mirrors.
    fn at_incidence(degrees: f64) -> Vec3 {
        let (s, c) = degrees.to_radians().sin_cos();
        Vec3::new(s, 0.0, c)
    }

    #[test]
    fn known_shares_of_a_lossless_plate() {
        let plate = SlitMirrorPlate::new(lossless()).unwrap();
        // Kiuchi and Koizumi's module values; given to the digits shown.
        for (incidence, real, stray, through, last_digit) in [
            (30.0, 0.38, 0.47, 0.15, 0.01),
            (45.0, 0.86, 0.13, 0.005, 0.001),
            (60.0, 0.60, 0.35, 0.05, 0.01),
        ] {
            let d = at_incidence(incidence);
            let [a, b] = plate.odd_shares(d);
            assert!((a - b).abs() < 1e-12);
            let shares = plate.shares(d);
            let passed = 1.0 - shares.absorbed[0];
            for (got, energy, known, digit) in [
                (a * b, shares.real[0], real, 0.01),
                (a * (1.0 - b) + b * (1.0 - a), shares.stray[0], stray, 0.01),
                ((1.0 - a) * (1.0 - b), shares.through[0], through, last_digit),
            ] {
                assert!((got - known).abs() <= 0.5 * digit + 1e-12, "{incidence} {got} {known}");
                assert!((energy / passed - got).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn one_mirror_per_layer_is_certain_at_48_5_degrees() {
        let plate = SlitMirrorPlate::new(lossless()).unwrap();
        let odd = |degrees: f64| plate.odd_shares(at_incidence(degrees))[0];
        // tan t = sqrt(2) / 2.5, sin i = n sin t.
        let slope = 2f64.sqrt() / 2.5;
        let peak = (1.52 * slope / slope.hypot(1.0)).asin().to_degrees();
        assert!((peak - 48.5).abs() < 0.05, "{peak}");
        assert!((odd(peak) - 1.0).abs() < 1e-12);
        assert!(odd(peak - 0.5) < 1.0 && odd(peak + 0.5) < 1.0);
    }

    #[test]
    fn the_odd_share_is_a_triangle_wave() {
        // Glass of index 1 and no azimuth: the slope across layer 1's mirrors is tan of incidence.
        let parameters = SlitMirror { ior: 1.0, azimuth: 0.0, ..lossless() };
        let plate = SlitMirrorPlate::new(parameters).unwrap();
        for i in 0..800 {
            let degrees = 0.1 * f64::from(i);
            let [none, odd] = plate.odd_shares(at_incidence(degrees));
            assert!(none.abs() < 1e-15);
            let mean = 2.5 * degrees.to_radians().tan();
            // arccos of cos: a triangle wave of period 2, 0 at even numbers and 1 at odd ones.
            let wave = (std::f64::consts::PI * mean).cos().acos() / std::f64::consts::PI;
            // arccos has the square root of rounding at the wave's corners.
            assert!((odd - wave).abs() < 1e-7, "{degrees} {odd} {wave}");
        }
    }

    #[test]
    fn all_light_is_accounted_for() {
        let mut random = Random(11);
        for _ in 0..200 {
            let plate = SlitMirrorPlate::new(random.plate()).unwrap();
            for _ in 0..50 {
                let s = plate.shares(random.direction());
                for c in 0..3 {
                    let parts = [s.real[c], s.stray[c], s.through[c], s.absorbed[c]];
                    assert!((parts.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    assert!(parts.iter().all(|&x| x >= 0.0));
                }
            }
        }
    }

    /// The mean over entry points of what single rays do, over a grid that fills lattice cells
    /// evenly: the midpoint rule's error is a few cells' edges.
    #[test]
    fn shares_are_the_mean_over_rays() {
        let mut random = Random(12);
        let n = 200;
        for _ in 0..30 {
            let parameters = random.plate();
            let plate = SlitMirrorPlate::new(parameters).unwrap();
            let d = random.direction();
            let shares = plate.shares(d);
            let mut sums = [[0.0; 3]; 3];
            for i in 0..n * n {
                let place = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * parameters.pitch;
                let [x, y] = plate.across_inverse([place(i % n), place(i / n)]);
                if let Some(p) = plate.pass(Vec3::new(x, y, 0.0), d) {
                    let class = match p.class {
                        Class::Real => 0,
                        Class::Stray => 1,
                        Class::Through => 2,
                    };
                    for c in 0..3 {
                        sums[class][c] += p.weight[c] / f64::from(n * n);
                    }
                }
            }
            for (sum, share) in sums.iter().zip([shares.real, shares.stray, shares.through]) {
                for c in 0..3 {
                    // Up to three boundaries an axis, each off by at most half a row in 200.
                    assert!((sum[c] - share[c]).abs() < 3.0 / f64::from(n), "{sum:?} {share:?}");
                }
            }
        }
    }

    #[test]
    fn the_kinds_of_stray_light_are_what_single_rays_do() {
        let mut random = Random(21);
        let n = 200;
        for _ in 0..10 {
            let parameters = random.plate();
            let plate = SlitMirrorPlate::new(parameters).unwrap();
            let d = random.direction();
            let mut sums = [[0.0; 3]; 4];
            for i in 0..n * n {
                let place = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * parameters.pitch;
                let [x, y] = plate.across_inverse([place(i % n), place(i / n)]);
                if let Some(p) = plate.pass(Vec3::new(x, y, 0.0), d) {
                    let [a, b] = p.mirrors.map(|k| k as usize % 2);
                    (0..3).for_each(|c| sums[2 * a + b][c] += p.weight[c] / f64::from(n * n));
                }
            }
            for (kind, sum) in sums.iter().enumerate() {
                let share = plate.share(d, [kind / 2 == 1, kind % 2 == 1]);
                for c in 0..3 {
                    // As above: up to three boundaries an axis, each off by at most half a row in 200.
                    assert!((sum[c] - share[c]).abs() < 3.0 / f64::from(n), "{sum:?} {share:?}");
                }
            }
        }
    }

    #[test]
    fn light_along_the_plate_is_all_lost() {
        for ior in [1.0, 1.52] {
            let plate = SlitMirrorPlate::new(SlitMirror { ior, ..lossless() }).unwrap();
            let shares = plate.shares(Vec3::new(1.0, 0.0, 0.0));
            assert_eq!((shares.real, shares.absorbed), ([0.0; 3], [1.0; 3]));
        }
    }

    #[test]
    fn thicker_mirrors_and_darker_glass_take_their_share() {
        let d = at_incidence(40.0);
        let shares = |p| SlitMirrorPlate::new(p).unwrap().shares(d);
        // Ends take thickness / pitch in each layer; scaling the depth keeps depth / clear width.
        let thick = SlitMirror { mirror_thickness: 0.05, layer_depth: 1.25 * 0.9, ..lossless() };
        let ratio = shares(thick).real[0] / shares(lossless()).real[0];
        assert!((ratio - 0.9 * 0.9).abs() < 1e-12, "{ratio}");
        // Absorption along 4 mm of plate, slanted by Snell.
        let dark = SlitMirror { absorption: [0.0, 0.02, 0.0], ..lossless() };
        let s = shares(dark);
        let slanted = 4.0 / (1.0 - (40f64.to_radians().sin() / 1.52).powi(2)).sqrt();
        assert!((s.real[1] / s.real[0] - (-0.02 * slanted).exp()).abs() < 1e-12);
    }

    #[test]
    fn stray_light_comes_from_where_the_thin_plate_says() {
        let parameters = SlitMirror {
            pitch: 0.01,
            layer_depth: 0.025,
            cover_glass: 0.0,
            azimuth: 37.0,
            ..SlitMirror::default()
        };
        let plate = SlitMirrorPlate::new(parameters).unwrap();
        let mut random = Random(13);
        let source = Vec3::new(4.0, -7.0, -100.0);
        let mut seen = [0; 4];
        for _ in 0..20_000 {
            let d = random.direction();
            let d = Vec3::new(d.x, d.y, d.z.abs());
            if d.z < 0.3 {
                continue;
            }
            let passage = plate.pass(source, d).unwrap();
            let e = random.between(250.0, 900.0);
            let eye = passage.exit_point
                + passage.direction * ((e - passage.exit_point.z) / passage.direction.z);
            let odd = passage.mirrors.map(|k| k % 2 == 1);
            let [x, y] = plate.thin_crossing(source, eye, odd).unwrap();
            let to_plate = -source.z / d.z;
            let off = (x - source.x - d.x * to_plate).hypot(y - source.y - d.y * to_plate);
            // The plate is 0.05 mm thick and its rays are displaced by up to that times the slope
            // (3.2) plus a pitch; with e at least 2.5 d, (S e - E d) / (e - d) takes at most 2/3
            // of a displacement of E.
            assert!(off < 2.0 / 3.0 * (0.05 * 3.2 + 0.01), "{off} {odd:?}");
            seen[usize::from(odd[0]) + 2 * usize::from(odd[1])] += 1;
        }
        assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
        // Real light comes from the image, wherever the eye is.
        let eye = Vec3::new(20.0, 30.0, 400.0);
        let [x, y] = plate.thin_crossing(source, eye, [true, true]).unwrap();
        let image = Vec3::new(4.0, -7.0, 100.0);
        let line = (image - eye).normalized().cross(Vec3::new(x, y, 0.0) - eye);
        assert!(line.length() < 1e-12);
        assert_eq!(plate.thin_crossing(source, Vec3::new(0.0, 0.0, 100.0), [true, false]), None);
        assert_eq!(plate.thin_crossing(source, Vec3::new(0.0, 0.0, -9.0), [false, false]), None);
    }
}
