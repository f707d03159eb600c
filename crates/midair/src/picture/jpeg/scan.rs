//! Whether a scan has coded data for all of its blocks: Huffman codes are counted, after ITU-T T.81, annexes F and G; nothing is decoded.

/// What a scan is read by.
#[derive(Default)]
pub(super) struct Frame {
    /// Codes for differences of DC (0) and for AC (1), four each.
    tables: [[Table; 4]; 2],
    /// Blocks or groups of them between restarts; 0: none.
    interval: usize,
    size: [usize; 2],
    components: Vec<Component>,
    progressive: bool,
    /// Whether it is coded in a way that is followed here.
    followed: bool,
}

#[derive(Clone)]
struct Component {
    id: u8,
    /// Blocks across and down in a group of interleaved ones.
    sampling: [usize; 2],
    /// Blocks across and down, of the picture and with those that fill up the last groups.
    blocks: [usize; 2],
    padded: [usize; 2],
    /// For each block of a progressive picture, which coefficients are known not to be 0.
    nonzero: Vec<u64>,
}

/// Canonical Huffman codes.
#[derive(Clone, Default)]
struct Table {
    /// For each length from 1: the first code, how many there are, and the place of the first one's value.
    lengths: [(u32, u32, usize); 16],
    values: Vec<u8>,
}

/// Why counting stopped.
enum Stop {
    /// There are no more bits.
    Short,
    /// Bits that are no code.
    Damaged,
}

impl Frame {
    pub fn read_tables(&mut self, mut segment: &[u8]) {
        while let Some((&kind, rest)) = segment.split_first() {
            let Some((counts, rest)) = rest.split_at_checked(16) else { return };
            let total: usize = counts.iter().map(|&count| usize::from(count)).sum();
            let Some((values, rest)) = rest.split_at_checked(total) else { return };
            let (class, id) = (usize::from(kind >> 4), usize::from(kind & 15));
            if let Some(table) = self.tables.get_mut(class).and_then(|tables| tables.get_mut(id)) {
                *table = Table::new(counts, values);
            }
            segment = rest;
        }
    }

    pub fn read_interval(&mut self, segment: &[u8]) {
        if let Some(&[high, low]) = segment.get(..2) {
            self.interval = usize::from(u16::from_be_bytes([high, low]));
        }
    }

    /// A frame of the kind that its marker says: sequential (0xc0, 0xc1) or progressive (0xc2) Huffman codes are followed.
    pub fn begin(&mut self, marker: u8, segment: &[u8]) {
        self.progressive = marker == 0xc2;
        self.components.clear();
        self.followed = matches!(marker, 0xc0..=0xc2) && self.read_components(segment).is_some();
    }

    fn read_components(&mut self, segment: &[u8]) -> Option<()> {
        let &[_, y1, y0, x1, x0, count] = segment.first_chunk()?;
        self.size = [[x1, x0], [y1, y0]].map(|side| usize::from(u16::from_be_bytes(side)));
        let described = segment[6..].as_chunks::<3>().0.get(..usize::from(count))?;
        // A height of 0 is told at the end of the first scan: rare enough to be left to the decoder.
        let sound = !described.is_empty() && self.size.iter().all(|&side| side > 0);
        sound.then_some(())?;
        let sampling = |code: u8| [usize::from(code >> 4), usize::from(code & 15)];
        let all = || described.iter().map(|part| sampling(part[1]));
        all().flatten().all(|n| (1..=4).contains(&n)).then_some(())?;
        let most = [0, 1].map(|k| all().map(|s| s[k]).max().unwrap_or(1));
        let groups = [0, 1].map(|k| self.size[k].div_ceil(8 * most[k]));
        for part in described {
            let s = sampling(part[1]);
            let padded = [0, 1].map(|k| groups[k] * s[k]);
            self.components.push(Component {
                id: part[0],
                sampling: s,
                blocks: [0, 1].map(|k| (self.size[k] * s[k]).div_ceil(most[k]).div_ceil(8)),
                padded,
                nonzero: if self.progressive { vec![0; padded[0] * padded[1]] } else { Vec::new() },
            });
        }
        Some(())
    }

    /// Whether a scan ends before its last block does, or holds what is no code. `header` is what SOS has.
    pub fn is_short(&mut self, header: &[u8], coded: &[u8]) -> bool {
        if !self.followed {
            return false;
        }
        let Some(scan) = Scan::read(self, header) else { return false };
        let mut bits = Bits { bytes: coded, at: 0, held: 0, count: 0 };
        scan.count(self, &mut bits).is_err()
    }
}

/// A scan's header.
struct Scan {
    /// Places in the frame's list, with the numbers of the tables for DC and AC.
    parts: Vec<(usize, [usize; 2])>,
    /// First and last coefficient.
    band: [usize; 2],
    /// Whether known coefficients are refined.
    refines: bool,
}

impl Scan {
    fn read(frame: &Frame, header: &[u8]) -> Option<Self> {
        let (&count, rest) = header.split_first()?;
        let (parts, rest) = rest.split_at_checked(2 * usize::from(count))?;
        let &[first, last, bits] = rest.first_chunk()?;
        let part = |&[id, tables]: &[u8; 2]| {
            let place = frame.components.iter().position(|component| component.id == id)?;
            Some((place, [tables >> 4, tables & 15].map(|n| usize::from(n & 3))))
        };
        let parts = parts.as_chunks::<2>().0.iter().map(part).collect::<Option<Vec<_>>>()?;
        let band = [usize::from(first), usize::from(last).min(63)];
        (!parts.is_empty()).then_some(Self { parts, band, refines: bits >> 4 > 0 })
    }

    fn count(&self, frame: &mut Frame, bits: &mut Bits) -> Result<(), Stop> {
        let alone = self.parts.len() == 1;
        let first = &frame.components[self.parts[0].0];
        let groups = match alone {
            true => first.blocks,
            false => [0, 1].map(|k| first.padded[k] / first.sampling[k]),
        };
        // Blocks that have no more coefficients in this band.
        let mut run = 0;
        for group in 0..groups[0] * groups[1] {
            if frame.interval > 0 && group > 0 && group % frame.interval == 0 {
                bits.restart()?;
                run = 0;
            }
            let [x, y] = [group % groups[0], group / groups[0]];
            for &(place, tables) in &self.parts {
                let Component { sampling, padded, nonzero, .. } = &mut frame.components[place];
                let [across, down] = if alone { [1, 1] } else { *sampling };
                for block in 0..across * down {
                    let column = x * across + block % across;
                    let row = y * down + block / across;
                    let codes = [0, 1].map(|class| &frame.tables[class][tables[class]]);
                    match nonzero.get_mut(row * padded[0] + column) {
                        Some(known) => self.progress(known, codes, &mut run, bits)?,
                        None => sequential(codes, bits)?,
                    }
                }
            }
        }
        Ok(())
    }

    /// One block's share of a progressive scan.
    fn progress(
        &self,
        known: &mut u64,
        [dc, ac]: [&Table; 2],
        run: &mut u32,
        bits: &mut Bits,
    ) -> Result<(), Stop> {
        let [first, last] = self.band;
        match (first, self.refines) {
            (0, false) => {
                let size = dc.next(bits)?;
                bits.skip(size)
            }
            (0, true) => bits.skip(1),
            (_, false) => {
                if *run > 0 {
                    *run -= 1;
                    return Ok(());
                }
                let mut k = first;
                while k <= last {
                    let code = ac.next(bits)?;
                    let (zeros, size) = (code >> 4, code & 15);
                    if size == 0 && zeros < 15 {
                        *run = (1 << zeros) - 1 + bits.take(zeros)?;
                        break;
                    }
                    k += usize::from(zeros);
                    if size > 0 && k <= 63 {
                        bits.skip(size)?;
                        *known |= 1 << k;
                    }
                    k += 1;
                }
                Ok(())
            }
            (_, true) => self.refine(known, ac, run, bits),
        }
    }

    fn refine(
        &self,
        known: &mut u64,
        ac: &Table,
        run: &mut u32,
        bits: &mut Bits,
    ) -> Result<(), Stop> {
        let [first, last] = self.band;
        let mut k = first;
        while *run == 0 && k <= last {
            let code = ac.next(bits)?;
            let (mut zeros, size) = (code >> 4, code & 15);
            if size == 0 && zeros < 15 {
                *run = (1 << zeros) + bits.take(zeros)?;
                break;
            }
            // The new coefficient's sign.
            bits.skip(u8::from(size > 0))?;
            while k <= last {
                if *known >> k & 1 == 1 {
                    bits.skip(1)?;
                } else if zeros == 0 {
                    if size > 0 {
                        *known |= 1 << k;
                    }
                    k += 1;
                    break;
                } else {
                    zeros -= 1;
                }
                k += 1;
            }
        }
        if *run > 0 {
            // A correction for each that is known already.
            for k in k..=last {
                bits.skip((*known >> k & 1) as u8)?;
            }
            *run -= 1;
        }
        Ok(())
    }
}

/// One block of a sequential scan.
fn sequential([dc, ac]: [&Table; 2], bits: &mut Bits) -> Result<(), Stop> {
    let size = dc.next(bits)?;
    bits.skip(size)?;
    let mut k = 1;
    while k <= 63 {
        let code = ac.next(bits)?;
        let (zeros, size) = (code >> 4, code & 15);
        if size == 0 && zeros < 15 {
            break;
        }
        k += usize::from(zeros) + 1;
        bits.skip(size)?;
    }
    Ok(())
}

impl Table {
    fn new(counts: &[u8], values: &[u8]) -> Self {
        let mut lengths = [(0, 0, 0); 16];
        let (mut code, mut place) = (0u32, 0);
        for (length, &count) in lengths.iter_mut().zip(counts) {
            *length = (code, u32::from(count), place);
            place += usize::from(count);
            code = (code + u32::from(count)) << 1;
        }
        Self { lengths, values: values.to_vec() }
    }

    fn next(&self, bits: &mut Bits) -> Result<u8, Stop> {
        let mut code = 0;
        for &(first, count, place) in &self.lengths {
            code = code << 1 | bits.take(1)?;
            let offset = code.wrapping_sub(first);
            if offset < count {
                return self.values.get(place + offset as usize).copied().ok_or(Stop::Damaged);
            }
        }
        Err(Stop::Damaged)
    }
}

/// Coded data, bit by bit.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
    held: u8,
    count: u8,
}

impl Bits<'_> {
    fn take(&mut self, count: u8) -> Result<u32, Stop> {
        let mut value = 0;
        for _ in 0..count {
            if self.count == 0 {
                self.held = *self.bytes.get(self.at).ok_or(Stop::Short)?;
                if self.held == 0xff {
                    // A 0 is put behind it; anything else is a restart, where no bits are left.
                    if self.bytes.get(self.at + 1).is_some_and(|&byte| byte != 0) {
                        return Err(Stop::Short);
                    }
                    self.at += 1;
                }
                self.at += 1;
                self.count = 8;
            }
            self.count -= 1;
            value = value << 1 | u32::from(self.held >> self.count & 1);
        }
        Ok(value)
    }

    fn skip(&mut self, count: u8) -> Result<(), Stop> {
        self.take(count).map(drop)
    }

    /// Goes on behind the next restart.
    fn restart(&mut self) -> Result<(), Stop> {
        self.count = 0;
        let rest = self.bytes.get(self.at..).ok_or(Stop::Short)?;
        let found = rest.windows(2).position(|pair| pair[0] == 0xff && pair[1] != 0);
        self.at += found.ok_or(Stop::Short)? + 2;
        Ok(())
    }
}
