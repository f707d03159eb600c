//! Views of the paper's scenes without compensation, against the transport's own prediction.

use super::*;
use crate::compensate::uncompensated_map;
use crate::geometry::Vec3;
use crate::picture::display_image;
use crate::scene::load;
use crate::simulate::{Camera, Light, Settings, Viewer, render};
use crate::transport::{Path, Setup};

/// The eye carried about the vertical through `centre`, degrees.
fn carried(eye: Vec3, centre: Vec3, azimuth: f64) -> Vec3 {
    let (sin, cos) = azimuth.to_radians().sin_cos();
    let from = eye - centre;
    centre + Vec3::new(cos * from.x + sin * from.z, from.y, cos * from.z - sin * from.x)
}

/// Where the line of sight reaches the display point `st`, by Newton's method from the nearest of a grid of places.
fn seen_at(setup: &Setup, st: [f64; 2]) -> Option<[f64; 2]> {
    let error = |uv: [f64; 2]| {
        let [s, t] = setup.transport(uv, &mut Path::new()).st()?;
        Some([s - st[0], t - st[1]])
    };
    let off = |uv: &[f64; 2]| error(*uv).map_or(f64::INFINITY, |[s, t]| s.hypot(t));
    let grid = (0..31 * 31).map(|k| [k % 31, k / 31].map(|k| f64::from(k) / 15.0 - 0.5));
    let mut uv = grid.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    for _ in 0..30 {
        let h = 1e-5;
        let (e, a, b) = (error(uv)?, error([uv[0] + h, uv[1]])?, error([uv[0], uv[1] + h])?);
        if e[0].hypot(e[1]) < 1e-9 {
            return setup.transport(uv, &mut Path::new()).formed().map(|_| uv);
        }
        let [ss, ts, st, tt] = [a[0] - e[0], a[1] - e[1], b[0] - e[0], b[1] - e[1]].map(|d| d / h);
        let determinant = ss * tt - st * ts;
        uv[0] -= (tt * e[0] - st * e[1]) / determinant;
        uv[1] -= (ss * e[1] - ts * e[0]) / determinant;
    }
    None
}

/// Every intersection that is found lies where the transport says: periods are 20 pixels and more, and its name is taken from a third of one.
#[test]
fn intersections_are_found_where_the_transport_predicts_them() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper");
    // How many were found when this was written, less two that noise may decide.
    let cases = [
        ("cube", 0.0, 47),
        ("cube", 15.0, 47),
        ("bent-mirror-convex", 0.0, 37),
        ("bent-mirror-concave", -15.0, 33),
        ("bent-mirror-concave", 0.0, 47),
        ("bent-mirror-concave", 15.0, 31),
    ];
    let style = LatticeStyle { line_width: 0.02, overhang: 0.08, ..Default::default() };
    for (name, azimuth, least) in cases {
        let loaded = load(&root.join(format!("{name}.toml"))).unwrap();
        let mut setup = Setup::new(&loaded).unwrap();
        setup.display = setup.display_place();
        setup.resolution = [768, 768];
        let map = uncompensated_map(&setup);
        let shown = display_image(&draw_lattice(768, 768, &style).unwrap(), &map);
        setup.viewpoint = carried(setup.viewpoint, setup.image.frame.origin, azimuth);
        let camera =
            Camera { eye: setup.viewpoint, size: [480, 480], window: 1.8, supersampling: 1 };
        let viewer = Viewer { camera, aperture: 0.0, focus: None };
        let settings = Settings { samples_per_pixel: 16, seed: 0 };
        let view = render(&setup, &shown, &viewer, &settings, &(), &mut |_| ()).unwrap();
        // Behind one mirror the display shows the image the other way round.
        let belongs = style.intersections_uv().into_iter().map(|[u, v]| {
            let st = if name == "cube" { [u, v] } else { [1.0 - u, v] };
            seen_at(&setup, st).map(|uv| camera.view_position(uv))
        });
        let belongs: Vec<_> = belongs.collect();
        let found = detect_at(&Plane::luminance(&view.view(Light::Real)), 7, &belongs).unwrap();
        let mut squares = Vec::new();
        for (point, belongs) in found.points().iter().zip(&belongs) {
            let Some([x, y]) = *point else { continue };
            let belongs = belongs.unwrap();
            let off = (x - belongs[0]).hypot(y - belongs[1]);
            // Seen: 0.13 on the cube, whose edge cuts a column; 0.09 on the mirrors.
            assert!(off < 0.16, "{name} {azimuth}: {x} {y} is {off} off");
            squares.push(off * off);
        }
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(error <= 0.05, "{name} {azimuth}: {error}");
        assert!(squares.len() >= least, "{name} {azimuth}: {} found", squares.len());
    }
}
