//! Entities as text.

use super::text::Text;
use glam::DVec3;
use nappe::parallel;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// So many points or references are spelled by one thread without a pause.
const MANY: usize = 1 << 10;
/// The least of points or references that are worth being spelled later.
const FEW: usize = 8;
/// What a point takes in the file, about.
const POINT: usize = 80;
/// What a reference takes.
const REFERENCE: usize = 9;
/// Bytes, about, that one thread makes at once.
const PART: usize = 1 << 16;
/// Bytes, about, that are gathered before all threads make the text of them.
const BATCH: usize = 1 << 22;

/// What is spelled later. It stands in the text where it was asked for.
enum Later {
    /// Points with the number of the first.
    Points(u64, Vec<DVec3>),
    /// The numbers from the first on, separated.
    References(u64, usize),
}

impl Later {
    /// What it takes in the file, about.
    fn size(&self) -> usize {
        match self {
            Later::Points(_, points) => POINT * points.len(),
            Later::References(_, count) => REFERENCE * count,
        }
    }

    fn spell(&self, text: &mut Text) {
        match self {
            Later::Points(first, points) => text.points(*first, points),
            Later::References(first, count) => text.references(*first, *count),
        }
    }
}

/// Writes entities one after the other. Values are separated where they follow each other. Many points at once, and lists of
/// references to them, are spelled later, on all cores: their numbers are known before.
pub(super) struct Out<'w> {
    to: &'w mut (dyn Write + Send),
    text: Text,
    /// What comes later, and before which place of the text.
    later: Vec<(usize, Later)>,
    /// What that takes in the file, about.
    waiting: usize,
    threads: usize,
    last: u64,
    /// Whether all numbers were finite.
    finite: bool,
}

impl<'w> Out<'w> {
    pub(super) fn new(to: &'w mut (dyn Write + Send), threads: usize) -> Self {
        Out {
            to,
            text: Text::with_capacity(PART),
            later: Vec::new(),
            waiting: 0,
            threads,
            last: 0,
            finite: true,
        }
    }

    /// Whether all numbers up to here were finite; others have no spelling, and what is written is then worth nothing.
    pub(super) fn is_finite(&self) -> bool {
        self.finite
    }

    /// Text outside entities.
    pub(super) fn raw(&mut self, text: &str) {
        self.text.bytes.extend_from_slice(text.as_bytes());
    }

    /// A whole entity.
    pub(super) fn whole(&mut self, entity: &str) -> io::Result<u64> {
        self.last += 1;
        let line = format!("#{}={entity};\n", self.last);
        self.raw(&line);
        self.pass_on()?;
        Ok(self.last)
    }

    /// Begins an entity: its keyword and, where `named`, an empty name.
    pub(super) fn open(&mut self, keyword: &str) -> &mut Self {
        self.last += 1;
        self.text.begin(self.last);
        self.raw(keyword);
        self.text.bytes.push(b'(');
        self
    }

    /// Ends an entity and gives its number.
    pub(super) fn close(&mut self) -> io::Result<u64> {
        self.raw(");\n");
        self.pass_on()?;
        Ok(self.last)
    }

    fn put_later(&mut self, later: Later) {
        self.waiting += later.size();
        self.later.push((self.text.bytes.len(), later));
    }

    fn pass_on(&mut self) -> io::Result<()> {
        if self.text.bytes.len() + self.waiting >= BATCH {
            self.spell()?;
        }
        Ok(())
    }

    /// What is gathered, in parts of about [`PART`] bytes: where in the text each ends, and before which of what comes later.
    fn parts(&self) -> Vec<[usize; 2]> {
        let (mut parts, mut size, mut from) = (Vec::new(), 0, 0);
        for (k, (at, later)) in self.later.iter().enumerate() {
            size += at - from + later.size();
            from = *at;
            if size >= PART {
                parts.push([*at, k + 1]);
                size = 0;
            }
        }
        parts.push([self.text.bytes.len(), self.later.len()]);
        parts
    }

    /// Makes the text of what is gathered, and writes it.
    fn spell(&mut self) -> io::Result<()> {
        let parts = self.parts();
        let (text, later, failed) = (&self.text.bytes, &self.later, AtomicBool::new(false));
        let work = |i: usize| -> Vec<u8> {
            if failed.load(Relaxed) {
                return Vec::new();
            }
            let [mut from, first] = if i == 0 { [0; 2] } else { parts[i - 1] };
            let [end, last] = parts[i];
            let own = &later[first..last];
            let size: usize = own.iter().map(|(_, l)| l.size()).sum();
            let mut part = Text::with_capacity(end - from + size);
            for (at, l) in own {
                part.bytes.extend_from_slice(&text[from..*at]);
                l.spell(&mut part);
                from = *at;
            }
            part.bytes.extend_from_slice(&text[from..end]);
            part.bytes
        };
        let (to, mut done) = (&mut self.to, Ok(()));
        let take = |part: Vec<u8>| {
            if done.is_ok() {
                done = to.write_all(&part);
                failed.store(done.is_err(), Relaxed);
            }
        };
        parallel::in_order(self.threads, parts.len(), work, |_| false, take);
        self.text.bytes.clear();
        self.later.clear();
        self.waiting = 0;
        done
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        self.spell()?;
        self.to.flush()
    }

    fn comma(&mut self) {
        self.text.comma();
    }

    pub(super) fn reference(&mut self, id: u64) -> &mut Self {
        self.comma();
        self.text.bytes.push(b'#');
        self.text.digits(id);
        self
    }

    pub(super) fn count(&mut self, n: usize) -> &mut Self {
        self.comma();
        self.text.digits(n as u64);
        self
    }

    /// The shortest decimal that reads back as the same number, in the standard's spelling: `1.`, `2.5E-7`.
    pub(super) fn real(&mut self, x: f64) -> &mut Self {
        self.finite &= x.is_finite();
        self.text.real(x);
        self
    }

    /// `.T.`, or another value of an enumeration, or `$` or `*`.
    pub(super) fn word(&mut self, word: &str) -> &mut Self {
        self.comma();
        self.raw(word);
        self
    }

    pub(super) fn flag(&mut self, yes: bool) -> &mut Self {
        self.word(if yes { ".T." } else { ".F." })
    }

    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        self.comma();
        let text = encoded(text);
        self.raw(&text);
        self
    }

    /// Begins a list.
    pub(super) fn list(&mut self) -> &mut Self {
        self.comma();
        self.text.bytes.push(b'(');
        self
    }

    pub(super) fn end(&mut self) -> &mut Self {
        self.text.bytes.push(b')');
        self
    }

    pub(super) fn references(&mut self, ids: &[u64]) -> &mut Self {
        self.list();
        for id in ids {
            self.reference(*id);
        }
        self.end()
    }

    pub(super) fn reals(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        self.list();
        for x in values {
            self.real(x);
        }
        self.end()
    }

    /// A list of references to entities whose numbers follow each other.
    pub(super) fn references_from(&mut self, first: u64, count: usize) -> &mut Self {
        self.list();
        if count < FEW {
            self.text.references(first, count);
        } else {
            for from in (0..count).step_by(MANY) {
                if from > 0 {
                    self.text.bytes.push(b',');
                }
                self.put_later(Later::References(
                    first + from as u64,
                    MANY.min(count - from),
                ));
            }
        }
        self.end()
    }

    pub(super) fn point(&mut self, p: DVec3) -> io::Result<u64> {
        self.points(vec![p])
    }

    /// Points one after the other; the number of the first.
    pub(super) fn points(&mut self, points: Vec<DVec3>) -> io::Result<u64> {
        let first = self.last + 1;
        self.finite &= points.iter().all(|p| p.is_finite());
        self.last += points.len() as u64;
        if points.len() < FEW {
            self.text.points(first, &points);
        } else if points.len() <= MANY {
            self.put_later(Later::Points(first, points));
        } else {
            for (k, part) in points.chunks(MANY).enumerate() {
                self.put_later(Later::Points(first + (k * MANY) as u64, part.to_vec()));
                self.pass_on()?;
            }
        }
        self.pass_on()?;
        Ok(first)
    }

    pub(super) fn direction(&mut self, d: DVec3) -> io::Result<u64> {
        self.open("DIRECTION").text("").reals(d.to_array()).close()
    }

    /// A direction with a length.
    pub(super) fn vector(&mut self, way: DVec3, length: f64) -> io::Result<u64> {
        let direction = self.direction(way.normalize())?;
        self.open("VECTOR")
            .text("")
            .reference(direction)
            .real(length)
            .close()
    }

    pub(super) fn placement(&mut self, origin: DVec3, z: DVec3, x: DVec3) -> io::Result<u64> {
        let origin = self.point(origin)?;
        let (z, x) = (self.direction(z)?, self.direction(x)?);
        self.open("AXIS2_PLACEMENT_3D")
            .text("")
            .reference(origin)
            .reference(z)
            .reference(x)
            .close()
    }
}

/// A text between quotes, letters beyond ASCII as escapes.
pub(super) fn encoded(text: &str) -> String {
    let mut out = String::from("'");
    let mut wide = false;
    for c in text.chars() {
        let plain = (' '..='~').contains(&c);
        if plain == wide {
            out.push_str(if plain { "\\X0\\" } else { "\\X2\\" });
            wide = !plain;
        }
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            c if plain => out.push(c),
            c => {
                let mut units = [0; 2];
                for unit in c.encode_utf16(&mut units) {
                    out.push_str(&format!("{unit:04X}"));
                }
            }
        }
    }
    if wide {
        out.push_str("\\X0\\");
    }
    out.push('\'');
    out
}

#[cfg(test)]
mod tests {
    use super::{BATCH, Out, POINT};
    use glam::DVec3;
    use std::io;

    /// Points one by one, and many at once.
    fn written(threads: usize, at_once: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut out = Out::new(&mut bytes, threads);
        let point =
            |i: usize| DVec3::new(i as f64 / 3.0, -1e-9 * i as f64, 1e20 / (i as f64 + 0.5));
        for n in [1, 7, 8, 63, 1024, 1025, 5000, 3 * BATCH / POINT] {
            let points: Vec<DVec3> = (0..n).map(point).collect();
            let list = if at_once {
                let first = out.points(points).unwrap();
                out.open("LIST").references_from(first, n)
            } else {
                let ids: Vec<u64> = points.iter().map(|p| out.point(*p).unwrap()).collect();
                out.open("LIST").references(&ids)
            };
            list.close().unwrap();
        }
        assert!(out.is_finite());
        out.finish().unwrap();
        bytes
    }

    #[test]
    fn many_points_at_once_are_the_same_as_one_by_one_on_any_number_of_threads() {
        let one = written(1, false);
        assert!(one.len() > 2 * BATCH);
        for threads in [1, 2, 5] {
            assert!(written(threads, true) == one, "{threads}");
        }
    }

    #[test]
    fn points_that_are_not_finite_are_noticed_and_full_disks_told() {
        struct Full;
        impl io::Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::Error::from(io::ErrorKind::StorageFull))
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut full = Full;
        let mut out = Out::new(&mut full, 2);
        let mut points = vec![DVec3::ONE; 3 * BATCH / POINT];
        points[2000].y = f64::NAN;
        // Told soon, or at the end at the latest.
        let told = out.points(points).err();
        assert!(!out.is_finite() || told.is_some());
        let told = told.or_else(|| out.finish().err()).unwrap();
        assert_eq!(told.kind(), io::ErrorKind::StorageFull);
    }
}
