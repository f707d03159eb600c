//! `midair plate`.

use super::{Bench, set_up};
use midair::picture::{Depth, Picture, read_still, write_still};

fn plate(keys: &str) -> String {
    set_up("").replace("size = [488.0, 488.0]", &format!("size = [488.0, 488.0]\n{keys}"))
}

#[test]
fn a_plates_character_is_told_and_drawn() {
    let bench = Bench::new();
    bench.write("s.toml", plate("model = \"slit-mirror\"\nreflectance = 1.0"));
    let told = bench.json(&["plate", "s.toml", "--out", "out"]);
    assert_eq!(bench.names("out"), ["plate.json", "shares.png", "sharpness.png", "viewpoints.png"]);
    for name in ["shares.png", "sharpness.png", "viewpoints.png"] {
        let picture = read_still(&bench.path("out").join(name)).unwrap().picture;
        assert!(picture.width > 400 && picture.height > 400, "{name}");
    }
    let text = std::fs::read_to_string(bench.path("out/plate.json")).unwrap();
    let all: serde_json::Value = serde_json::from_str(&text).unwrap();
    // The plate stands at 45 degrees to the line of sight: the known shares of a lossless plate, of what the faces let in
    // (Fresnel's transmittance of both at 45 degrees, index 1.52, is 0.8967: Rs 0.0968, and there Rp is its square).
    let at = &told["from_viewpoint"];
    assert!((at["incidence_degrees"].as_f64().unwrap() - 45.0).abs() < 1e-9);
    let share = |name: &str| at[name][0].as_f64().unwrap();
    let passed = share("real") + share("stray") + share("through");
    assert!((passed - 0.8967).abs() < 1e-4, "{passed}");
    assert!((share("real") / passed - 0.86).abs() < 0.005, "{at}");
    assert!((share("stray") / passed - 0.13).abs() < 0.005, "{at}");
    // The same is in the grid: 45 degrees of incidence at azimuth 0 and 90.
    for azimuth in [0, 90] {
        let grid = all["directions"]["real"][azimuth][45][0].as_f64().unwrap();
        assert!((grid - share("real")).abs() < 1e-9);
        for incidence in 0..90 {
            let share =
                |name: &str| all["directions"][name][azimuth][incidence][1].as_f64().unwrap();
            let sum = share("real") + share("stray") + share("through") + share("lost");
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
    let range = &all["viewpoints"]["visible_range"];
    assert_eq!(range["brightest_degrees"][0], 0.0);
    let transfer = &all["modulation_transfer"];
    assert!((transfer["x"][0].as_f64().unwrap() - 1.0).abs() < 1e-12);
    assert!(transfer["half_per_mm"][0].as_f64().unwrap() > 0.3);
    let cells = all["point_spread"]["cells"].as_array().unwrap();
    let light = cells.iter().flat_map(|row| row.as_array().unwrap());
    let sum: f64 = light.map(|cell| cell.as_f64().unwrap()).sum();
    // One in a thousand may lie outside.
    assert!((0.999..=1.0 + 1e-9).contains(&sum), "{sum}");
}

#[test]
fn a_measured_table_replaces_the_models_luminance() {
    let bench = Bench::new();
    bench.write("t.csv", "azimuth,elevation,value\n-60,-60,1\n60,-60,1\n-60,60,3\n60,60,3\n");
    bench.write("s.toml", plate("model = \"slit-mirror\"\nluminance = \"t.csv\""));
    bench.json(&["plate", "s.toml", "--out", "out"]);
    let text = std::fs::read_to_string(bench.path("out/plate.json")).unwrap();
    let all: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(all["plate"]["measured_luminance"], true);
    // Every second degree from -60: straight ahead is 30, 20 degrees up 40. The whole image is seen from both.
    let seen = |row: usize| all["viewpoints"]["luminance"][row][30].as_f64().unwrap();
    let ratio = seen(40) / seen(30);
    // The image is 1.4 degrees wide: its points' mean elevation is its centre's to some hundredths of a degree.
    assert!((ratio - (2.0 + 20.0 / 60.0) / 2.0).abs() < 1e-3, "{ratio}");

    // A view shows it as well.
    write_still(&bench.path("p.png"), &Picture::filled(1, 1, [1.0; 4]), Depth::Eight).unwrap();
    let seen = |from: &str| {
        let view = ["view", "s.toml", "--display", "p.png", "--out", "v.exr", "--size", "8x8"];
        let more = ["--plate", "slit-mirror", "--light", "real", "--spp", "1024", "--from", from];
        bench.json(&[&view[..], &more].concat());
        let picture = read_still(&bench.path("v.exr")).unwrap().picture;
        picture.pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / 64.0
    };
    // 10 degrees up: a twelfth of the way from 2 to 3.
    let ratio = seen("0,138.919,787.846") / seen("0,0,800");
    // 65536 paths each, of which a third at least are real: 1 / sqrt(20000), and 3 of that.
    assert!((ratio - 13.0 / 12.0).abs() < 0.02, "{ratio}");

    bench.write("t.csv", "azimuth,elevation,value\n0,0,1\n0,ten,1\n");
    let said = bench.refuse(&["plate", "s.toml", "--out", "out"]);
    assert!(said.contains("line 3") && said.contains("luminance"), "{said}");
    bench.write("s.toml", plate("luminance = \"none.csv\""));
    let said = bench.refuse(&["plate", "s.toml", "--out", "out"]);
    assert!(said.contains("none.csv"), "{said}");
}

#[test]
fn an_ideal_plate_is_shown_as_the_usual_one_and_that_is_said() {
    let bench = Bench::new();
    bench.write("s.toml", plate(""));
    let told = bench.json(&["plate", "s.toml", "--out", "out"]);
    assert_eq!(told["plate"]["pitch"], 0.5);
    assert!(told["notes"][0].as_str().unwrap().contains("usual slit-mirror plate"), "{told}");
    bench.write("s.toml", plate("model = \"slit-mirror\"\npitch = 0.0"));
    assert!(bench.refuse(&["plate", "s.toml"]).contains("pitch"));
}
