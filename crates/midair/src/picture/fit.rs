//! Pictures of other proportions than the image's.

use super::Picture;

/// How a picture of other proportions fills the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fit {
    /// Stretched: all of it is seen, squeezed or drawn out.
    #[default]
    Stretch,
    /// As large as it can be with nothing cut off; black beside it.
    Contain,
    /// As small as it can be with no room left; what sticks out is cut off.
    Cover,
}

/// Which part of a picture is shown, to the pixel nearest: a rectangle of the image's proportions over the picture. What of it lies beyond the
/// picture is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The picture's columns and rows.
    pub from: [usize; 2],
    /// The rectangle's.
    pub to: [usize; 2],
}

impl Fit {
    /// What is shown of a picture of so many columns and rows on an image of this width and height (in any unit).
    ///
    /// The rectangle has whole pixels: the proportions are off by half a pixel at most.
    pub fn crop(self, from: [usize; 2], image: [f64; 2]) -> Crop {
        let [width, height] = from.map(|n| n as f64);
        let shape = image[0] / image[1];
        let narrower = width < height * shape;
        // Too far apart for any screen, and for memory.
        const MOST: f64 = 32_768.0;
        let whole = |n: f64| n.round().clamp(1.0, MOST) as usize;
        let (wide, high) = ([whole(height * shape), from[1]], [from[0], whole(width / shape)]);
        let to = match self {
            Self::Stretch => from,
            Self::Contain => {
                if narrower {
                    wide
                } else {
                    high
                }
            }
            Self::Cover => {
                if narrower {
                    high
                } else {
                    wide
                }
            }
        };
        Crop { from, to }
    }
}

impl Crop {
    /// Whether it is the whole picture and nothing else.
    pub fn is_whole(&self) -> bool {
        self.from == self.to
    }

    /// Along one axis: where copying begins in the picture and in the rectangle, and how many pixels it copies.
    fn span(&self, axis: usize) -> (usize, usize, usize) {
        let (from, to) = (self.from[axis], self.to[axis]);
        let count = from.min(to);
        ((from - count) / 2, (to - count) / 2, count)
    }

    /// The same part of a picture, which is handed through where it is the whole.
    pub fn picture(&self, picture: Picture) -> Picture {
        if self.is_whole() {
            return picture;
        }
        let mut shown = Picture::filled(self.to[0], self.to[1], [0.0, 0.0, 0.0, 1.0]);
        self.copy(&picture.pixels, &mut shown.pixels, 1);
        shown
    }

    /// The same part of a frame, of `bytes` bytes for each pixel in rows from the top; 0 beside it.
    pub fn frame(&self, frame: &[u8], bytes: usize) -> Vec<u8> {
        let mut shown = vec![0; self.to[0] * self.to[1] * bytes];
        self.copy(frame, &mut shown, bytes);
        shown
    }

    fn copy<T: Copy>(&self, from: &[T], to: &mut [T], each: usize) {
        let ((x0, x1, columns), (y0, y1, rows)) = (self.span(0), self.span(1));
        for row in 0..rows {
            let source = ((y0 + row) * self.from[0] + x0) * each;
            let target = ((y1 + row) * self.to[0] + x1) * each;
            to[target..target + columns * each]
                .copy_from_slice(&from[source..source + columns * each]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_picture_on_an_upright_image() {
        let crop = |fit: Fit| fit.crop([1600, 900], [30.0, 40.0]).to;
        assert_eq!(crop(Fit::Stretch), [1600, 900]);
        // 3 : 4 around it, and within it.
        assert_eq!(crop(Fit::Contain), [1600, 2133]);
        assert_eq!(crop(Fit::Cover), [675, 900]);
        // A picture of the image's proportions stays what it is.
        for fit in [Fit::Stretch, Fit::Contain, Fit::Cover] {
            assert!(fit.crop([300, 400], [30.0, 40.0]).is_whole());
        }
    }

    /// A disc stays a disc: as many columns as rows of it are seen, in pixels that are alike along both.
    #[test]
    fn what_is_shown_keeps_its_proportions_and_its_middle() {
        let mut picture = Picture::filled(80, 40, [0.5, 0.5, 0.5, 1.0]);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            let (x, y) = ((i % 80) as f64 - 39.5, (i / 80) as f64 - 19.5);
            if x.hypot(y) < 15.0 {
                *pixel = [1.0; 4];
            }
        }
        for fit in [Fit::Contain, Fit::Cover] {
            let crop = fit.crop([80, 40], [20.0, 20.0]);
            let shown = crop.picture(picture.clone());
            assert_eq!(shown.width, shown.height);
            let bright = |x: usize, y: usize| shown.pixels[y * shown.width + x] == [1.0; 4];
            let middle = shown.width / 2;
            let across = (0..shown.width).filter(|&x| bright(x, middle)).count();
            let down = (0..shown.height).filter(|&y| bright(middle, y)).count();
            assert_eq!([across, down], [30, 30], "{fit:?}");
            assert!(
                (0..shown.width).all(|x| bright(x, middle) == bright(shown.width - 1 - x, middle))
            );
            let corner =
                if fit == Fit::Contain { [0.0, 0.0, 0.0, 1.0] } else { [0.5, 0.5, 0.5, 1.0] };
            assert_eq!(shown.pixels[0], corner);
            // Frames are cut alike.
            let bytes: Vec<u8> =
                picture.pixels.iter().flat_map(|p| [(p[0] * 200.0) as u8, 7, 9]).collect();
            let frame = crop.frame(&bytes, 3);
            assert_eq!(frame.len(), shown.pixels.len() * 3);
            for (code, pixel) in frame.chunks(3).zip(&shown.pixels) {
                assert_eq!(code[0], (pixel[0] * 200.0) as u8);
            }
        }
    }
}
