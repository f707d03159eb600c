//! Pictures as other programs write them, read as these programs see them: Pillow (LittleCMS), tifffile, OpenEXR's own library.

use midair::map::format::{Format, read_map};
use midair::picture::{is_picture_name, read_still, srgb};
use std::path::Path;
use std::process::Command;

fn run(python: &Path, script: &str, folder: &Path) {
    let output = Command::new(python).args(["-c", script]).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for file in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if is_picture_name(&file) {
            midair_peers::corpus::keep("pictures", &[&std::fs::read(&file).unwrap()]);
        }
    }
}

/// The codes that a display of sRGB is sent for a still.
fn codes(path: &Path) -> Vec<[u8; 3]> {
    let still = read_still(path).unwrap();
    still.picture.pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(srgb::encode_8)).collect()
}

#[test]
fn profiles_give_what_littlecms_gives() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // Display P3 with sRGB's curve and Adobe RGB with gamma 2.2, built chunk by chunk (ICC.1:2010): s15Fixed16 numbers, D50-adapted colorants.
    let script = "
import struct, numpy, io
from PIL import Image, ImageCms
def xyz(x, y, z): return b'XYZ ' + bytes(4) + struct.pack('>3i', *(round(v * 65536) for v in (x, y, z)))
def gamma(g): return b'curv' + bytes(4) + struct.pack('>I', 1) + struct.pack('>H', round(g * 256)) + bytes(2)
def text(t): return b'desc' + bytes(4) + struct.pack('>I', len(t) + 1) + t.encode() + b'\\0' + bytes(78)
def para(): return b'para' + bytes(4) + struct.pack('>HH5i', 3, 0, *(round(v * 65536) for v in (2.4, 1/1.055, .055/1.055, 1/12.92, .04045)))
def profile(colorants, curve, name):
    tags = [(b'desc', text(name)), (b'cprt', b'text' + bytes(4) + b'none\\0\\0\\0\\0'), (b'wtpt', xyz(.9642, 1, .8249))]
    tags += [(t, xyz(*c)) for t, c in zip((b'rXYZ', b'gXYZ', b'bXYZ'), colorants)]
    tags += [(t, curve) for t in (b'rTRC', b'gTRC', b'bTRC')]
    body, table, at = b'', b'', 128 + 4 + 12 * len(tags)
    for tag, data in tags:
        data += bytes(-len(data) % 4)
        table += tag + struct.pack('>II', at + len(body), len(data))
        body += data
    size = at + len(body)
    head = struct.pack('>I4sI4s4s4s', size, b'none', 0x02400000, b'mntr', b'RGB ', b'XYZ ') + struct.pack('>6H', 2020, 1, 1, 0, 0, 0) + b'acsp' + bytes(28) + struct.pack('>3i', round(.9642*65536), 65536, round(.8249*65536)) + bytes(48)
    return head[:128] + struct.pack('>I', len(tags)) + table + body
p3 = profile([(.51512, .24120, -.00105), (.29198, .69225, .04189), (.15710, .06657, .78407)], para(), 'A phone')
adobe = profile([(.60974, .31111, .01947), (.20528, .62567, .06087), (.14919, .06322, .74457)], gamma(2.19921875), 'A camera')
levels = numpy.array([0, 20, 60, 110, 170, 220, 255], numpy.uint8)
cube = numpy.stack(numpy.meshgrid(levels, levels, levels, indexing='ij'), -1).reshape(7, 49, 3)
image = Image.fromarray(cube)
blocks = Image.fromarray(numpy.kron(cube, numpy.ones((16, 16, 1), numpy.uint8)))
srgb = ImageCms.createProfile('sRGB')
for name, data in (('p3', p3), ('adobe', adobe)):
    for kind in ('png', 'tiff', 'webp'):
        image.save(f'{name}.{kind}', icc_profile=data, **({'lossless': True} if kind == 'webp' else {}))
    blocks.save(f'{name}.jpg', icc_profile=data, quality=100, subsampling=0)
    def seen(image):
        source = ImageCms.ImageCmsProfile(io.BytesIO(data))
        return ImageCms.profileToProfile(image, source, srgb, renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC, outputMode='RGB')
    numpy.asarray(seen(image)).tofile(name + '.raw')
    numpy.asarray(seen(Image.open(name + '.jpg'))).tofile(name + '-jpg.raw')
";
    run(&python, script, folder.path());
    for name in ["p3", "adobe"] {
        for kind in ["png", "tiff", "webp", "jpg"] {
            let raw = if kind == "jpg" { format!("{name}-jpg.raw") } else { format!("{name}.raw") };
            let raw = std::fs::read(at(&raw)).unwrap();
            let ours = codes(&at(&format!("{name}.{kind}")));
            assert_eq!(ours.len() * 3, raw.len(), "{name}.{kind}");
            // LittleCMS rounds curves to 16 bits and its matrix to 15; JPEG decoders differ by one code, which the matrix makes 1.3.
            let worst = if kind == "jpg" { 3 } else { 1 };
            let mut moved = 0;
            for (ours, theirs) in ours.as_flattened().iter().zip(&raw) {
                assert!(ours.abs_diff(*theirs) <= worst, "{name}.{kind}: {ours} {theirs}");
                moved += usize::from(ours != theirs);
            }
            assert!(kind == "jpg" || moved * 20 < raw.len(), "{name}.{kind}: {moved} differ");
        }
    }
}

#[test]
fn pictures_of_pillow_and_tifffile_are_as_they_see_them() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let script = "
import numpy, tifffile
from PIL import Image
rng = numpy.random.default_rng(1)
rgb = rng.integers(0, 256, (23, 31, 3), numpy.uint8)
image = Image.fromarray(rgb)
rgb.tofile('rgb.raw')
image.save('a.bmp'); image.save('lzw.tiff', compression='tiff_lzw'); image.save('deflate.tif', compression='tiff_deflate'); image.save('a.webp', lossless=True)
image.save('packbits.tif', compression='packbits')
tifffile.imwrite('big.tif', rgb, photometric='rgb', bigtiff=True)
tifffile.imwrite('planes.tif', rgb, photometric='rgb', planarconfig='separate')
more = Image.fromarray(rgb[::-1].copy())
image.save('pages.tif', save_all=True, append_images=[more])
for kind in ('png', 'webp'):
    image.save(f'moves.{kind}', save_all=True, append_images=[more], **({'lossless': True} if kind == 'webp' else {}))
image.convert('P', palette=Image.Palette.ADAPTIVE).save('palette.bmp')
numpy.asarray(Image.open('palette.bmp').convert('RGB')).tofile('palette.raw')
for k in range(1, 9):
    exif = Image.Exif(); exif[0x0112] = k
    from PIL import ImageOps
    wide = numpy.kron(rgb[:4, :6], numpy.ones((16, 16, 1), numpy.uint8))
    Image.fromarray(wide).save(f'turned{k}.png', exif=exif)
    Image.fromarray(wide).save(f'turned{k}.tiff', exif=exif, compression='tiff_lzw')
    Image.fromarray(wide).save(f'turned{k}.webp', exif=exif, lossless=True)
    numpy.asarray(ImageOps.exif_transpose(Image.open(f'turned{k}.png'))).tofile(f'turned{k}.raw')
deep = rng.integers(0, 65536, (9, 7, 3), numpy.uint16)
tifffile.imwrite('deep.tiff', deep, photometric='rgb'); (deep >> 8).astype(numpy.uint8)
deep.tofile('deep.raw')
light = rng.random((9, 7, 3), numpy.float32) * 2
tifffile.imwrite('light.tiff', light, photometric='rgb'); light.tofile('light.raw')
";
    run(&python, script, folder.path());
    let raw = |name: &str| std::fs::read(at(name)).unwrap();
    for name in ["a.bmp", "lzw.tiff", "deflate.tif", "packbits.tif", "a.webp", "big.tif"] {
        assert_eq!(codes(&at(name)).as_flattened(), raw("rgb.raw"), "{name}");
        assert!(read_still(&at(name)).unwrap().notes.is_empty(), "{name}");
    }
    for name in ["pages.tif", "moves.png", "moves.webp"] {
        assert_eq!(codes(&at(name)).as_flattened(), raw("rgb.raw"), "{name}");
        let notes = read_still(&at(name)).unwrap().notes;
        assert!(notes[0].contains("several pictures"), "{name}: {notes:?}");
    }
    let message = read_still(&at("planes.tif")).unwrap_err().to_string();
    assert!(message.contains("plane by plane") && message.contains("side by side"), "{message}");
    assert_eq!(codes(&at("palette.bmp")).as_flattened(), raw("palette.raw"));
    for turn in 1..=8 {
        for kind in ["png", "tiff", "webp"] {
            let name = format!("turned{turn}.{kind}");
            assert_eq!(
                codes(&at(&name)).as_flattened(),
                raw(&format!("turned{turn}.raw")),
                "{name}"
            );
        }
    }
    let deep = read_still(&at("deep.tiff")).unwrap().picture;
    let light = read_still(&at("light.tiff")).unwrap().picture;
    let deep_raw = raw("deep.raw");
    let light_raw = raw("light.raw");
    for i in 0..63 {
        for c in 0..3 {
            let at = 3 * i + c;
            let code = u16::from_le_bytes(deep_raw.as_chunks::<2>().0[at]);
            assert_eq!(srgb::encode_16(deep.pixels[i][c]), code);
            assert_eq!(light.pixels[i][c], f32::from_le_bytes(light_raw.as_chunks::<4>().0[at]));
        }
    }
}

#[test]
fn files_of_openexrs_own_library_are_read_whatever_their_layers() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let script = "
import OpenEXR, numpy
y, x = numpy.mgrid[0:40, 0:30].astype(numpy.float32)
r, g, b = x / 30 + 0.01, y / 40 + 0.02, (x + y) / 70
half = [c.astype(numpy.float16) for c in (r, g, b)]
numpy.stack([c.astype(numpy.float32) for c in half], -1).tofile('half.raw')
numpy.stack([r, g, b], -1).tofile('float.raw')
head = lambda c: {'compression': c, 'type': OpenEXR.scanlineimage}
for name, c in (('zip', OpenEXR.ZIP_COMPRESSION), ('zips', OpenEXR.ZIPS_COMPRESSION), ('rle', OpenEXR.RLE_COMPRESSION), ('piz', OpenEXR.PIZ_COMPRESSION), ('none', OpenEXR.NO_COMPRESSION)):
    OpenEXR.File(head(c), {'R': r, 'G': g, 'B': b}).write(f'float-{name}.exr')
    OpenEXR.File(head(c), {'RGB': numpy.stack(half, -1)}).write(f'half-{name}.exr')
layer = {'ViewLayer.Combined.R': r, 'ViewLayer.Combined.G': g, 'ViewLayer.Combined.B': b, 'ViewLayer.Depth.Z': x, 'ViewLayer.Normal.X': x, 'ViewLayer.Normal.Y': x, 'ViewLayer.Normal.Z': x}
OpenEXR.File(head(OpenEXR.ZIP_COMPRESSION), layer).write('float-blender.exr')
parts = [OpenEXR.Part(head(OpenEXR.ZIP_COMPRESSION), {'Z': x}, name='depth'), OpenEXR.Part(head(OpenEXR.ZIP_COMPRESSION), {'R': r, 'G': g, 'B': b}, name='rgba')]
OpenEXR.File(parts).write('float-part.exr')
zero = numpy.zeros_like(r)
OpenEXR.File(head(OpenEXR.ZIP_COMPRESSION), {'R': zero, 'G': zero, 'B': zero, 'A': zero, 'forward.u': r, 'forward.v': g}).write('nuke.exr')
";
    run(&python, script, folder.path());
    let mut compared = 0;
    for kind in ["float", "half"] {
        let raw = std::fs::read(at(&format!("{kind}.raw"))).unwrap();
        let wanted: Vec<f32> =
            raw.as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
        for name in ["zip", "zips", "rle", "piz", "none", "blender", "part"] {
            let path = at(&format!("{kind}-{name}.exr"));
            if !path.exists() {
                continue;
            }
            let picture = read_still(&path).unwrap().picture;
            assert_eq!((picture.width, picture.height), (30, 40));
            let ours: Vec<f32> = picture.pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
            assert!(ours == wanted, "{}", path.display());
            compared += 1;
        }
    }
    assert_eq!(compared, 12);
    let map = read_map(&at("nuke.exr"), Some(Format::Exr), None).unwrap().map;
    let raw = std::fs::read(at("float.raw")).unwrap();
    let wanted = raw.as_chunks::<4>().0;
    for (i, uv) in map.uv.iter().enumerate() {
        for c in 0..2 {
            assert_eq!(uv[c] as f32, f32::from_le_bytes(wanted[3 * i + c]));
        }
    }
}

/// JPEG files of all forms that libjpeg writes: read when whole, refused when cut, an end put behind the cut or not.
#[test]
fn whole_jpegs_of_every_form_are_read_and_cut_ones_refused() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let script = "
import sys, numpy
from PIL import Image
folder = sys.argv[1] + '/'
noise = numpy.random.default_rng(1).integers(0, 256, (83, 117, 3), dtype=numpy.uint8)
ramp = numpy.linspace(0, 255, 83 * 117 * 3).astype(numpy.uint8).reshape(83, 117, 3)
for content, pixels in ('noise', noise), ('ramp', ramp):
    for progressive in False, True:
        for subsampling in 0, 1, 2:
            for restart in 0, 3:
                for mode in 'RGB', 'L':
                    name = f'{content}-{progressive}-{subsampling}-{restart}-{mode}.jpg'
                    Image.fromarray(pixels).convert(mode).save(folder + name, quality=85, progressive=progressive,
                        optimize=progressive, subsampling=subsampling, restart_marker_blocks=restart)
                    print(name)
";
    let output = Command::new(&python).args(["-c", script]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let (mut whole, mut cut) = (0, 0);
    for name in told.lines() {
        let path = folder.path().join(name);
        let picture = read_still(&path).unwrap_or_else(|error| panic!("{name}: {error}")).picture;
        assert_eq!([picture.width, picture.height], [117, 83]);
        whole += 1;
        let bytes = std::fs::read(&path).unwrap();
        let scans = bytes.windows(2).position(|pair| pair == [0xff, 0xda]).unwrap();
        for share in [0.0, 0.3, 0.6, 0.9, 0.98] {
            // Not within the marker that follows the last whole scan.
            let length = scans + 16 + ((bytes.len() - scans - 24) as f64 * share) as usize;
            for end in [&[][..], &[0xff, 0xd9]] {
                let file = folder.path().join("cut.jpg");
                std::fs::write(&file, [&bytes[..length], end].concat()).unwrap();
                // A progressive picture that lacks whole scans is coarse, and whole by its own account.
                let between = bytes[length..].starts_with(&[0xff, 0xc4])
                    || bytes[length..].starts_with(&[0xff, 0xda]);
                if !between {
                    let error =
                        read_still(&file).err().unwrap_or_else(|| panic!("{name} {length}"));
                    assert!(error.to_string().contains("cut.jpg"), "{error}");
                    cut += 1;
                }
            }
        }
    }
    assert!(whole == 48 && cut > 450, "{whole} {cut}");
}
