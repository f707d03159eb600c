use super::*;
use crate::optics::interface::{reflect, refract};
use crate::optics::plate::pass_ideal;

/// SplitMix64 (Steele, Lea and Flood 2014): enough randomness for test rays.
pub(in crate::optics::plate) struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A direction that is not within about a degree of grazing, on either side.
    pub fn direction(&mut self) -> Vec3 {
        let z = self.between(0.02, 1.0) * if self.unit() < 0.5 { -1.0 } else { 1.0 };
        let around = self.between(0.0, std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * around.cos(), r * around.sin(), z)
    }

    /// A plate of any dimensions, mirrors with thickness in half of the cases.
    pub fn plate(&mut self) -> SlitMirror {
        let pitch = self.between(0.05, 1.0);
        SlitMirror {
            pitch,
            layer_depth: pitch * self.between(0.2, 12.0),
            azimuth: self.between(-180.0, 180.0),
            reflectance: [0.9, 0.87, self.between(0.0, 1.0)],
            ior: self.between(1.0, 2.0),
            absorption: [0.0, 0.01, self.between(0.0, 0.1)],
            cover_glass: self.between(0.0, 2.0),
            mirror_thickness: if self.unit() < 0.5 { 0.0 } else { self.between(0.0, 0.4) * pitch },
        }
    }
}

/// The plate with every mirror in its place: a ray walks in three dimensions from mirror face to
/// mirror face, refracted and reflected by the interface formulas.
fn walk(p: &SlitMirror, point: Vec3, direction: Vec3) -> Option<Passage> {
    let z_sign = direction.z.signum();
    let half = 0.5 * p.thickness();
    let face_normal = Vec3::new(0.0, 0.0, -z_sign);
    let azimuth = p.azimuth.to_radians();
    // Normals of the mirrors of layer 0 (which run along the azimuth) and of layer 1.
    let normals = [
        Vec3::new(-azimuth.sin(), azimuth.cos(), 0.0),
        Vec3::new(azimuth.cos(), azimuth.sin(), 0.0),
    ];
    let to_depth = |at: Vec3, d: Vec3, z: f64| at + d * ((z - at.z) / d.z);

    let mut at = to_depth(point, direction, -half * z_sign);
    let mut d = refract(direction, face_normal, 1.0 / p.ior);
    let mut length = 0.0;
    let mut mirrors = [0; 2];
    // Layer 0 fills 0 .. depth, layer 1 -depth .. 0.
    let order = if z_sign < 0.0 { [0, 1] } else { [1, 0] };
    for layer in order {
        let n = normals[layer];
        let (low, high) = if layer == 0 { (0.0, p.layer_depth) } else { (-p.layer_depth, 0.0) };
        let (near, far) = if z_sign < 0.0 { (high, low) } else { (low, high) };
        let next = to_depth(at, d, near);
        length += (next - at).length();
        at = next;
        // Mirror j has its mid-plane at j * pitch: the faces on either side of the ray.
        let j = (at.dot(n) / p.pitch).floor();
        let faces = [
            j * p.pitch + 0.5 * p.mirror_thickness,
            (j + 1.0) * p.pitch - 0.5 * p.mirror_thickness,
        ];
        if at.dot(n) < faces[0] || at.dot(n) > faces[1] {
            return None;
        }
        loop {
            let towards = d.dot(n);
            let wall = if towards > 0.0 { faces[1] } else { faces[0] };
            let to_wall = (wall - at.dot(n)) / towards;
            let to_far = (far - at.z) / d.z;
            let step = to_wall.min(to_far);
            at = at + d * step;
            length += step;
            if to_far <= to_wall {
                break;
            }
            d = reflect(d, n);
            mirrors[layer] += 1;
        }
    }
    let exit_point = to_depth(at, d, half * z_sign);
    length += (exit_point - at).length();
    let out = refract(d, face_normal, p.ior);
    let faces = (1.0 - fresnel(direction.z.abs(), 1.0 / p.ior).reflectance())
        * (1.0 - fresnel(d.z.abs(), p.ior).reflectance());
    let weight = std::array::from_fn(|c| {
        p.reflectance[c].powi(mirrors[0] as i32)
            * p.reflectance[c].powi(mirrors[1] as i32)
            * faces
            * (-p.absorption[c] * length).exp()
    });
    let class = match mirrors.iter().filter(|&&k| k % 2 == 1).count() {
        2 => Class::Real,
        1 => Class::Stray,
        _ => Class::Through,
    };
    Some(Passage { exit_point, direction: out, mirrors, class, weight })
}

#[test]
fn unfolding_agrees_with_explicit_mirrors_on_a_million_rays() {
    let mut random = Random(1);
    let (mut rays, mut absorbed, mut most) = (0, 0, 0);
    for _ in 0..500 {
        let parameters = random.plate();
        let plate = SlitMirrorPlate::new(parameters).unwrap();
        for _ in 0..2200 {
            let d = random.direction();
            // Through a point on the mid-plane's neighbourhood, so that |x|, |y| stay below 100.
            let point = Vec3::new(random.between(-50.0, 50.0), random.between(-50.0, 50.0), 0.0);
            rays += 1;
            match (plate.pass(point, d), walk(&parameters, point, d)) {
                (None, None) => absorbed += 1,
                (Some(fast), Some(slow)) => {
                    assert_eq!(fast.mirrors, slow.mirrors, "{parameters:?} {point:?} {d:?}");
                    assert_eq!(fast.class, slow.class);
                    most = most.max(slow.mirrors[0]);
                    // The promise is 1e-9 mm.
                    let off = (fast.exit_point - slow.exit_point).length();
                    assert!(off < 1e-9, "{off} {parameters:?} {point:?} {d:?}");
                    // The walk's direction gathers a few ulp at each mirror and, towards grazing
                    // exits, a factor 1 / cos of at most 50.
                    assert!((fast.direction - slow.direction).length() < 1e-11);
                    for c in 0..3 {
                        assert!((fast.weight[c] - slow.weight[c]).abs() < 1e-11);
                    }
                }
                (fast, slow) => panic!("{fast:?} {slow:?} {parameters:?} {point:?} {d:?}"),
            }
        }
    }
    // The sample covers what it is meant to cover.
    assert!(rays > 1_000_000 && absorbed > 50_000 && most > 20, "{rays} {absorbed} {most}");
}

#[test]
fn light_leaves_the_way_it_came() {
    let mut random = Random(2);
    let mut returned = 0;
    for _ in 0..100 {
        let parameters = random.plate();
        let plate = SlitMirrorPlate::new(parameters).unwrap();
        for _ in 0..500 {
            let d = random.direction();
            let entry = Vec3::new(
                random.between(-9.0, 9.0),
                random.between(-9.0, 9.0),
                -d.z.signum() * 0.5 * parameters.thickness(),
            );
            let Some(there) = plate.pass(entry, d) else { continue };
            // Light leaves a layer between its mirrors, so the way back meets no mirror's end.
            let back = plate.pass(there.exit_point, -there.direction).unwrap();
            assert_eq!(back.mirrors, there.mirrors);
            assert!((back.exit_point - entry).length() < 1e-11);
            assert!((back.direction + d).length() < 1e-14);
            for c in 0..3 {
                assert!((back.weight[c] - there.weight[c]).abs() < 1e-14);
            }
            returned += 1;
        }
    }
    assert!(returned > 30_000, "{returned}");
}

#[test]
fn any_point_of_the_ray_will_do() {
    let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
    let mut random = Random(3);
    for _ in 0..1000 {
        let d = random.direction();
        let point = Vec3::new(random.between(-9.0, 9.0), random.between(-9.0, 9.0), 0.0);
        let (a, b) = (plate.pass(point, d).unwrap(), plate.pass(point - d * 300.0, d).unwrap());
        assert_eq!(a.mirrors, b.mirrors);
        assert!((a.exit_point - b.exit_point).length() < 1e-10);
    }
}

#[test]
fn real_light_takes_the_ideal_plates_direction_and_through_light_its_own() {
    let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
    let mut random = Random(4);
    let n = Vec3::new(0.0, 0.0, 1.0);
    for _ in 0..10_000 {
        let d = random.direction();
        let point = Vec3::new(random.between(-9.0, 9.0), random.between(-9.0, 9.0), 0.0);
        let passage = plate.pass(point, d).unwrap();
        match passage.class {
            Class::Real => assert!((passage.direction - pass_ideal(d, n)).length() < 1e-15),
            Class::Through => assert!((passage.direction - d).length() < 1e-15),
            Class::Stray => {
                let (out, into) = (passage.direction, d);
                let across = |v: Vec3| plate.across([v.x, v.y]);
                for layer in 0..2 {
                    let sign = if passage.mirrors[layer] % 2 == 1 { -1.0 } else { 1.0 };
                    assert!((across(out)[layer] - sign * across(into)[layer]).abs() < 1e-15);
                }
                assert_eq!(out.z, into.z);
            }
        }
    }
}

/// The exact form of "the image lies at the plane-symmetric place". Across layer 0's mirrors a
/// real ray from a point source at distance L before the near face comes back to the source's
/// coordinate, but for less than one pitch, at L - h deflection / slope behind the far face (met
/// first) or at L + h deflection / slope (met second): mirrors act as if in mid-layer.
#[test]
fn a_points_image_is_sharp_to_one_pitch_at_the_plane_symmetric_place() {
    let mut random = Random(5);
    let n_rays = 20_000;
    for _ in 0..20 {
        let parameters = SlitMirror { mirror_thickness: 0.0, ..random.plate() };
        let plate = SlitMirrorPlate::new(parameters).unwrap();
        let distance = random.between(20.0, 300.0);
        let half = 0.5 * parameters.thickness();
        let source =
            Vec3::new(random.between(-9.0, 9.0), random.between(-9.0, 9.0), -half - distance);
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for _ in 0..n_rays {
            let d = random.direction();
            let d = Vec3::new(d.x, d.y, d.z.abs());
            let passage = plate.pass(source, d).unwrap();
            if passage.class != Class::Real {
                continue;
            }
            let cos_t = (1.0 - (1.0 - d.z * d.z) / parameters.ior.powi(2)).sqrt();
            let deflection_per_slope = d.z / (parameters.ior * cos_t);
            let shift = parameters.layer_depth * deflection_per_slope;
            // Upwards, layer 1 is met first.
            for (layer, behind) in [(1, distance - shift), (0, distance + shift)] {
                let at = passage.exit_point + passage.direction * (behind / d.z);
                let off = plate.across([at.x - source.x, at.y - source.y])[layer];
                assert!(off.abs() <= parameters.pitch * (1.0 + 1e-9), "{off} {parameters:?}");
                sum[layer] += off / parameters.pitch;
            }
            count += 1.0;
        }
        // Unbiased: offsets within one pitch have a deviation below 1, so the mean of `count`
        // of them stays within 5 / sqrt(count).
        assert!(count > 500.0);
        for mean in sum.map(|s| s / count) {
            assert!(mean.abs() < 5.0 / count.sqrt(), "{mean} of {count}");
        }
    }
}

/// Without the detail: the point nearest to all real rays is the mirror image of the source.
#[test]
fn real_rays_from_a_point_converge_in_its_mirror_image() {
    let parameters = SlitMirror::default();
    let plate = SlitMirrorPlate::new(parameters).unwrap();
    let mut random = Random(6);
    let source = Vec3::new(3.0, -2.0, -150.0);
    // Least squares: sum over rays of (I - d d^T) (x - p) = 0, solved by Cramer's rule.
    let (mut m, mut rhs) = ([[0.0; 3]; 3], [0.0; 3]);
    let mut count = 0;
    while count < 50_000 {
        let z = random.between(0.6, 0.85);
        let (r, around) = ((1.0 - z * z).sqrt(), random.between(0.0, std::f64::consts::TAU));
        let d = Vec3::new(r * around.cos(), r * around.sin(), z);
        let passage = plate.pass(source, d).unwrap();
        if passage.class != Class::Real {
            continue;
        }
        count += 1;
        let (p, d) = (passage.exit_point.to_array(), passage.direction.to_array());
        for i in 0..3 {
            for j in 0..3 {
                let a = f64::from(i == j) - d[i] * d[j];
                m[i][j] += a;
                rhs[i] += a * p[j];
            }
        }
    }
    let column = |j: usize| Vec3::new(m[0][j], m[1][j], m[2][j]);
    let rhs = Vec3::from_array(rhs);
    let determinant = |a: Vec3, b: Vec3, c: Vec3| a.dot(b.cross(c));
    let (a, b, c) = (column(0), column(1), column(2));
    let whole = determinant(a, b, c);
    let point = Vec3::new(
        determinant(rhs, b, c) / whole,
        determinant(a, rhs, c) / whole,
        determinant(a, b, rhs) / whole,
    );
    // Offsets within a pitch of 0.5 mm, averaged over 50 000 rays: some thousandths of a mm.
    assert!((point - Vec3::new(3.0, -2.0, 150.0)).length() < 0.02, "{point:?}");
}

#[test]
fn impossible_plates_are_refused_by_name() {
    let good = SlitMirror::default();
    let cases = [
        ("pitch", SlitMirror { pitch: 0.0, ..good }),
        ("pitch", SlitMirror { pitch: f64::NAN, ..good }),
        ("layer_depth", SlitMirror { layer_depth: -1.0, ..good }),
        ("azimuth", SlitMirror { azimuth: f64::INFINITY, ..good }),
        ("reflectance", SlitMirror { reflectance: [0.9, 1.1, 0.9], ..good }),
        ("ior", SlitMirror { ior: 0.9, ..good }),
        ("absorption", SlitMirror { absorption: [0.0, 0.0, -0.1], ..good }),
        ("cover_glass", SlitMirror { cover_glass: -0.1, ..good }),
        ("mirror_thickness", SlitMirror { mirror_thickness: 0.5, ..good }),
    ];
    for (key, parameters) in cases {
        let error = SlitMirrorPlate::new(parameters).unwrap_err();
        assert_eq!(error.key, key);
        assert!(error.to_string().contains(key));
    }
}

#[test]
fn rays_along_the_plate_and_rays_of_nan_do_not_pass() {
    let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
    let along = Vec3::new(1.0, 0.0, 0.0);
    assert_eq!(plate.pass(Vec3::ZERO, along), None);
    assert_eq!(plate.pass(Vec3::ZERO, Vec3::new(f64::NAN, 0.0, 1.0)), None);
    assert_eq!(plate.pass(Vec3::new(0.0, f64::NAN, 0.0), Vec3::new(0.0, 0.0, 1.0)), None);
}

#[test]
fn the_default_plate_is_four_millimetres_thick() {
    assert_eq!(SlitMirror::default().thickness(), 4.0);
}
