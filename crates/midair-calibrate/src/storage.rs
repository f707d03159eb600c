//! A camera's lens as OpenCV's programs write it: a cv2.FileStorage with the camera's matrix and its distortion.

use crate::camera::Lens;
use midair::map::format::FileError;
use midair::map::format::storage::{Matrix, Storage, parse};
use std::path::Path;

/// What a file tells of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Its lens.
    pub lens: Lens,
    /// Its photographs' width and height, where the file has them.
    pub size: Option<[usize; 2]>,
}

/// OpenCV counts pixels from the middle of the first.
const HALF: f64 = 0.5;
/// The names that OpenCV's own programs and its tutorials use, without case and underscores.
const MATRIX: [&str; 5] = ["cameramatrix", "k", "mtx", "m", "intrinsics"];
const DISTORTION: [&str; 5] = ["distortioncoefficients", "distcoeffs", "dist", "d", "distortion"];
const REMEDY: &str = "write what cv2.calibrateCamera finds as camera_matrix and distortion_coefficients, or give focal, centre and distortion in [camera]";

/// Reads a file.
///
/// # Errors
/// A file that cannot be read, is no cv2.FileStorage, or holds no camera with OpenCV's first five coefficients of distortion.
pub fn load(path: &Path) -> Result<Camera, FileError> {
    let bytes = std::fs::read(path).map_err(|error| FileError::io(path, "read", error))?;
    read(path, &bytes)
}

fn read(path: &Path, bytes: &[u8]) -> Result<Camera, FileError> {
    let storage = parse(path, bytes)?;
    let unlike = |what: String| FileError::malformed(path, "camera", what, REMEDY);
    let matrix = named(&storage, &MATRIX)
        .filter(|matrix| matrix.numbers.len() == 9 && matrix.width == 3)
        .ok_or_else(|| unlike("there is no camera_matrix of 3 x 3 numbers".to_owned()))?;
    let &[fx, skew, cx, zero, fy, cy, ..] = matrix.numbers.as_slice() else {
        return Err(unlike("the camera's matrix has too few numbers".to_owned()));
    };
    if skew != 0.0 || zero != 0.0 || matrix.numbers[6..] != [0.0, 0.0, 1.0] {
        return Err(unlike(format!("{} is no camera's matrix without skew", matrix.name)));
    }
    let numbers = [fx, fy, cx, cy];
    if !(fx > 0.0 && fy > 0.0 && numbers.iter().all(|number| number.is_finite())) {
        return Err(unlike(format!("{} has focal lengths that no camera has", matrix.name)));
    }
    let coefficients = named(&storage, &DISTORTION)
        .map(|matrix| matrix.numbers.as_slice())
        .ok_or_else(|| unlike("there are no distortion_coefficients".to_owned()))?;
    let mut distortion = [0.0; 5];
    for (number, &coefficient) in coefficients.iter().enumerate() {
        match distortion.get_mut(number) {
            Some(own) if coefficient.is_finite() => *own = coefficient,
            None if coefficient == 0.0 => {}
            _ => {
                let what = format!(
                    "distortion coefficient {} is {coefficient}: only k1, k2, p1, p2 and k3 are known here",
                    number + 1
                );
                return Err(unlike(what));
            }
        }
    }
    let size = ["image_width", "image_height"].map(|name| storage.number(name));
    Ok(Camera {
        lens: Lens { focal: [fx, fy], centre: [cx + HALF, cy + HALF], distortion },
        size: match size {
            [Some(width), Some(height)] => Some([width, height]),
            _ => None,
        },
    })
}

fn named<'a>(storage: &'a Storage, names: &[&str]) -> Option<&'a Matrix> {
    let plain = |matrix: &Matrix| matrix.name.replace('_', "").to_lowercase();
    storage.matrices.iter().find(|matrix| names.contains(&plain(matrix).as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "%YAML:1.0
---
image_width: 6000
image_height: 4000
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 9870., 0., 2999.5, 0., 9860., 1999.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.1, 0.02, 0.001, -0.002, 0.003 ]
";

    #[test]
    fn a_camera_is_read_and_its_pixels_are_counted_from_their_edge() {
        let lens = Lens {
            focal: [9870.0, 9860.0],
            centre: [3000.0, 2000.0],
            distortion: [-0.1, 0.02, 0.001, -0.002, 0.003],
        };
        let camera = Camera { lens, size: Some([6000, 4000]) };
        assert_eq!(read("a.yml".as_ref(), FILE.as_bytes()).expect("a camera"), camera);
    }

    #[test]
    fn other_cameras_are_refused() {
        for (from, to, wanted) in [
            ("camera_matrix", "projection", "no camera_matrix"),
            ("distortion_coefficients", "other", "no distortion_coefficients"),
            ("9870., 0.,", "9870., 3.,", "without skew"),
            ("9870., 0.,", "-9870., 0.,", "focal"),
            ("cols: 5", "cols: 6", "malformed"),
            (
                "cols: 5\n   dt: d\n   data: [",
                "cols: 6\n   dt: d\n   data: [ 0.5,",
                "coefficient 6",
            ),
        ] {
            let text = FILE.replace(from, to);
            assert_ne!(text, FILE, "{from}");
            let error = read("a.yml".as_ref(), text.as_bytes()).expect_err(to);
            let told = error.to_string();
            assert!(wanted == "malformed" || told.contains(wanted), "{told}");
        }
    }
}
