//! Glass files and measured tables: numbers that are finite wherever they are asked for, or refused by name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use midair::optics::emission::EmissionTable;
use midair::optics::glass_file::GlassFile;
use midair::optics::plate::LuminanceTable;
use midair::optics::screen::ResponseTable;
use midair_fuzz::{chosen, reader, told};
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = chosen(data) else { return };
    let file = Path::new("a.table");
    reader(|| match first % 4 {
        0 => match GlassFile::from_yaml(bytes, file) {
            Ok(glass) => {
                let [low, high] = glass.range();
                assert!(low <= high);
            }
            Err(error) => told(&error, "a.table"),
        },
        1 => match LuminanceTable::from_csv(bytes, file) {
            Ok(table) => {
                let angles = table.brightest();
                assert!(angles.iter().all(|angle| angle.is_finite()));
                assert!(table.value(angles).is_none_or(f64::is_finite));
            }
            Err(error) => told(&error, "a.table"),
        },
        2 => match ResponseTable::from_csv(bytes, file) {
            Ok(table) => assert!(table.black().iter().all(|light| light.is_finite())),
            Err(error) => told(&error, "a.table"),
        },
        _ => match EmissionTable::from_csv(bytes, file) {
            Ok(table) => {
                for cosine in [1.0, 0.5, 0.01] {
                    assert!(table.relative(cosine).iter().all(|share| share.is_finite()));
                }
            }
            Err(error) => told(&error, "a.table"),
        },
    });
});
