//! Numbers and points as text.

use glam::DVec3;

/// Text that grows.
pub(super) struct Text {
    pub(super) bytes: Vec<u8>,
    number: zmij::Buffer,
}

/// The longest power of ten of a number, with its letter: `e-308`.
const POWER: usize = 5;

impl Text {
    pub(super) fn with_capacity(bytes: usize) -> Self {
        Text {
            bytes: Vec::with_capacity(bytes),
            number: zmij::Buffer::new(),
        }
    }

    /// Begins an entity.
    pub(super) fn begin(&mut self, id: u64) {
        self.bytes.push(b'#');
        self.digits(id);
        self.bytes.push(b'=');
    }

    /// A comma, unless a list begins here.
    pub(super) fn comma(&mut self) {
        if self.bytes.last() != Some(&b'(') {
            self.bytes.push(b',');
        }
    }

    pub(super) fn digits(&mut self, n: u64) {
        self.bytes.extend_from_slice(Counter::new(n).digits());
    }

    /// The shortest decimal that reads back as the same number, in the standard's spelling: `1.`, `2.5E-7`; `0.` for what is
    /// not finite.
    pub(super) fn real(&mut self, x: f64) {
        self.comma();
        self.spell(x);
    }

    fn spell(&mut self, x: f64) {
        if !x.is_finite() {
            return self.bytes.extend_from_slice(b"0.");
        }
        let digits = self.number.format_finite(x).as_bytes();
        let tail = digits.len().saturating_sub(POWER);
        let Some(at) = digits[tail..].iter().position(|b| *b == b'e') else {
            let digits = digits
                .strip_suffix(b"0")
                .filter(|d| d.ends_with(b"."))
                .unwrap_or(digits);
            return self.bytes.extend_from_slice(digits);
        };
        let (mantissa, power) = digits.split_at(tail + at);
        let mantissa = mantissa.strip_suffix(b".0").unwrap_or(mantissa);
        self.bytes.extend_from_slice(mantissa);
        if !mantissa.contains(&b'.') {
            self.bytes.push(b'.');
        }
        self.bytes.push(b'E');
        self.bytes.extend_from_slice(&power[1..]);
    }

    /// Whole points whose numbers follow each other.
    pub(super) fn points(&mut self, first: u64, points: &[DVec3]) {
        let mut number = Counter::new(first);
        for p in points {
            self.bytes.push(b'#');
            self.bytes.extend_from_slice(number.digits());
            number.add_one();
            self.bytes.extend_from_slice(b"=CARTESIAN_POINT('',(");
            self.spell(p.x);
            self.bytes.push(b',');
            self.spell(p.y);
            self.bytes.push(b',');
            self.spell(p.z);
            self.bytes.extend_from_slice(b"));\n");
        }
    }

    /// References that follow each other, separated.
    pub(super) fn references(&mut self, first: u64, count: usize) {
        let mut number = Counter::new(first);
        for k in 0..count {
            self.bytes
                .extend_from_slice(if k == 0 { b"#" } else { b",#" });
            self.bytes.extend_from_slice(number.digits());
            number.add_one();
        }
    }
}

/// The digits of one number after the other: adding 1 to them takes less than making them.
struct Counter {
    digits: [u8; DIGITS],
    /// Where the number begins.
    at: usize,
}

/// The digits of the largest number.
const DIGITS: usize = 20;

impl Counter {
    fn new(first: u64) -> Self {
        let (mut digits, mut at, mut n) = ([b'0'; DIGITS], DIGITS, first);
        loop {
            at -= 1;
            digits[at] = b'0' + (n % 10) as u8;
            n /= 10;
            if n == 0 {
                return Counter { digits, at };
            }
        }
    }

    fn digits(&self) -> &[u8] {
        &self.digits[self.at..]
    }

    fn add_one(&mut self) {
        for (i, d) in self.digits.iter_mut().enumerate().rev() {
            if *d < b'9' {
                *d += 1;
                self.at = self.at.min(i);
                return;
            }
            *d = b'0';
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Text;

    fn spelled(x: f64) -> String {
        let mut text = Text::with_capacity(0);
        text.spell(x);
        String::from_utf8(text.bytes).unwrap()
    }

    #[test]
    fn references_count_up_over_any_power_of_ten() {
        for first in [0, 1, 8, 98, 99_999_999_995, u64::MAX - 12] {
            let mut text = Text::with_capacity(0);
            text.references(first, 12);
            let wanted: Vec<String> = (first..first + 12).map(|n| format!("#{n}")).collect();
            assert_eq!(String::from_utf8(text.bytes).unwrap(), wanted.join(","));
        }
    }

    #[test]
    fn numbers_have_a_point_and_read_back_the_same() {
        for (x, text) in [
            (0.0, "0."),
            (-0.0, "-0."),
            (1.0, "1."),
            (100.0, "100."),
            (-2.5e-7, "-2.5E-7"),
            (1e-7, "1.E-7"),
            (1e300, "1.E+300"),
            (5e-324, "5.E-324"),
            (0.1, "0.1"),
        ] {
            assert_eq!(spelled(x), text);
        }
        let mut bits = 1u64;
        for _ in 0..20_000 {
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = f64::from_bits(bits);
            if x.is_finite() {
                let text = spelled(x);
                assert!(text.contains('.') && !text.contains('e'), "{text}");
                assert_eq!(
                    text.parse::<f64>().unwrap().to_bits(),
                    x.to_bits(),
                    "{text}"
                );
            }
        }
    }
}
