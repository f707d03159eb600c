//! Scene text: a scene that is saved and read again as it was, or refused with its line.
#![no_main]

use libfuzzer_sys::fuzz_target;
use midair::scene::{Format, parse, to_toml};
use midair_fuzz::{chosen, reader, told};

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = chosen(data) else { return };
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let format = if first & 1 == 0 { Format::Toml } else { Format::Json };
    reader(|| match parse(text, "a.scene", format) {
        Ok(scene) => {
            let saved = to_toml(&scene);
            let again = parse(&saved, "saved.scene", Format::Toml);
            assert_eq!(again.as_ref().ok(), Some(&scene), "{saved}");
        }
        Err(error) => told(&error, "a.scene"),
    });
});
