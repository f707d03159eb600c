//! Maps saved by other tools: each form of file is the same map.

use super::maps::{SOURCE, bent_map};
use midair::map::format::{Format, read_map, write_map};
use std::process::Command;

#[test]
fn opencv_s_storages_of_every_form_are_read() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let script = "
import cv2, numpy, sys
folder = sys.argv[1] + '/'
x, y = numpy.load(folder + 'm_x.npy'), numpy.load(folder + 'm_y.npy')
whole, fractions = cv2.convertMaps(numpy.nan_to_num(x, nan=-1), numpy.nan_to_num(y, nan=-1), cv2.CV_16SC2)
forms = {'pair': [('mapx', x), ('mapy', y)], 'both': [('map', numpy.dstack([x, y]))], 'fixed': [('map1', whole), ('map2', fractions)]}
for form, matrices in forms.items():
    for extension in 'yml', 'xml', 'json', 'yml.gz', 'xml.gz', 'json.gz':
        for how, flag in ('text', 0), ('base64', cv2.FILE_STORAGE_BASE64):
            if flag and extension.endswith('gz'):
                continue
            name = form + '-' + how + '.' + extension
            storage = cv2.FileStorage(folder + name, cv2.FILE_STORAGE_WRITE | flag)
            for key, matrix in matrices:
                storage.write(key, matrix)
            storage.release()
            print(name)
numpy.save(folder + 'map1.npy', whole)
numpy.save(folder + 'map2.npy', fractions)
numpy.save(folder + 'both.npy', numpy.dstack([x, y]).astype(numpy.float32))
numpy.save(folder + 'fortran.npy', numpy.asfortranarray(numpy.dstack([x, y])))
print('map1.npy')
print('both.npy')
print('fortran.npy')
";
    let map = bent_map();
    write_map(&map, SOURCE, Format::OpenCv, &folder.path().join("m.npy")).unwrap();
    let output = Command::new(&python).args(["-c", script]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let mut files = 0;
    for name in told.lines() {
        let format = name.ends_with("npy").then_some(Format::OpenCv);
        let back = read_map(&folder.path().join(name), format, Some(SOURCE)).unwrap().map;
        // Fixed coordinates are rounded to 1/32 px; floats up to 64 to 2^-19 px, and their texts of nine digits to 5e-8 px more.
        let fixed = name.contains("fixed") || name == "map1.npy";
        let step = if fixed { 0.5 / 32.0 / 47.0 + 1e-7 } else { (2f64.powi(-19) + 5e-8) / 47.0 };
        for (told, uv) in back.uv.iter().zip(&map.uv) {
            assert_eq!(told[0].is_nan(), uv[0].is_nan(), "{name}: {told:?} {uv:?}");
            if !uv[0].is_nan() {
                let off = (told[0] - uv[0]).abs().max((told[1] - uv[1]).abs());
                assert!(off <= step, "{name}: {off}");
            }
        }
        files += 1;
    }
    assert_eq!(files, 3 * (6 + 3) + 3);
}

/// The same map, opened and saved again by NumPy and OpenCV in the forms that they have.
#[test]
fn arrays_texts_and_pictures_saved_by_other_tools_are_the_same_map() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let map = bent_map();
    write_map(&map, SOURCE, Format::Npy, &at("map.npy")).unwrap();
    write_map(&map, SOURCE, Format::Png16, &at("map.png")).unwrap();
    write_map(&map, SOURCE, Format::Ffmpeg, &at("map.pgm")).unwrap();
    let script = "
import cv2, glob, numpy, os, sys
folder = sys.argv[1] + '/'
uv = numpy.load(folder + 'map.npy')
for name, array in [('half', uv.astype(numpy.float16)), ('single', uv.astype('<f4')), ('big', uv.astype('>f8')), ('fortran', numpy.asfortranarray(uv))]:
    numpy.save(folder + name + '.npy', array)
    print(name + '.npy')
assert cv2.imwrite(folder + 'again.png', cv2.imread(folder + 'map.png', cv2.IMREAD_UNCHANGED))
print('again.png')
twins = sorted(glob.glob(folder + 'map*.pgm'))
assert len(twins) == 2, twins
for twin in twins:
    name = os.path.basename(twin).replace('map', 'text')
    assert cv2.imwrite(folder + name, cv2.imread(twin, cv2.IMREAD_UNCHANGED), [cv2.IMWRITE_PXM_BINARY, 0])
    assert open(folder + name, 'rb').read(2) == b'P2'
print(os.path.basename(twins[0]).replace('map', 'text'))
";
    let output = Command::new(&python).args(["-c", script]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let names: Vec<&str> = told.lines().collect();
    assert_eq!(names.len(), 6);
    let as_written = |name: &str| read_map(&at(name), None, Some(SOURCE)).unwrap().map;
    for name in names {
        let back = read_map(&at(name), None, Some(SOURCE)).unwrap().map;
        // What the format itself makes of the map, and what fewer bits do to values up to 1.
        let (of, step) = match name {
            "half.npy" => ("map.npy", 2f64.powi(-12)),
            "single.npy" => ("map.npy", 2f64.powi(-25)),
            "big.npy" | "fortran.npy" => ("map.npy", 0.0),
            "again.png" => ("map.png", 0.0),
            _ => ("map.pgm", 0.0),
        };
        let wanted = match of {
            "map.pgm" => as_written(&name.replace("text", "map")),
            of => as_written(of),
        };
        let (mut compared, mut answered) = (0, 0);
        for (told, uv) in back.uv.iter().zip(&wanted.uv) {
            assert_eq!(told[0].is_nan(), uv[0].is_nan(), "{name}: {told:?} {uv:?}");
            compared += 1;
            if !uv[0].is_nan() {
                assert!((0..2).all(|c| (told[c] - uv[c]).abs() <= step), "{name}: {told:?} {uv:?}");
                answered += 1;
            }
        }
        assert!(compared == 83 * 59 && answered > compared / 2, "{name}: {answered} {compared}");
    }
}
