//! MPCDI packages in other tools' hands: Python's own readers of zip and XML, and OpenCV's PFM and PNG.

use super::maps::{SOURCE, bent_map};
use midair::map::format::{Format, read_map, write_map};
use std::process::Command;

#[test]
fn a_package_is_the_same_map_in_other_tools_and_back() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let map = bent_map();
    write_map(&map, SOURCE, Format::Mpcdi, &at("map.mpcdi")).unwrap();
    write_map(&map, SOURCE, Format::Npy, &at("map.npy")).unwrap();
    // The map's description says the source's size and the region's. OpenCV's PFM begins with the last row, as the format has it everywhere but in MPCDI, and its colours are in the order B, G, R.
    let script = "
import cv2, numpy, sys, zipfile
from xml.etree import ElementTree
folder = sys.argv[1] + '/'
package = zipfile.ZipFile(folder + 'map.mpcdi')
assert package.testzip() is None
root = ElementTree.fromstring(package.read('mpcdi.xml'))
assert root.attrib['profile'] == '2d'
buffer = root.find('display/buffer')
assert (buffer.attrib['Xresolution'], buffer.attrib['Yresolution']) == ('61', '47')
region = buffer.find('region')
assert (region.attrib['Xresolution'], region.attrib['Yresolution']) == ('83', '59')
files = root.find('files/fileset')
assert files.attrib['region'] == region.attrib['id']
def unpacked(tag, name):
    open(folder + name, 'wb').write(package.read(files.find(tag + '/path').text))
    return cv2.imread(folder + name, cv2.IMREAD_UNCHANGED)
warp = unpacked('geometryWarpFile', 'warp.pfm')[::-1, :, ::-1]
alpha = unpacked('alphaMap', 'alpha.png')
uv = numpy.load(folder + 'map.npy')
known = ~numpy.isnan(uv[..., 0])
assert numpy.array_equal(alpha > 0, known)
assert numpy.array_equal(~numpy.isnan(warp[..., 0]), known)
off = numpy.abs(warp[..., :2] - numpy.stack([uv[..., 0], 1 - uv[..., 1]], -1))[known]
assert off.max() <= 2.0**-25 + 1e-16, off.max()
# A package made by these tools: the lower right part of a source is the region's.
theirs = uv.copy()
x, y = theirs[..., 0], 1 - theirs[..., 1]
cv2.imwrite(folder + 'theirs.pfm', numpy.stack([0 * x, y, x], -1).astype(numpy.float32)[::-1])
with zipfile.ZipFile(folder + 'theirs.mpcdi', 'w', zipfile.ZIP_DEFLATED) as made:
    made.writestr('mpcdi.xml', '''<MPCDI profile=\"2d\" geometry=\"1\" version=\"2.0\"><display><buffer id=\"b\" XResolution=\"61\" YResolution=\"47\">
<region id=\"r\" XResolution=\"83\" YResolution=\"59\" x=\"0.5\" y=\"0.25\" xsize=\"0.5\" ysize=\"0.75\"/></buffer></display>
<files><fileset region=\"r\"><geometryWarpFile><path>r.pfm</path><interpolation>linear</interpolation></geometryWarpFile></fileset></files></MPCDI>''')
    made.write(folder + 'theirs.pfm', 'r.pfm')
";
    let output = Command::new(&python).args(["-c", script]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let back = read_map(&at("theirs.mpcdi"), None, None).unwrap().map;
    let mut compared = 0;
    for (told, uv) in back.uv.iter().zip(&map.uv) {
        assert_eq!(told[0].is_nan(), uv[0].is_nan(), "{told:?} {uv:?}");
        if !uv[0].is_nan() {
            // Three quarters from a quarter below the upper edge: v from 0 to 0.75.
            let wanted = [0.5 + 0.5 * uv[0], 0.75 * uv[1]];
            assert!((0..2).all(|c| (told[c] - wanted[c]).abs() < 1e-7), "{told:?} {wanted:?}");
            compared += 1;
        }
    }
    assert!(compared > 83 * 59 * 8 / 10, "{compared}");
}
