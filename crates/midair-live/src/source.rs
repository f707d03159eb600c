//! What is shown: frames at their times.

use crate::clock::{Clock, Pace};
use crate::newest::Newest;
use midair::measure::lattice::{LatticeStyle, draw_lattice};
use midair::picture::{FileError, Fit, Picture, Sequence, read_still, srgb};
use midair_video::{Decoder, Sound, VideoError, probe};
use std::io::Read as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Where frames come from.
#[derive(Clone, Debug, PartialEq)]
pub enum SourceKind {
    /// A picture.
    Still(PathBuf),
    /// Numbered pictures at so many a second, over and over.
    Stills(Sequence, f64),
    /// A film, over and over.
    Film(PathBuf),
    /// The paper's lattice.
    Lattice,
    /// Raw RGBA frames of so many pixels on standard input, each shown when it comes.
    Stdin([usize; 2]),
    /// One after the other, over and over; what stands still so many seconds each.
    List(Vec<SourceKind>, f64),
}

impl SourceKind {
    /// Whether it stands still.
    fn stands(&self) -> bool {
        matches!(self, Self::Still(_) | Self::Lattice)
    }
}

/// A frame of bytes blue, green, red and one unused, rows from the top.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Four for each pixel.
    pub bytes: Arc<Vec<u8>>,
}

impl Frame {
    /// A picture's light as sRGB codes.
    pub fn of_picture(picture: &Picture) -> Self {
        let code = |pixel: &[f32; 4]| [pixel[2], pixel[1], pixel[0], 1.0].map(srgb::encode_8);
        let bytes = picture.pixels.iter().flat_map(code).collect();
        Self { size: [picture.width, picture.height], bytes: Arc::new(bytes) }
    }

    fn of_rgb<const C: usize>(size: [usize; 2], bytes: &[u8]) -> Self {
        let swapped = bytes.as_chunks::<C>().0.iter().flat_map(|p| [p[2], p[1], p[0], 255]);
        Self { size, bytes: Arc::new(swapped.collect()) }
    }

    /// What is shown of it on an image of this width and height.
    fn fitted(self, fit: Fit, image: [f64; 2]) -> Self {
        let crop = fit.crop(self.size, image);
        if crop.is_whole() {
            return self;
        }
        Self { size: crop.to, bytes: Arc::new(crop.frame(&self.bytes, 4)) }
    }

    /// The lattice in the image's proportions.
    pub fn lattice([width, height]: [f64; 2]) -> Self {
        let rows = ((1024.0 * height / width).round() as usize).clamp(64, 4096);
        let drawn = draw_lattice(1024, rows, &LatticeStyle::default());
        Self::of_picture(&drawn.unwrap_or_else(|_| Picture::filled(1, 1, [1.0; 4])))
    }
}

/// Why a source has no frames.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A picture cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A film cannot be decoded.
    #[error(transparent)]
    Film(#[from] VideoError),
    /// Standard input broke.
    #[error("standard input: {0}")]
    Stdin(std::io::Error),
}

/// Hands frames over until `gone`; each is announced by `ready`.
pub struct Player {
    /// Where they are put.
    pub frames: Arc<Newest<Frame>>,
    /// Whether the show stands still.
    pub paused: Arc<AtomicBool>,
    /// Called after each frame.
    pub ready: Box<dyn Fn() + Send>,
    /// Whether the show has ended.
    pub gone: Arc<AtomicBool>,
    /// The show's.
    pub clock: Clock,
    /// Whether films are heard.
    pub sound: bool,
    /// How frames of other proportions fill the image.
    pub fit: Fit,
    /// The image's width and height, mm.
    pub image: [f64; 2],
}

/// How soon a pause or the end of the show is seen to.
const NAP: Duration = Duration::from_millis(5);

impl Player {
    fn show(&self, frame: Frame) -> bool {
        self.frames.put(frame.fitted(self.fit, self.image));
        (self.ready)();
        !self.gone.load(Ordering::Relaxed)
    }

    /// Waits until a moment of the film; false at the end of the show. `each` is told again and again whether the show stands still.
    fn wait(
        &self,
        pace: &mut Pace,
        at: f64,
        mut each: impl FnMut(bool) -> Result<(), SourceError>,
    ) -> Result<bool, SourceError> {
        while !self.gone.load(Ordering::Relaxed) {
            let paused = self.paused.load(Ordering::Relaxed);
            each(paused)?;
            let left = pace.left(self.clock.now(), paused, at);
            match left {
                Some(Duration::ZERO) => return Ok(true),
                left => std::thread::sleep(NAP.min(left.unwrap_or(NAP))),
            }
        }
        Ok(false)
    }

    /// Plays a source to its end, which only standard input has.
    ///
    /// # Errors
    /// [`SourceError`] where frames cannot be had.
    pub fn play(&self, kind: &SourceKind) -> Result<(), SourceError> {
        match kind {
            SourceKind::List(kinds, seconds) => loop {
                for kind in kinds {
                    if !self.once(kind)? || kind.stands() && !self.hold(*seconds)? {
                        return Ok(());
                    }
                }
            },
            kind if kind.stands() || matches!(kind, SourceKind::Stdin(_)) => {
                self.once(kind).map(drop)
            }
            kind => {
                while self.once(kind)? {}
                Ok(())
            }
        }
    }

    /// Plays a source once; false at the end of the show.
    fn once(&self, kind: &SourceKind) -> Result<bool, SourceError> {
        match kind {
            SourceKind::Still(path) => Ok(self.show(Frame::of_picture(&read_still(path)?.picture))),
            SourceKind::Lattice => Ok(self.show(Frame::lattice(self.image))),
            SourceKind::Stills(sequence, rate) => {
                let mut pace = Pace::start(self.clock.now());
                for (i, number) in sequence.numbers()?.iter().enumerate() {
                    let frame = Frame::of_picture(&read_still(&sequence.file(*number))?.picture);
                    if !self.wait(&mut pace, i as f64 / rate, |_| Ok(()))? || !self.show(frame) {
                        return Ok(false);
                    }
                }
                // The last one has its time as well.
                self.hold(rate.recip())
            }
            SourceKind::Film(path) => self.play_film(path),
            SourceKind::Stdin(size) => {
                let mut bytes = vec![0; size[0] * size[1] * 4];
                let mut input = std::io::stdin().lock();
                loop {
                    match input.read_exact(&mut bytes) {
                        Ok(()) if self.show(Frame::of_rgb::<4>(*size, &bytes)) => {}
                        Ok(()) => return Ok(false),
                        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                            return Ok(true);
                        }
                        Err(error) => return Err(SourceError::Stdin(error)),
                    }
                }
            }
            SourceKind::List(kinds, _) => {
                for kind in kinds {
                    if !self.once(kind)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
        }
    }

    /// Lets what is shown stand for so many seconds; false at the end of the show.
    fn hold(&self, seconds: f64) -> Result<bool, SourceError> {
        self.wait(&mut Pace::start(self.clock.now()), seconds, |_| Ok(()))
    }

    fn play_film(&self, path: &std::path::Path) -> Result<bool, SourceError> {
        let film = probe(path)?;
        let sounds = self.sound && film.sounds > 0;
        let mut decoder = Decoder::new(&film, false)?;
        let mut pace = Pace::start(self.clock.now());
        let (mut bytes, mut count) = (Vec::new(), 0);
        // It is silent while the show stands still.
        let mut sound: Option<Sound> = None;
        while let Some(timing) = decoder.next(&mut bytes)? {
            count += 1;
            let frame = Frame::of_rgb::<3>(decoder.size(), &bytes);
            let at = timing.seconds();
            let due = self.wait(&mut pace, at, |paused| {
                if paused || !sounds {
                    sound = None;
                } else if sound.is_none() {
                    sound = Some(Sound::play(path, at)?);
                }
                Ok(())
            })?;
            if !due || !self.show(frame) {
                return Ok(false);
            }
        }
        let said = decoder.finish()?;
        if count == 0 {
            let said =
                said.into_iter().next().unwrap_or_else(|| "no frame can be decoded".to_owned());
            let refused = VideoError::Refused { path: path.to_owned(), doing: "decode it", said };
            return Err(refused.into());
        }
        Ok(true)
    }
}
