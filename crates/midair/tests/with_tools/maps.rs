//! Maps in the hands of the tools they are for: the tool's own output against the map's meaning.

use midair::map::format::{Format, decode_channels, read_map, write_channels, write_map};
use midair::map::{Map, Status, bleed, reversed};
use midair::picture::{Drive, Filter, LightFrame, Warp};
use std::process::Command;

pub const SOURCE: [usize; 2] = [61, 47];

fn run(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{command:?}\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// A map that bends, magnifies, minifies, reaches the source's edges and has holes.
pub fn bent_map() -> Map {
    let mut map = Map::identity(83, 59);
    for i in 0..map.uv.len() {
        let [s, t] = map.uv[i];
        map.uv[i] = [s * s * (1.5 - 0.5 * s), t + 0.1 * (6.0 * s).sin() * t * (1.0 - t)];
        if i % 11 == 5 || (s - 0.5).hypot(t - 0.4) < 0.1 {
            (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Blocked);
        }
    }
    map
}

fn source_picture() -> image::RgbImage {
    image::RgbImage::from_fn(SOURCE[0] as u32, SOURCE[1] as u32, |x, y| {
        let code = (x + 61 * y).wrapping_mul(2_654_435_761);
        image::Rgb([(code >> 24) as u8, (code >> 16) as u8, (code >> 8) as u8])
    })
}

/// The source at an image point by bilinear interpolation, the edge going on beyond it.
fn bilinear(source: &image::RgbImage, [u, v]: [f64; 2], channel: usize) -> f64 {
    let (width, height) = (f64::from(source.width()), f64::from(source.height()));
    let (x, y) = (u * width - 0.5, (1.0 - v) * height - 0.5);
    let at = |x: f64, y: f64| {
        let (x, y) = (x.clamp(0.0, width - 1.0), y.clamp(0.0, height - 1.0));
        f64::from(source.get_pixel(x as u32, y as u32).0[channel])
    };
    let (i, j) = (x.floor(), y.floor());
    let (fx, fy) = (x - i, y - j);
    (1.0 - fy) * ((1.0 - fx) * at(i, j) + fx * at(i + 1.0, j))
        + fy * ((1.0 - fx) * at(i, j + 1.0) + fx * at(i + 1.0, j + 1.0))
}

#[test]
fn opencv_remaps_as_the_map_says() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let source = source_picture();
    source.save(at("source.png")).unwrap();
    let script = "
import cv2, numpy, sys
folder = sys.argv[1] + '/'
source = cv2.imread(folder + 'source.png').astype(numpy.float32)
x, y = numpy.load(folder + 'm_x.npy'), numpy.load(folder + 'm_y.npy')
assert x.dtype == y.dtype == numpy.float32
storage = cv2.FileStorage(folder + 'm.yml', cv2.FILE_STORAGE_READ)
for name, array in ('map1', x), ('map2', y):
    assert numpy.array_equal(storage.getNode(name).mat(), array, equal_nan=True), name
assert storage.getNode('source_width').real() == source.shape[1]
result = cv2.remap(source, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
# In the codes of the map: an answer is wherever x is a number.
result[numpy.isnan(x)] = 0
cv2.imwrite(folder + 'result.png', numpy.rint(result * 257).astype(numpy.uint16))
storage = cv2.FileStorage(folder + 'theirs.yml', cv2.FILE_STORAGE_WRITE)
storage.write('map1', x); storage.write('map2', y); storage.release()
";
    for map in [bent_map(), Map::identity(SOURCE[0], SOURCE[1])] {
        write_map(&map, SOURCE, Format::OpenCv, &at("m.npy")).unwrap();
        write_map(&map, SOURCE, Format::OpenCvYaml, &at("m.yml")).unwrap();
        run(Command::new(&python).args(["-c", script]).arg(folder.path()));
        let result = image::open(at("result.png")).unwrap().into_rgb16();
        // OpenCV's weights are multiples of 1/32 px: each coordinate is off by up to 1/64, and codes
        // differ by up to 255 between neighbours. The identity has no fractions and must be exact.
        let identity = map.width == SOURCE[0];
        let tolerance = if identity { 0.0 } else { 2.0 * 255.0 / 64.0 };
        for (i, uv) in map.uv.iter().enumerate() {
            let pixel = result.get_pixel((i % map.width) as u32, (i / map.width) as u32);
            for channel in 0..3 {
                let theirs = f64::from(pixel.0[channel]) / 257.0;
                let ours = if uv[0].is_nan() {
                    0.0
                } else if identity {
                    f64::from(source.get_pixel((i % 61) as u32, (i / 61) as u32).0[channel])
                } else {
                    bilinear(&source, *uv, channel)
                };
                // One 16-bit step of the result file.
                assert!((theirs - ours).abs() <= tolerance + 1.0 / 257.0, "{i}: {theirs} {ours}");
            }
        }
        // And the other way round: what OpenCV writes is read.
        let back = read_map(&at("theirs.yml"), None, Some(SOURCE)).unwrap().map;
        for (told, uv) in back.uv.iter().zip(&map.uv) {
            assert_eq!(told[0].is_nan(), uv[0].is_nan());
            // OpenCV prints floats with 8 or 9 digits: below 100 px that is 1e-6 px.
            assert!(uv[0].is_nan() || (0..2).all(|c| (told[c] - uv[c]).abs() < 1e-6 / 47.0 * 4.0));
        }
    }
}

#[test]
fn numpy_reads_the_arrays_as_documented() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    write_map(&bent_map(), SOURCE, Format::Npy, &folder.path().join("map.npy")).unwrap();
    let script = "
import numpy, sys
uv, status = numpy.load(sys.argv[1] + '/map.npy'), numpy.load(sys.argv[1] + '/status.npy')
assert uv.shape == (59, 83, 2) and uv.dtype == numpy.float64, (uv.shape, uv.dtype)
assert status.shape == (59, 83) and status.dtype == numpy.uint8
assert numpy.array_equal(numpy.isnan(uv[..., 0]), status >= 2)
assert uv[0, 40, 1] > uv[-1, 40, 1]
";
    run(Command::new(&python).args(["-c", script]).arg(folder.path()));
}

#[test]
fn ffmpeg_remaps_as_the_map_says() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let source = source_picture();
    source.save(at("source.png")).unwrap();
    for map in [bent_map(), Map::identity(SOURCE[0], SOURCE[1])] {
        write_map(&map, SOURCE, Format::Ffmpeg, &at("m.pgm")).unwrap();
        run(Command::new("ffmpeg")
            .args(["-v", "error", "-y", "-i"])
            .arg(at("source.png"))
            .arg("-i")
            .arg(at("m_x.pgm"))
            .arg("-i")
            .arg(at("m_y.pgm"))
            .args(["-lavfi", "remap=fill=black", "-pix_fmt", "rgb24"])
            .arg(at("result.png")));
        let result = image::open(at("result.png")).unwrap().into_rgb8();
        assert_eq!((result.width() as usize, result.height() as usize), (map.width, map.height));
        for (i, uv) in map.uv.iter().enumerate() {
            let theirs = *result.get_pixel((i % map.width) as u32, (i / map.width) as u32);
            let ours = if uv[0].is_nan() {
                image::Rgb([0; 3])
            } else {
                // The source pixel that holds the point.
                let column = (uv[0] * 61.0) as u32;
                let row = ((1.0 - uv[1]) * 47.0) as u32;
                *source.get_pixel(column.min(60), row.min(46))
            };
            assert_eq!(theirs, ours, "pixel {i}");
        }
    }
}

/// The forward map in OpenCV's hands turns what the display shows back into the picture.
#[test]
fn opencv_undoes_the_map_with_its_reverse() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let size = [300, 240];
    let mut map = Map::identity(320, 260);
    for uv in &mut map.uv {
        let [s, t] = *uv;
        // Onto the whole picture and a little past its edges.
        *uv = [1.04 * s * (0.7 + 0.3 * s) - 0.02, t + 0.1 * (6.0 * s).sin() * t * (1.0 - t)];
    }
    let picture = image::RgbImage::from_fn(size[0] as u32, size[1] as u32, |x, y| {
        let wave = |a: f64, b: f64| {
            (127.5 + 120.0 * (a * f64::from(x)).sin() * (b * f64::from(y)).cos()).round() as u8
        };
        image::Rgb([wave(0.05, 0.06), wave(0.03, 0.02), wave(0.07, 0.03)])
    });
    let warp = Warp::new(&map, size, Filter::Bilinear).unwrap();
    let mut display = vec![0; 320 * 260 * 3];
    let mut light = LightFrame::default();
    light.decode(picture.as_raw(), 3).unwrap();
    warp.apply_light(&light, 3, &Drive::default(), &mut display).unwrap();
    image::RgbImage::from_raw(320, 260, display).unwrap().save(at("display.png")).unwrap();
    let forward = bleed(&reversed(&map, size), 1);
    write_map(&forward, [320, 260], Format::OpenCv, &at("f.npy")).unwrap();
    let script = "
import cv2, numpy, sys
folder = sys.argv[1] + '/'
x, y = numpy.load(folder + 'f_x.npy'), numpy.load(folder + 'f_y.npy')
seen = cv2.remap(cv2.imread(folder + 'display.png'), x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
cv2.imwrite(folder + 'seen.png', seen)
";
    run(Command::new(&python).args(["-c", script]).arg(folder.path()));
    let seen = image::open(at("seen.png")).unwrap().into_rgb8();
    let mut compared = 0;
    for (i, status) in forward.status.iter().enumerate() {
        let (x, y) = ((i % 300) as u32, (i / 300) as u32);
        if *status == Status::Ok && (3..297).contains(&x) && (3..237).contains(&y) {
            for c in 0..3 {
                let (a, b) = (seen.get_pixel(x, y).0[c], picture.get_pixel(x, y).0[c]);
                // Twice the bilinear error h^2 / 8 * f'' = (0.07^2 + 0.06^2) * 120 / 8 = 0.13 codes, OpenCV's 1/64 px
                // times slopes of 8 codes a pixel, twice half a code of rounding. Between two pixels the mean of light is by 8^2 / 8 codes
                // times 1.4 / (code + 14), the curve's bend, above the mean of codes: a tenth at mid grey.
                assert!(a.abs_diff(b) <= 2, "{x} {y}: {a} {b}");
            }
            compared += 1;
        }
    }
    assert!(compared > 60_000, "{compared}");
}

/// Blender's compositor, by the Python with `bpy` that the set-up of the tests makes, or the one that MIDAIR_BPY_PYTHON names.
#[test]
fn blender_maps_uv_as_the_map_says() {
    let Some(python) = midair_peers::blender() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let size = [96, 64];
    let wave = |u: f64, v: f64| {
        [0.5 + 0.4 * (5.0 * u).sin(), 0.5 + 0.4 * (4.0 * v).cos(), 0.2 + 0.6 * u * v]
    };
    let pixels: Vec<[f64; 3]> =
        Map::identity(size[0], size[1]).uv.iter().map(|uv| wave(uv[0], uv[1])).collect();
    let channel = |c: usize| pixels.iter().map(|pixel| pixel[c] as f32).collect();
    write_channels(
        &at("picture.exr"),
        size[0],
        size[1],
        vec![("R", channel(0)), ("G", channel(1)), ("B", channel(2))],
        false,
    )
    .unwrap();
    let mut map = Map::identity(size[0], size[1]);
    for i in 0..map.uv.len() {
        let [s, t] = map.uv[i];
        map.uv[i] = [0.1 + 0.7 * s * (0.8 + 0.2 * s), 0.15 + 0.6 * t + 0.1 * s];
        if i % 96 > 70 {
            (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Blocked);
        }
    }
    write_map(&map, size, Format::Blender, &at("map.exr")).unwrap();
    let script = "
import bpy, sys
folder = sys.argv[1] + '/'
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 64, 100
scene.view_settings.view_transform = 'Raw'
scene.render.image_settings.file_format = 'OPEN_EXR'
scene.render.image_settings.color_depth = '32'
scene.render.filepath = folder + 'result.exr'
scene.use_nodes = True
tree = scene.node_tree
tree.nodes.clear()
def node(kind, file=None, colours='Non-Color'):
    made = tree.nodes.new(kind)
    if file:
        made.image = bpy.data.images.load(folder + file)
        made.image.colorspace_settings.name = colours
    return made
picture, uv = node('CompositorNodeImage', 'picture.exr'), node('CompositorNodeImage', 'map.exr')
remap, out = node('CompositorNodeMapUV'), node('CompositorNodeComposite')
remap.filter_type = 'NEAREST'  # its other filter is a blur of its own kind
tree.links.new(picture.outputs['Image'], remap.inputs['Image'])
tree.links.new(uv.outputs['Image'], remap.inputs['UV'])
tree.links.new(remap.outputs['Image'], out.inputs['Image'])
bpy.ops.render.render(write_still=True)
";
    run(Command::new(&python).args(["-c", script]).arg(folder.path()));
    let bytes = std::fs::read(at("result.exr")).unwrap();
    let result = decode_channels(&at("result.exr"), &bytes, 0.0).unwrap();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        let result = result.get(name).unwrap();
        for (i, uv) in map.uv.iter().enumerate() {
            let theirs = f64::from(result[i]);
            if uv[0].is_nan() {
                assert_eq!(theirs, 0.0, "{i}");
            } else {
                // The picture's pixel that holds the point, or a neighbour's where that is a matter of float32.
                let near = [-1e-3, 1e-3].map(|slack| {
                    let x = (uv[0] * size[0] as f64 + slack) as usize;
                    let y = ((1.0 - uv[1]) * size[1] as f64 + slack) as usize;
                    [x, y]
                });
                let held = near.iter().flat_map(|a| near.iter().map(move |b| [a[0], b[1]]));
                let ours = held.map(|[x, y]| pixels[y * size[0] + x][c] as f32);
                assert!(
                    ours.into_iter().any(|ours| (theirs - f64::from(ours)).abs() < 1e-6),
                    "{name} {i}: {theirs}"
                );
            }
        }
    }
}
