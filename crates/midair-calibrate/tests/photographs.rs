//! Photographs that the simulator takes through slit mirrors, against what it knows of each pixel.

use midair::geometry::Frame;
use midair::map::{Accuracy, invert, pixel_centre};
use midair::optics::plate::SlitMirrorPlate;
use midair::scene::load;
use midair::transport::Setup;
use midair_calibrate::decode::decode_folder;
use midair_calibrate::model_free::model_free;
use midair_calibrate::rehearsal::film::{Film, Truth};
use midair_calibrate::rehearsal::{camera, dice, lens};
use midair_calibrate::{Decoded, Lens, Patterns, Seen, stray};
use std::path::Path;

/// The paper's cube behind a slit-mirror plate, its display a little coarser than the camera.
fn cube() -> Setup {
    let path = format!("{}/../../scenes/paper/cube.toml", env!("CARGO_MANIFEST_DIR"));
    let loaded = load(path.as_ref()).expect("an example scene");
    let plate = SlitMirrorPlate::new(Default::default()).expect("the usual plate");
    Setup::new(&loaded)
        .expect("it can be traced")
        .with_plate(plate.into())
        .with_resolution([512; 2])
}

fn film(setup: &Setup) -> Film {
    let size = [600, 400];
    let full = lens(setup);
    let scale = size[0] as f64 / 6000.0;
    let lens = Lens {
        focal: full.focal.map(|f| f * scale),
        centre: full.centre.map(|c| c * scale),
        ..full
    };
    Film { size, lens, rays: 5, photons: 20_000.0, quality: 92 }
}

/// Photographs in a folder, in an order that nobody knows.
fn photograph(setup: &Setup, film: &Film, camera: &Frame, folder: &Path) -> Truth {
    let (files, truth) = film.shoot(setup, camera, &Patterns::of(setup), 7);
    let mut numbers: Vec<usize> = (0..files.len()).collect();
    dice(3).shuffle(&mut numbers);
    for (file, number) in files.iter().zip(numbers) {
        let path = folder.join(format!("IMG_{number:04}.jpg"));
        std::fs::write(path, file).expect("the folder can be written");
    }
    truth
}

/// Of the pixels called real: how far they are from the truth, rms in display pixels, over those that do see the image; and how many see another point of
/// the display, or see it by stray light. At an object's edges a pixel's middle may see nothing, and its rest the image.
fn judged(decoded: &Decoded, truth: &Truth, resolution: [usize; 2]) -> (f64, usize, usize) {
    let (mut squares, mut right, mut wrong) = (0.0, 0u32, 0);
    for (i, seen) in decoded.seen.iter().enumerate() {
        if *seen != Seen::Real {
            continue;
        }
        let off = truth.st[i].map(|st| {
            let off = [0, 1].map(|c| (f64::from(decoded.st[i][c]) - st[c]) * resolution[c] as f64);
            off[0].hypot(off[1])
        });
        match off {
            // A twentieth of the display away is another image of it.
            Some(off) if off < 25.0 => {
                squares += off * off;
                right += 1;
            }
            None if truth.stray[i] < 0.5 => {}
            _ => wrong += 1,
        }
    }
    ((squares / f64::from(right.max(1))).sqrt(), right as usize, wrong)
}

#[test]
fn photographs_in_any_order_are_decoded_and_stray_light_is_told_apart() {
    let setup = cube();
    let film = film(&setup);
    let eye = camera(&setup, 6.0, 4.0);
    let folder = tempfile::tempdir().expect("a folder");
    let truth = photograph(&setup, &film, &eye, folder.path());
    let patterns = Patterns::of(&setup);
    let mut decoded = decode_folder(&patterns, folder.path(), &()).expect("it is decoded");
    assert!(decoded.notes.is_empty(), "{:?}", decoded.notes);
    stray::mark(&mut decoded, &setup, &eye, &film.lens);
    let (rms, right, wrong) = judged(&decoded, &truth, setup.resolution);
    let on_display = |st: &&[f64; 2]| st.iter().all(|c| (0.0..=1.0).contains(c));
    let seen = truth.st.iter().flatten().filter(on_display).count();
    eprintln!("rms {rms:.3} px of {right} of {seen}, {wrong} wrong, {:?}", decoded.counts());
    // What the issue asks of decoding.
    assert!(wrong * 1000 <= right, "{wrong} of {right}");
    assert!(right * 10 > seen * 8, "{right} of {seen}");
    let points = decoded.correspondences(setup.resolution, 2000);
    // Of what goes to the fit: means of some camera pixels each.
    let mut squares = 0.0;
    for point in &points {
        let ray = midair_calibrate::camera::pixel_ray(
            &midair::transport::Placing::constant(&eye),
            &film.lens,
            point.pixel,
        );
        let st = setup.trace(ray, &mut midair::transport::Path::new()).st().expect("it is seen");
        let off = [0, 1].map(|c| (st[c] - point.st[c]) * setup.resolution[c] as f64);
        squares += off[0] * off[0] + off[1] * off[1];
    }
    let rms = (squares / points.len() as f64).sqrt();
    eprintln!("{} blocks, rms {rms:.3} px", points.len());
    assert!(points.len() > 500 && rms < 0.3, "{rms} of {}", points.len());

    // The map without a model, against the exact one at the camera's place.
    let map = model_free(&setup, &eye, &film.lens, &decoded);
    let (exact, _) = invert(&setup.with_viewpoint(eye.origin), Accuracy::default());
    let (mut off, mut answered, mut both) = (Vec::new(), 0, 0);
    for pixel in 0..map.uv.len() {
        let (column, row) = (pixel % map.width, pixel / map.width);
        let st = pixel_centre(column, row, map.width, map.height);
        // Where the plate mixes in the display's dark surroundings no photograph tells what the display shows.
        let Some(b) = exact.answer(pixel).filter(|_| !patterns.is_mixed(st)) else { continue };
        answered += 1;
        if let Some(a) = map.answer(pixel) {
            both += 1;
            off.push(1024.0 * (a[0] - b[0]).hypot(a[1] - b[1]));
        }
    }
    let rms = (off.iter().map(|o| o * o).sum::<f64>() / off.len().max(1) as f64).sqrt();
    eprintln!("model-free: rms {rms:.3} px of 1024, {both} of {answered}");
    assert!(both * 100 > answered * 98, "{both} of {answered}");
    assert!(rms < 0.5, "{rms}");
}

/// A large display behind a large plate: the camera sees its stray images as well, beside the real one and over it.
#[test]
fn stray_images_in_view_are_not_called_real() {
    let path = format!("{}/../../scenes/paper/cube.toml", env!("CARGO_MANIFEST_DIR"));
    let mut loaded = load(path.as_ref()).expect("an example scene");
    loaded.scene.display.size = Some([240.0; 2]);
    loaded.scene.image.size = [240.0; 2];
    loaded.scene.viewpoint = [60.0, 40.0, 900.0];
    let plate = SlitMirrorPlate::new(Default::default()).expect("the usual plate");
    let setup = Setup::new(&loaded)
        .expect("it can be traced")
        .with_plate(plate.into())
        .with_resolution([512; 2]);
    let film = film(&setup);
    let eye = camera(&setup, 0.0, 0.0);
    let folder = tempfile::tempdir().expect("a folder");
    let truth = photograph(&setup, &film, &eye, folder.path());
    let mut decoded =
        decode_folder(&Patterns::of(&setup), folder.path(), &()).expect("it is decoded");
    stray::mark(&mut decoded, &setup, &eye, &film.lens);
    let (rms, right, wrong) = judged(&decoded, &truth, setup.resolution);
    let in_view = truth.stray.iter().filter(|share| **share > 0.5).count();
    eprintln!(
        "{in_view} stray pixels in view; rms {rms:.3} px of {right}, {wrong} wrong, {:?}",
        decoded.counts()
    );
    assert!(in_view > 1000, "{in_view}");
    assert!(wrong * 1000 <= right, "{wrong} of {right}");
}

#[test]
fn over_exposed_photographs_and_missing_patterns_are_refused_by_name() {
    let patterns = Patterns::new([256, 192], 0.0);
    let folder = tempfile::tempdir().expect("a folder");
    let write = |gain: f32, without: Option<usize>| {
        for pattern in 0..patterns.list.len() {
            let path = folder.path().join(format!("{pattern:02}.png"));
            let light = patterns.drawn(pattern);
            let codes: Vec<u8> =
                light.iter().map(|l| (255.0 * (gain * (0.02 + l)).min(1.0)) as u8).collect();
            let size = patterns.resolution.map(|side| side as u32);
            let _ = std::fs::remove_file(&path);
            if without != Some(pattern) {
                image::save_buffer(&path, &codes, size[0], size[1], image::ExtendedColorType::L8)
                    .expect("it can be written");
            }
        }
    };
    let told = |gain: f32, without: Option<usize>| {
        write(gain, without);
        match decode_folder(&patterns, folder.path(), &()) {
            Ok(decoded) => format!("{:?}", decoded.counts()),
            Err(error) => format!("{error} | {}", error.remedy().unwrap_or_default()),
        }
    };
    let well = told(0.9, None);
    assert!(well.starts_with("SeenCounts"), "{well}");
    let full = told(1.6, None);
    assert!(full.contains("over-exposed") && full.contains("shorter time"), "{full}");
    // A stripe pattern's inverse stands in for it; nothing stands in for white.
    let pair = told(0.9, Some(4));
    assert!(pair.starts_with("SeenCounts"), "{pair}");
    let white = told(0.9, Some(0));
    assert!(white.contains("01-white.png") && white.contains("again"), "{white}");
    std::fs::remove_dir_all(folder.path()).expect("it is there");
    std::fs::create_dir(folder.path()).expect("it can be made");
    let empty = match decode_folder(&patterns, folder.path(), &()) {
        Ok(_) => panic!("there is nothing in it"),
        Err(error) => error.to_string(),
    };
    assert!(empty.contains("no photographs"), "{empty}");
}

/// Photographs of the display itself, each pixel of it a pixel: as they are after something was done to them.
fn of_display(
    patterns: &Patterns,
    folder: &Path,
    done: &dyn Fn(usize, image::GrayImage) -> image::GrayImage,
) {
    for pattern in 0..patterns.list.len() {
        let light = patterns.drawn(pattern);
        let codes = light.iter().map(|l| (255.0 * 0.9 * (0.02 + l)).min(255.0) as u8).collect();
        let [width, height] = patterns.resolution.map(|side| side as u32);
        let picture = image::GrayImage::from_raw(width, height, codes).expect("all its pixels");
        let path = folder.join(format!("{pattern:02}.png"));
        done(pattern, picture).save(path).expect("it can be written");
    }
}

/// What is told of them: the decoder's message, else what cameras and fit have to say.
fn told_of(done: &dyn Fn(usize, image::GrayImage) -> image::GrayImage) -> String {
    let patterns = Patterns::new([512, 384], 0.0);
    let folder = tempfile::tempdir().expect("a folder");
    of_display(&patterns, folder.path(), done);
    let told = |error: midair::Error| format!("{error} | {}", error.remedy().unwrap_or_default());
    match decode_folder(&patterns, folder.path(), &()) {
        Err(error) => told(error),
        Ok(decoded) => {
            format!("decoded {:.3}", decoded.counts().real as f64 / decoded.seen.len() as f64)
        }
    }
}

#[test]
fn blurred_and_moved_photographs_and_those_of_another_display_are_refused() {
    let well = told_of(&|_, picture| picture);
    let share: f64 = well.strip_prefix("decoded ").and_then(|s| s.parse().ok()).expect(&well);
    assert!(share > 0.8, "{well}");
    let blurred = told_of(&|_, picture| image::imageops::blur(&picture, 25.0));
    assert!(blurred.contains("sharp"), "{blurred}");
    // From one photograph on the camera stands elsewhere: among the finest stripes, among the sinusoids.
    for from in [18, 29] {
        let moved = told_of(&|pattern, picture| {
            let mut moved = image::GrayImage::new(picture.width(), picture.height());
            let by = if pattern < from { 0 } else { 24 };
            image::imageops::replace(&mut moved, &picture, by, by / 2);
            moved
        });
        assert!(moved.contains("tripod"), "{from}: {moved}");
    }
    let other = Patterns::new([1024, 768], 0.0);
    let other = told_of(&|pattern, _| {
        let light = other.drawn(pattern.min(other.list.len() - 1));
        let codes = light.iter().map(|l| (200.0 * l) as u8).collect();
        image::GrayImage::from_raw(1024, 768, codes).expect("all its pixels")
    });
    assert!(other.contains("display"), "{other}");
}
