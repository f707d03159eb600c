//! Whether maps are complete: random set-ups of all kinds, each held against a brute force that shares nothing with the
//! inversion but the tracing of single rays.
//!
//! A few are judged in every test run. `cargo xtask campaign` judges hundreds; it sets these variables:
//! `MIDAIR_CAMPAIGN` (how many), `MIDAIR_CAMPAIGN_FIRST` (the first one's number), `MIDAIR_CAMPAIGN_SCENES` (scene files to judge
//! in their place, separated by colons).

mod judge;
mod set_ups;

use judge::{Care, Judge};
use midair::clock::Stopwatch;
use midair::map::{Accuracy, Map, Status, invert};
use midair::transport::Setup;
use midair_peers::campaign;
use rayon::prelude::*;
use std::path::Path;

/// How one set-up's map fared.
#[derive(Default)]
struct Verdict {
    pixels: usize,
    answered: usize,
    /// Pixels more than one from a border whose status is wrong.
    wrong: usize,
    /// Answers further from exact than the map's bound.
    beyond: usize,
    text: String,
}

fn status_index(status: Status) -> usize {
    status as usize
}

fn judged(name: &str, setup: &Setup, care: Care) -> Verdict {
    let start = Stopwatch::start();
    let (map, effort) = invert(setup, Accuracy::default());
    let inverted = start.elapsed();
    let mut judge = Judge::new(setup, care);
    let mut verdict = compare(&map, &mut judge);
    let took = start.elapsed();
    let shown = format!(
        "{name}: {} wrong, {} beyond the bound {:.1e}; {} rays, {} pixels of {}, {:.1} ms; judged by {} rays in {:.1} s{}\n",
        verdict.wrong,
        verdict.beyond,
        map.error_bound,
        effort.rays,
        effort.solved_pixels,
        verdict.pixels,
        inverted.as_secs_f64() * 1e3,
        judge.rays,
        took.as_secs_f64(),
        verdict.text,
    );
    verdict.text = shown;
    verdict
}

fn compare(map: &Map, judge: &mut Judge) -> Verdict {
    let mut verdict = Verdict { pixels: map.uv.len(), ..Verdict::default() };
    let place = |index: usize| (index % map.width, index / map.width);
    let (mut worst, mut where_beyond) = (0.0f64, String::new());
    // What the map answers counts if it is so: the judge, too, may have overlooked it.
    for (index, (uv, status)) in map.uv.iter().zip(&map.status).enumerate() {
        assert_eq!(
            status.is_answered(),
            !uv[0].is_nan(),
            "{status:?} with {uv:?} at {:?}",
            place(index)
        );
        if !status.is_answered() {
            continue;
        }
        let (x, y) = place(index);
        verdict.answered += 1;
        judge.try_root(x, y, *uv);
        if let Some([off, rounding]) = judge.error(x, y, *uv)
            && off > map.error_bound + rounding
        {
            verdict.beyond += 1;
            worst = worst.max(off);
            // The first few are enough to look into.
            if verdict.beyond <= 5 {
                let arrives = judge.roots[index].len();
                where_beyond += &format!(
                    "\n    off by {off:.1e} at {:?} {uv:?} {status:?}, {arrives} roots",
                    (x, y)
                );
            }
        }
    }
    // Where the two disagree, it is looked at again from what the judge knows of the pixels around, as long as that tells it more.
    loop {
        let disputed = (0..map.status.len()).filter(|&index| {
            let (x, y) = place(index);
            map.status[index] != judge.status(x, y)
        });
        let disputed: Vec<usize> = disputed.collect();
        let more = disputed.into_iter().filter(|&index| {
            let (x, y) = place(index);
            judge.look_around(x, y)
        });
        if more.count() == 0 {
            break;
        }
    }
    let mut kinds = [[0usize; 4]; 4];
    let mut first = [[None; 4]; 4];
    for (index, status) in map.status.iter().enumerate() {
        let (x, y) = place(index);
        let truth = judge.status(x, y);
        if *status != truth && judge.is_deep(x, y) {
            verdict.wrong += 1;
            kinds[status_index(*status)][status_index(truth)] += 1;
            first[status_index(*status)][status_index(truth)].get_or_insert((x, y));
        }
    }
    let names = ["ok", "folded", "outside", "blocked"];
    for said in 0..4 {
        for is in 0..4 {
            if let Some((x, y)) = first[said][is] {
                verdict.text += &format!(
                    "\n    {} {} that are {}: first {:?} {:?}, roots {:?}",
                    kinds[said][is],
                    names[said],
                    names[is],
                    (x, y),
                    map.uv[y * map.width + x],
                    judge.roots[y * map.width + x],
                );
            }
        }
    }
    if verdict.beyond > 0 {
        verdict.text += &where_beyond;
        verdict.text += &format!("\n    worst error {worst:.2e}");
    }
    verdict
}

fn set_up_of(path: &Path) -> Setup {
    let loaded =
        midair::scene::load(path).unwrap_or_else(|error| panic!("{}: {error:?}", path.display()));
    Setup::new(&loaded).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn no_status_is_wrong_more_than_a_pixel_from_a_border() {
    let campaign = campaign::number(campaign::COUNT);
    let verdicts: Vec<Verdict> = if let Ok(files) = std::env::var("MIDAIR_CAMPAIGN_SCENES") {
        files
            .split(':')
            .map(|file| {
                let verdict = judged(file, &set_up_of(Path::new(file)), Care::THOROUGH);
                print!("{}", verdict.text);
                verdict
            })
            .collect()
    } else {
        let first = campaign::number(campaign::FIRST).unwrap_or(0);
        let count = campaign.unwrap_or(27);
        let care = if campaign.is_some() { Care::THOROUGH } else { Care::QUICK };
        let folder = tempfile::tempdir().expect("a temporary folder");
        (first..first + count)
            .into_par_iter()
            .filter_map(|seed| {
                let (kind, text) = set_ups::random(seed);
                let file = folder.path().join(format!("{seed}.toml"));
                std::fs::write(&file, &text).expect("the folder is writable");
                // An eye inside of a solid, a plate that faces away: what a scene may not be.
                let loaded = midair::scene::load(&file).ok()?;
                let setup = Setup::new(&loaded).expect("the scene is sound");
                let name = format!("{seed} {kind}");
                let mut verdict = judged(&name, &setup, care);
                // A quick look overlooks what is thin: what it calls wrong is looked at again.
                if verdict.wrong > 0 && campaign.is_none() {
                    verdict = judged(&name, &setup, Care::THOROUGH);
                }
                if verdict.wrong + verdict.beyond > 0 || campaign.is_some() {
                    print!("{}", verdict.text);
                }
                if verdict.wrong + verdict.beyond > 0
                    && let Ok(kept) = std::env::var("MIDAIR_CAMPAIGN_KEEP")
                {
                    std::fs::write(Path::new(&kept).join(format!("{seed}.toml")), &text)
                        .expect("writable");
                }
                Some(verdict)
            })
            .collect()
    };
    let sum = |of: fn(&Verdict) -> usize| verdicts.iter().map(of).sum::<usize>();
    let (wrong, beyond) = (sum(|v| v.wrong), sum(|v| v.beyond));
    println!(
        "{} set-ups, {} pixels, {} answered: {wrong} statuses wrong in {} set-ups, {beyond} answers beyond the bound in {}",
        verdicts.len(),
        sum(|v| v.pixels),
        sum(|v| v.answered),
        verdicts.iter().filter(|v| v.wrong > 0).count(),
        verdicts.iter().filter(|v| v.beyond > 0).count(),
    );
    assert!(!verdicts.is_empty() && sum(|v| v.answered) > 0, "nothing was compared");
    assert_eq!((wrong, beyond), (0, 0));
}
