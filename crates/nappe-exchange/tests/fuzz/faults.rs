//! Faults that files may have.

use crate::seeds::{packed, unpacked};

/// Numbers from Knuth's linear congruence.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// Numbers in the place of others.
const NUMBERS: [&[u8]; 12] = [
    b"1e308",
    b"-1",
    b"0",
    b"99999999",
    b"4294967295",
    b"18446744073709551615",
    b"-9223372036854775808",
    b"1e-320",
    b"nan",
    b"1e19",
    b"65536",
    b"0.5",
];
/// The same in files that are not text.
const WORDS: [[u8; 4]; 6] = [
    [0xff; 4],
    [0; 4],
    [0xff, 0xff, 0xff, 0x7f],
    [0, 0, 0, 0x80],
    [0, 0, 0xc0, 0x7f],
    [1, 0, 0, 0],
];

/// A file with some faults. What is packed is most often changed before it is packed.
pub(crate) fn file(ending: &str, whole: &[u8], random: &mut Random) -> Vec<u8> {
    if ending == "3mf" && random.below(4) > 0 {
        let mut model = unpacked(whole);
        (0..=random.below(3)).for_each(|_| fault(&mut model, random));
        return packed(&model);
    }
    let mut out = whole.to_vec();
    (0..=random.below(4)).for_each(|_| fault(&mut out, random));
    out
}

/// The numbers in text from a place on: where the first starts and ends.
fn number(bytes: &[u8], from: usize) -> Option<[usize; 2]> {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let start = from + bytes[from..].iter().position(u8::is_ascii_digit)?;
    let length = bytes[start..].iter().position(|b| !is_part(b));
    Some([start, length.map_or(bytes.len(), |n| start + n)])
}

fn fault(out: &mut Vec<u8>, random: &mut Random) {
    if out.is_empty() {
        return;
    }
    let at = random.below(out.len());
    // Short parts most often, sometimes long ones.
    let most = if random.below(8) == 0 { 2000 } else { 30 };
    let end = (at + 1 + random.below(most)).min(out.len());
    let to = random.below(out.len());
    match random.below(10) {
        0 => out[at] ^= 1 << random.below(8),
        1 => out[at] = b"0123456789#(),.'\"$*;=/\\-E<> \n\xff\0"[random.below(31)],
        2 => drop(out.drain(at..end)),
        // Doubled, and moved somewhere else.
        3 => {
            let part = out[at..end].to_vec();
            out.splice(at..at, part);
        }
        4 => {
            let part = out[at..end].to_vec();
            out.splice(to..to, part);
        }
        5 | 6 => {
            if let Some([a, b]) = number(out, at) {
                out.splice(a..b, NUMBERS[random.below(NUMBERS.len())].iter().copied());
            }
        }
        // The number of something else, also of what names it.
        7 => {
            let (from, near) = (number(out, at), random.below(2) == 0);
            let back = if near { at.saturating_sub(200) } else { to };
            if let (Some([a, b]), Some([c, d])) = (from, number(out, back)) {
                let other = out[c..d].to_vec();
                out.splice(a..b, other);
            }
        }
        8 => {
            let word = WORDS[random.below(WORDS.len())];
            let place = at & !3;
            for (k, w) in word.into_iter().enumerate() {
                if let Some(b) = out.get_mut(place + k) {
                    *b = w;
                }
            }
        }
        _ => {
            if random.below(6) == 0 {
                out.truncate(at);
            }
        }
    }
}
