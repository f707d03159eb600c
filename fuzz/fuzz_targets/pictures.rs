//! Pictures: light that is finite and not negative, or refused by name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use midair::picture::decode_still;
use midair_fuzz::{reader, told};
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    reader(|| match decode_still(Path::new("a.picture"), data) {
        Ok(still) => {
            let picture = still.picture;
            assert_eq!(picture.pixels.len(), picture.width * picture.height);
            assert!(
                picture.pixels.iter().flatten().all(|light| light.is_finite() && *light >= 0.0)
            );
        }
        Err(error) => told(&error, "a.picture"),
    });
});
