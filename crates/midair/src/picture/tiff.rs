//! What a TIFF file says of itself beyond what its decoder tells: its colour profile, how its colours lie, how many pages there are.

/// Of a file's first picture, and how many there are.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Facts {
    /// The ICC profile; `None` where there is none, or not all of it.
    pub profile: Option<Vec<u8>>,
    /// Whether the colours are stored plane by plane.
    pub in_planes: bool,
    /// Pictures, those that are smaller copies of others (previews) left out.
    pub pages: usize,
}

/// More pages than this are not counted.
const MOST_PAGES: usize = 1000;

/// The facts of a TIFF (TIFF 6.0, section 2) or a BigTIFF; `None` where its first directory is not there. The profile's tag is ICC.1:2010, annex B.4.
pub(super) fn facts(bytes: &[u8]) -> Option<Facts> {
    const SUBFILE: u64 = 254;
    const SAMPLES: u64 = 277;
    const PLANES: u64 = 284;
    const PROFILE: u64 = 34675;
    let file = File::of(bytes)?;
    let first = file.directory(file.first)?;
    let profile = first.iter().find(|entry| entry.tag == PROFILE).and_then(|entry| {
        let (at, length) = (usize::try_from(entry.value).ok()?, usize::try_from(entry.count).ok()?);
        bytes.get(at..at.checked_add(length)?).map(<[u8]>::to_vec)
    });
    let short = |entries: &[Entry], tag: u64| {
        entries.iter().find(|entry| entry.tag == tag).map(|entry| entry.short)
    };
    let in_planes = short(&first, PLANES) == Some(2) && short(&first, SAMPLES).unwrap_or(1) > 1;
    let mut pages = 0;
    let mut at = file.first;
    for _ in 0..MOST_PAGES {
        let Some(entries) = file.directory(at) else { break };
        // The lowest bit: a smaller copy.
        pages += usize::from(short(&entries, SUBFILE).unwrap_or(0) & 1 == 0);
        match file.next(at, entries.len()) {
            // Directories stand in a row; one that leads back goes round for ever.
            Some(next) if next > at => at = next,
            _ => break,
        }
    }
    Some(Facts { profile, in_planes, pages })
}

struct File<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    /// Numbers of 8 bytes for 4.
    wide: bool,
    /// Where the first directory is.
    first: usize,
}

struct Entry {
    tag: u64,
    count: u64,
    /// The value, or where it is.
    value: u64,
    /// The value, where it is a number of 16 bits.
    short: u64,
}

impl<'a> File<'a> {
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let big_endian = match bytes.get(..2)? {
            b"II" => false,
            b"MM" => true,
            _ => return None,
        };
        let mut file = Self { bytes, big_endian, wide: false, first: 0 };
        file.wide = match file.number(2, 2)? {
            42 => false,
            43 if file.number(4, 2)? == 8 => true,
            _ => return None,
        };
        let at = if file.wide { file.number(8, 8)? } else { file.number(4, 4)? };
        file.first = usize::try_from(at).ok()?;
        Some(file)
    }

    fn number(&self, at: usize, length: usize) -> Option<u64> {
        let digits = self.bytes.get(at..at.checked_add(length)?)?;
        let join = |sum: u64, digit: &u8| sum << 8 | u64::from(*digit);
        Some(match self.big_endian {
            true => digits.iter().fold(0, join),
            false => digits.iter().rev().fold(0, join),
        })
    }

    /// Bytes of a directory's count, of an entry, and of a number in it.
    fn layout(&self) -> [usize; 3] {
        if self.wide { [8, 20, 8] } else { [2, 12, 4] }
    }

    fn directory(&self, at: usize) -> Option<Vec<Entry>> {
        let [head, size, number] = self.layout();
        let count = usize::try_from(self.number(at, head)?).ok()?;
        let start = at.checked_add(head)?;
        // What the file does not hold is not asked for.
        let end = start.checked_add(count.checked_mul(size)?)?;
        self.bytes.get(start..end)?;
        let entry = |k: usize| {
            let place = start + k * size;
            Some(Entry {
                tag: self.number(place, 2)?,
                count: self.number(place + 4, number)?,
                value: self.number(place + 4 + number, number)?,
                short: self.number(place + 4 + number, 2)?,
            })
        };
        (0..count).map(entry).collect()
    }

    /// Where the directory after this one of `count` entries is; `None` behind the last.
    fn next(&self, at: usize, count: usize) -> Option<usize> {
        let [head, size, number] = self.layout();
        let next = self.number(at + head + count * size, number)?;
        usize::try_from(next).ok().filter(|&next| next > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_is_found_in_either_order_of_bytes_and_hostile_files_have_none() {
        // Header, a directory of one entry at 8, and five bytes at 26.
        let little = b"II\x2a\0\x08\0\0\0\x01\0\x73\x87\x07\0\x05\0\0\0\x1a\0\0\0\0\0\0\0hello";
        let big = b"MM\0\x2a\0\0\0\x08\0\x01\x87\x73\0\x07\0\0\0\x05\0\0\0\x1a\0\0\0\0hello";
        let hello = Facts { profile: Some(b"hello".to_vec()), in_planes: false, pages: 1 };
        assert_eq!(facts(little).as_ref(), Some(&hello));
        assert_eq!(facts(big).as_ref(), Some(&hello));
        for cut in 0..little.len() {
            assert_eq!(facts(&little[..cut]).and_then(|facts| facts.profile), None);
        }
        assert_eq!(facts(&[b"II\x2a\0".as_slice(), &[255; 40]].concat()), None);
    }

    /// A file of directories in a row, each with entries of a number of 16 bits.
    fn file(wide: bool, directories: &[&[(u16, u16)]]) -> Vec<u8> {
        let number = |value: usize| match wide {
            true => (value as u64).to_le_bytes().to_vec(),
            false => (value as u32).to_le_bytes().to_vec(),
        };
        let mut bytes = b"II".to_vec();
        bytes.extend(if wide { &b"\x2b\0\x08\0\0\0"[..] } else { b"\x2a\0" });
        let first = bytes.len() + number(0).len();
        bytes.extend(number(first));
        for (k, entries) in directories.iter().enumerate() {
            match wide {
                true => bytes.extend(number(entries.len())),
                false => bytes.extend((entries.len() as u16).to_le_bytes()),
            }
            for &(tag, value) in *entries {
                bytes.extend([tag.to_le_bytes(), 3u16.to_le_bytes()].concat());
                bytes.extend(number(1));
                bytes.extend(number(value.into()));
            }
            let after = bytes.len() + number(0).len();
            bytes.extend(number(if k + 1 < directories.len() { after } else { 0 }));
        }
        bytes
    }

    #[test]
    fn pages_and_planes_are_told() {
        for wide in [false, true] {
            let of = |directories: &[&[(u16, u16)]]| {
                let facts = facts(&file(wide, directories)).unwrap();
                (facts.in_planes, facts.pages)
            };
            assert_eq!(of(&[&[(277, 3), (284, 2)]]), (true, 1));
            assert_eq!(of(&[&[(277, 1), (284, 2)]]), (false, 1));
            assert_eq!(of(&[&[(277, 3), (284, 1)], &[(277, 3)]]), (false, 2));
            // A preview is no page.
            assert_eq!(of(&[&[(277, 3)], &[(254, 1)], &[(254, 2)]]), (false, 2));
        }
    }
}
