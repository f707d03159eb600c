//! The gain divided out of the frame, live.

use super::x_screen::{SIDE, XScreen, end};
use super::{BALL, EVENED, Stage, TOLERANCE, free_port, opentrack};
use midair::geometry::Vec3;
use midair::map::Map;
use midair::simulate::image_gain;
use std::net::UdpSocket;
use std::time::Duration;

/// The picture's light as each display pixel's path weakens it, divided out pixel by pixel: the window does it in the frame instead.
#[test]
fn the_gain_is_divided_out_unless_the_picture_is_shown_as_it_is() {
    let Some(screen) = XScreen::open() else { return };
    // Tinted, so that red loses most, and most in the middle.
    let tinted = BALL.replace("ior = 1.49", "ior = 1.49, absorption = [0.02, 0.005, 0.0]");
    let stage = Stage::with("", &tinted);
    let range = stage.gain(stage.setup.viewpoint).1.range().unwrap();
    // Without a difference the test would show nothing: exp(-0.02 * 50) of red is left in the middle.
    assert!(range[0] < 0.5 * range[1], "{range:?}");
    let expected = stage.evened(stage.setup.viewpoint);
    let mut show = screen.play(&stage.bench, &["ball.toml", "p.png", "--gain"]);
    screen.await_picture("evened", &expected, EVENED);
    screen.focus();
    screen.key(&["u"]);
    screen.await_picture("as it is", &stage.through(&Map::identity(SIDE, SIDE)), TOLERANCE);
    screen.key(&["u"]);
    screen.await_picture("evened again", &expected, EVENED);
    assert!(show.try_wait().unwrap().is_none());
    end(show);
}

/// While the viewer moves, maps are shown with the gain of a moment ago; once at rest, with their own.
#[test]
fn the_gain_of_a_moving_viewer_settles_when_the_viewer_rests() {
    let Some(screen) = XScreen::open() else { return };
    // A tinted bead half way to the viewer, which bends no light: from aside another part of it is before each image point, so that the
    // gain changes much within the distance that it is kept over.
    let bead = "[[element]]\nname = \"bead\"\nshape = { kind = \"sphere\", radius = 25.0 }\n\
                position = [0.0, 0.0, 400.0]\n\
                material = { ior = 1.0, absorption = [0.04, 0.0, 0.02] }\n";
    let stage = Stage::with("", &format!("{BALL}{bead}"));
    let port = free_port();
    let track = format!("opentrack:{port}");
    let show = screen.play(
        &stage.bench,
        &["ball.toml", "p.png", "--gain", "--track", &track, "--no-smoothing", "--predict", "0"],
    );
    screen.await_picture("at rest", &stage.evened(stage.setup.viewpoint), EVENED);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let send = |eye: Vec3| {
        socket.send_to(&opentrack([eye.x, eye.y, eye.z]), ("127.0.0.1", port)).unwrap();
        std::thread::sleep(Duration::from_millis(16));
    };
    for side in [1.0, -1.0] {
        // 180 mm/s, and a last step that is longer, but no further than a gain is kept for.
        let at = |x: f64| Vec3::new(side * x, 0.1 * x, 800.0 - 0.2 * x);
        let path = (0..30).map(|i| 3.0 * f64::from(i)).map(|x| x.min(30.0));
        path.map(at).for_each(&send);
        let last = at(34.5);
        // With the gain of the step before the light would be wrong by a tenth somewhere: a light code by 4 %, or 8 codes.
        let (map, own) = stage.gain(last);
        let before = stage.setup.with_viewpoint(at(30.0));
        let before = image_gain(&before);
        let pairs = map.uv.iter().zip(&own.rgb).filter(|(uv, _)| uv[0].is_finite());
        let off = pairs.map(|(&uv, own)| (before.at(uv)[0] / own[0] - 1.0).abs());
        let off = off.fold(0.0, f32::max);
        assert!(off > 0.1, "{off}");
        send(last);
        screen.await_picture("after a motion", &stage.evened(last), EVENED);
    }
    end(show);
}
