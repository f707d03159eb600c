//! A whole show without a window and without a clock: what is to be seen after each thing that happens.

use midair::geometry::Vec3;
use midair::map::{Accuracy, Map, invert};
use midair::picture::{Drive, Filter, LightFrame, Warp};
use midair::scene::{Loaded, load};
use midair::transport::Setup;
use midair_live::{
    Calibration, Command, Frame, Heard, Job, Nudge, Protocol, Reading, Settings, Show, Solver,
    Spent, Wish,
};
use std::sync::Arc;
use std::time::Duration;

const SIDE: usize = 96;
const SOURCE: [usize; 2] = [80, 64];

/// A ball with the image within it; written as people write, with comments.
const BALL: &str = "\
# The bench.
[viewpoint]
position = [0, 0, 800] # my left eye
[image]
size = [20.0, 16.0]
[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]
[display]
resolution = [96, 96]
[[element]]
name = \"ball\" # from the market
shape = { kind = \"sphere\", radius = 25.0 }
material = { ior = 1.49 }
";

/// Waves that rise by less than ten codes from one pixel to the next.
fn waves() -> Frame {
    let mut bytes = Vec::new();
    for i in 0..SOURCE[0] * SOURCE[1] {
        let [x, y] = [i % SOURCE[0], i / SOURCE[0]].map(|i| i as f64);
        let wave = |at: f64| (128.0 + 90.0 * at.sin()) as u8;
        bytes.extend([wave(0.1 * x), wave(0.08 * y), wave(0.05 * (x + y)), 255]);
    }
    Frame { size: SOURCE, bytes: Arc::new(bytes) }
}

/// A code of difference where a weight of 14 bits falls the other way, and one more for a map that is solved to 2.5e-5 of the picture:
/// waves rise by less than ten codes a pixel of 1/80.
const TOLERANCE: u8 = 2;

struct Stage {
    show: Show,
    solver: Solver,
    loaded: Loaded,
    now: f64,
}

impl Stage {
    fn new(settings: Settings) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ball.toml");
        std::fs::write(&path, BALL).unwrap();
        let loaded = load(&path).unwrap();
        let show = Show::new(loaded.clone(), settings);
        let mut stage = Self { show, solver: Solver::default(), loaded, now: 0.0 };
        stage.show.resize([SIDE; 2], true, Duration::ZERO);
        stage.show.frame(waves(), Duration::ZERO);
        stage.solve();
        stage
    }

    fn time(&self) -> Duration {
        Duration::from_secs_f64(self.now)
    }

    /// Lets time go by as the show asks to be told of it.
    fn wait(&mut self, seconds: f64) {
        let end = self.now + seconds;
        while let Some(then) = self.show.next_tick(self.time()).map(|then| then.as_secs_f64()) {
            if then > end {
                break;
            }
            assert!(then >= self.now, "a moment that has gone by");
            // A clock's readings are of nanoseconds.
            self.now = then + 1e-9;
            self.show.tick(self.time());
        }
        self.now = end;
    }

    /// Has the maps made that are asked for.
    fn solve(&mut self) {
        while let Some(job) = self.show.take_job() {
            let Job::Map(request) = job else { panic!("a show asks for maps alone") };
            match self.solver.solve(&request, &Spent::default()) {
                Ok(solved) => self.show.solved(solved),
                Err(why) => self.show.refused(why, self.time()).unwrap(),
            }
        }
    }

    fn command(&mut self, command: Command) -> Option<Wish> {
        self.now += 0.01;
        let wish = self.show.command(command, self.time());
        self.solve();
        wish
    }

    fn nudge(&mut self, axis: usize, by: f64) {
        self.command(Command::Nudge(Nudge { axis, by, turn: false }));
    }

    fn hear(&mut self, x: f64, y: f64, z: f64) {
        self.now += 0.01;
        let reading = Reading { position: Vec3::new(x, y, z), angles: [0.0; 3] };
        self.show.heard(Heard::Reading(reading), self.time());
        self.solve();
    }

    fn shown(&mut self) -> Vec<u8> {
        let now = self.time();
        let picture = self.show.picture(now).expect("there is a picture");
        let mut bytes = vec![0; 4 * picture.size[0] * picture.size[1]];
        if let Some((warp, _)) = picture.warp {
            warp.apply_light(picture.light.0, 4, picture.drive, &mut bytes).unwrap();
        }
        bytes
    }

    fn lines(&self) -> String {
        self.show.lines("test", self.time()).join("\n")
    }

    /// What the display has to show to an eye, the ball being somewhere: by the whole map, pixel by pixel.
    fn expected(&self, eye: [f64; 3], ball: [f64; 3]) -> Vec<u8> {
        let mut loaded = self.loaded.clone();
        loaded.scene.viewpoint = eye;
        loaded.scene.elements[0].pose.position = ball;
        let setup = Setup::new(&loaded).unwrap();
        through(&invert(&setup, Accuracy::default()).0)
    }

    fn expect(&mut self, what: &str, expected: &[u8]) {
        let worst = self.shown().iter().zip(expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(worst <= TOLERANCE, "{what}: off by {worst}");
    }
}

fn through(map: &Map) -> Vec<u8> {
    let warp = Warp::new(map, SOURCE, Filter::Bilinear).unwrap();
    let (mut light, mut shown) = (LightFrame::default(), vec![0; SIDE * SIDE * 4]);
    light.decode(&waves().bytes, 4).unwrap();
    warp.apply_light(&light, 4, &Drive::default(), &mut shown).unwrap();
    shown
}

fn settings(tracker: Option<(Protocol, u16)>) -> Settings {
    Settings {
        tracker,
        calibration: Calibration::new([0.0; 3], [0.0; 3]),
        smoothing: None,
        predict: Some(0.0),
        gain: None,
        figures: false,
        blank_after: None,
    }
}

const HOME: [f64; 3] = [0.0, 0.0, 800.0];
const CENTRE: [f64; 3] = [0.0; 3];

#[test]
fn it_follows_the_viewer_and_comes_home_when_the_tracker_falls_silent() {
    let mut stage = Stage::new(settings(Some((Protocol::OpenTrack, 4242))));
    let home = stage.expected(HOME, CENTRE);
    stage.expect("at rest", &home);
    let aside = stage.expected([120.0, 40.0, 700.0], CENTRE);
    assert!(
        home.iter().zip(&aside).any(|(a, b)| a.abs_diff(*b) > 3 * TOLERANCE),
        "the eye makes no difference"
    );
    stage.hear(120.0, 40.0, 700.0);
    stage.expect("aside", &aside);
    // In the ball, behind the image, at the tracker's own place: the last map stays, and it is said why.
    for ([x, y, z], why) in [
        ([3.0, 4.0, 5.0], "inside the element `ball`"),
        ([0.0, 0.0, -40.0], "faces away"),
        ([0.0, 0.0, 0.0], "sees nobody"),
    ] {
        stage.hear(x, y, z);
        stage.expect(why, &aside);
        assert!(stage.lines().contains(why), "{}", stage.lines());
    }
    assert!(stage.show.take_notes().iter().any(|note| note.contains("inside the element")));
    stage.wait(1.9);
    stage.solve();
    stage.expect("not lost yet", &aside);
    stage.wait(0.2);
    stage.solve();
    stage.expect("lost", &home);
    assert!(stage.lines().contains("back to the scene's viewpoint"), "{}", stage.lines());
    stage.wait(5.1);
    assert_eq!(stage.lines(), "");
    stage.hear(120.0, 40.0, 700.0);
    stage.expect("found again", &aside);
}

#[test]
fn packets_that_are_no_readings_are_told_of() {
    let mut stage = Stage::new(settings(Some((Protocol::OpenTrack, 4242))));
    for _ in 0..50 {
        stage.now += 0.02;
        stage.show.heard(Heard::Other(24), stage.time());
    }
    stage.wait(3.0);
    let lines = stage.lines();
    assert!(lines.contains("50 packets") && lines.contains("24 bytes"), "{lines}");
    assert_eq!(stage.show.packets(), Some([0, 50]));
}

#[test]
fn nudges_are_held_to_what_a_scene_may_say_and_can_be_taken_back() {
    let mut stage = Stage::new(settings(None));
    stage.nudge(0, 10.0);
    stage.nudge(1, -5.0);
    let moved = stage.expected([10.0, -5.0, 800.0], CENTRE);
    stage.expect("nudged", &moved);
    let lines = stage.lines();
    assert!(lines.contains("nudging viewpoint") && lines.contains("x +10.0  y -5.0"), "{lines}");
    // To the ball and into it.
    stage.nudge(2, -780.0);
    assert!(stage.lines().contains("inside the element `ball`"), "{}", stage.lines());
    stage.expect("refused", &moved);
    stage.command(Command::NextTarget);
    stage.nudge(0, 2.0);
    let ball = stage.expected([10.0, -5.0, 800.0], [2.0, 0.0, 0.0]);
    stage.expect("the ball nudged", &ball);
    stage.command(Command::Undo);
    stage.expect("one back", &moved);
    stage.command(Command::Undo);
    let one = stage.expected([10.0, 0.0, 800.0], CENTRE);
    stage.expect("two back", &one);
    stage.nudge(0, 2.0);
    stage.command(Command::Reset);
    let home = stage.expected(HOME, CENTRE);
    stage.expect("all back", &home);
    stage.command(Command::Undo);
    let before = stage.expected([10.0, 0.0, 800.0], [2.0, 0.0, 0.0]);
    stage.expect("the reset taken back", &before);
    for _ in 0..3 {
        stage.command(Command::Undo);
    }
    stage.expect("the beginning", &home);
    assert!(stage.lines().contains("no step to take back"), "{}", stage.lines());
}

#[test]
fn an_element_is_not_nudged_over_the_viewer() {
    let mut stage = Stage::new(settings(Some((Protocol::Osc, 9000))));
    stage.hear(0.0, 0.0, 60.0);
    let near = stage.expected([0.0, 0.0, 60.0], CENTRE);
    stage.expect("near", &near);
    stage.command(Command::NextTarget);
    stage.nudge(2, 40.0);
    assert!(stage.lines().contains("not moved"), "{}", stage.lines());
    stage.expect("still near", &near);
}

#[test]
fn a_map_that_takes_long_does_not_take_the_shows_time() {
    let mut stage = Stage::new(settings(None));
    let home = stage.expected(HOME, CENTRE);
    // A map is asked for and does not come: the frames go on with the last one.
    stage.show.command(Command::Nudge(Nudge { axis: 0, by: 30.0, turn: false }), stage.time());
    let Some(Job::Map(late)) = stage.show.take_job() else { panic!("no map is asked for") };
    for _ in 0..5 {
        stage.now += 1.0;
        stage.show.frame(waves(), stage.time());
        assert!(stage.show.take_job().is_none() && stage.show.take_stale());
        stage.expect("meanwhile", &home);
    }
    // Another kind of source is awaited: the film that fits the map goes on.
    stage.show.command(Command::Lattice, stage.time());
    stage.expect("until the lattice has a map", &home);
    stage.show.command(Command::Lattice, stage.time());
    // Another size: what is seen stays for a moment, then the wait is told.
    let time = stage.time();
    stage.show.solved(stage.solver.solve(&late, &Spent::default()).unwrap());
    stage.show.resize([SIDE / 2, SIDE], false, time);
    assert!(stage.show.picture(time).is_none());
    stage.wait(0.31);
    assert!(stage.show.take_stale());
    assert!(stage.shown().iter().all(|&byte| byte == 0));
    assert!(stage.lines().contains("48 x 96 pixels is being made"), "{}", stage.lines());
    stage.solve();
    assert_eq!(stage.shown().len(), 4 * SIDE / 2 * SIDE);
    assert!(stage.shown().iter().any(|&byte| byte > 100));
}

#[test]
fn what_cannot_be_solved_leaves_the_last_map() {
    let mut stage = Stage::new(settings(None));
    stage.show.command(Command::Nudge(Nudge { axis: 0, by: 30.0, turn: false }), stage.time());
    stage.show.take_job();
    stage.show.refused("out of tokens".to_owned(), stage.time()).unwrap();
    assert!(stage.lines().contains("out of tokens"), "{}", stage.lines());
    let home = stage.expected(HOME, CENTRE);
    stage.expect("the last one", &home);
    // The set-up is the last map's too.
    assert_eq!(stage.show.loaded().scene.viewpoint, HOME);
    let mut show = Show::new(stage.loaded.clone(), settings(None));
    assert_eq!(show.refused("no".to_owned(), Duration::ZERO), Err("no".to_owned()));
}

#[test]
fn the_scene_is_saved_with_its_comments_and_the_tracker() {
    let mut stage = Stage::new(settings(Some((Protocol::OpenTrack, 4242))));
    stage.nudge(0, 30.0);
    stage.command(Command::NextTarget);
    stage.nudge(1, 0.3);
    stage.command(Command::Nudge(Nudge { axis: 1, by: 0.1, turn: true }));
    // The tracker tracks the forehead, 30 mm above the eye.
    stage.hear(30.0, 30.0, 800.0);
    stage.command(Command::Calibrate);
    let eye = stage.expected([30.0, 0.0, 800.0], [0.0, 0.3, 0.0]);
    let turned = stage.shown();
    // A ball is the same from all sides.
    assert!(turned.iter().zip(&eye).all(|(a, b)| a.abs_diff(*b) <= TOLERANCE));
    stage.show.resize([50, 50], true, stage.time());
    let Some(Wish::Save(text)) = stage.command(Command::Save) else { panic!("nothing to save") };
    for part in ["# The bench.", "[30.0, 0, 800] # my left eye", "\"ball\" # from the market"] {
        assert!(text.contains(part), "{part}:\n{text}");
    }
    let saved = midair::scene::parse(&text, "saved.toml", midair::scene::Format::Toml).unwrap();
    let mut expected = stage.show.loaded().scene.clone();
    expected.tracker = saved.tracker;
    expected.name = "saved".to_owned();
    assert_eq!(saved, expected);
    assert_eq!(saved.elements[0].pose.position, [0.0, 0.3, 0.0]);
    assert_eq!(saved.elements[0].pose.rotation, [0.0, 0.1, 0.0]);
    assert_eq!(saved.display.resolution, [96, 96]);
    assert_eq!(saved.tracker.unwrap().offset, [0.0, -30.0, 0.0]);
}

#[test]
fn the_keys_are_shown_and_the_source_as_it_is() {
    let mut stage = Stage::new(settings(None));
    stage.command(Command::Uncompensated);
    stage.expect("uncompensated", &through(&Map::identity(SIDE, SIDE)));
    stage.command(Command::Help);
    assert!(stage.lines().contains("Backspace"), "{}", stage.lines());
    stage.command(Command::Help);
    stage.command(Command::Figures);
    stage.show.resize([SIDE; 2], false, stage.time());
    let lines = stage.lines();
    assert!(lines.contains("uncompensated") && lines.contains("not to scale"), "{lines}");
    assert_eq!(stage.command(Command::End), Some(Wish::End));
    assert!(!stage.show.paused());
    stage.command(Command::Pause);
    assert!(stage.show.paused());
}

#[test]
fn the_display_is_dark_while_nobody_is_there_and_out_of_hours() {
    let blank_after = Some(Duration::from_secs(8));
    let tracker = Some((Protocol::OpenTrack, 4242));
    let mut stage = Stage::new(Settings { blank_after, ..settings(tracker) });
    let home = stage.expected(HOME, CENTRE);
    stage.wait(7.9);
    stage.solve();
    stage.expect("somebody has begun it", &home);
    stage.wait(0.2);
    assert!(stage.show.is_dark() && stage.show.paused());
    assert!(stage.shown().iter().all(|&byte| byte == 0));
    assert_eq!(stage.lines(), "");
    // A tracker that sees nobody lights nothing up.
    stage.hear(0.0, 0.0, 0.0);
    assert!(stage.show.is_dark());
    stage.hear(120.0, 40.0, 700.0);
    let aside = stage.expected([120.0, 40.0, 700.0], CENTRE);
    stage.expect("somebody has come", &aside);
    assert!(!stage.show.paused());
    stage.show.open(false, stage.time());
    stage.hear(120.0, 40.0, 700.0);
    assert!(stage.shown().iter().all(|&byte| byte == 0));
    stage.show.open(true, stage.time());
    stage.expect("the next day", &aside);
}
