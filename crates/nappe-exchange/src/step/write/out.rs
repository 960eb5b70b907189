//! Entities as text.

use super::text::Text;
use glam::DVec3;
use nappe::parallel;
use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Bytes gathered before they are handed on.
const PART: usize = 1 << 16;
/// So many points are spelled by one thread without a pause; fewer are spelled at once.
const POINTS: usize = 1 << 10;
/// The least of points that are worth another thread.
const FEW: usize = 64;
/// What a point takes in the file, about.
const POINT: usize = 70;
/// Bytes, about, that are spelled before all threads wait for each other.
const BATCH: usize = 1 << 22;

/// Entities one after the other.
enum Block {
    Text(Vec<u8>),
    /// Points with the number of the first.
    Points(u64, Vec<DVec3>),
}

impl Block {
    fn spelled(&self) -> Option<Vec<u8>> {
        let Block::Points(first, points) = self else {
            return None;
        };
        let mut text = Text::with_capacity(POINT * points.len());
        for (id, p) in (*first..).zip(points) {
            text.point(id, *p);
        }
        Some(text.bytes)
    }
}

/// Where the text goes in the end, and what is ready to go there.
struct Target<'w> {
    to: &'w mut (dyn Write + Send),
    ready: Vec<Vec<u8>>,
}

impl Target<'_> {
    fn pass_on(&mut self) -> io::Result<()> {
        self.ready.drain(..).try_for_each(|t| self.to.write_all(&t))
    }
}

/// Writes entities one after the other. Values are separated where they follow each other. Many points at once are spelled
/// later, on all cores: their numbers are known before.
pub(super) struct Out<'w> {
    target: Mutex<Target<'w>>,
    text: Text,
    blocks: Vec<Block>,
    /// Bytes of blocks, about.
    waiting: usize,
    threads: usize,
    last: u64,
    /// Whether all numbers were finite.
    finite: bool,
}

impl<'w> Out<'w> {
    pub(super) fn new(to: &'w mut (dyn Write + Send), threads: usize) -> Self {
        let ready = Vec::new();
        Out {
            target: Mutex::new(Target { to, ready }),
            text: Text::with_capacity(2 * PART),
            blocks: Vec::new(),
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

    fn pass_on(&mut self) -> io::Result<()> {
        if self.text.bytes.len() >= PART {
            self.cut();
        }
        if self.waiting >= BATCH {
            self.spell()?;
        }
        Ok(())
    }

    /// Makes a block of the text until here.
    fn cut(&mut self) {
        let next = Text::with_capacity(2 * PART);
        let text = std::mem::replace(&mut self.text, next).bytes;
        self.waiting += text.len();
        self.blocks.push(Block::Text(text));
    }

    /// Spells the blocks, while what was spelled before is written.
    fn spell(&mut self) -> io::Result<()> {
        let (blocks, target) = (&self.blocks, &self.target);
        let work = |i: usize| -> io::Result<Option<Vec<u8>>> {
            match i.checked_sub(1) {
                None => locked(target).pass_on().map(|()| None),
                Some(i) => Ok(blocks[i].spelled()),
            }
        };
        let spelled = parallel::each(self.threads, blocks.len() + 1, work, |r| r.is_err());
        let spelled: io::Result<Vec<Option<Vec<u8>>>> = spelled.into_iter().collect();
        let spelled = spelled?.into_iter().skip(1);
        let texts = self.blocks.drain(..).zip(spelled).map(|pair| match pair {
            (Block::Text(text), _) => text,
            (Block::Points(..), text) => text.unwrap_or_default(),
        });
        locked(&self.target).ready.extend(texts);
        self.waiting = 0;
        Ok(())
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        self.cut();
        self.spell()?;
        let mut target = locked(&self.target);
        target.pass_on()?;
        target.to.flush()
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

    pub(super) fn point(&mut self, p: DVec3) -> io::Result<u64> {
        self.last += 1;
        self.finite &= p.is_finite();
        self.text.point(self.last, p);
        self.pass_on()?;
        Ok(self.last)
    }

    /// Points one after the other.
    pub(super) fn points(&mut self, points: &[DVec3]) -> io::Result<Vec<u64>> {
        let first = self.last + 1;
        if points.len() < FEW {
            return points.iter().map(|p| self.point(*p)).collect();
        }
        self.cut();
        for part in points.chunks(POINTS) {
            self.finite &= part.iter().all(|p| p.is_finite());
            self.blocks
                .push(Block::Points(self.last + 1, part.to_vec()));
            self.last += part.len() as u64;
            self.waiting += POINT * part.len();
            self.pass_on()?;
        }
        Ok((first..=self.last).collect())
    }

    pub(super) fn direction(&mut self, d: DVec3) -> io::Result<u64> {
        self.open("DIRECTION").text("").reals(d.to_array()).close()
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

/// A lock that stays of use after a panic elsewhere: that ends the work anyway.
fn locked<'t, 'w>(target: &'t Mutex<Target<'w>>) -> MutexGuard<'t, Target<'w>> {
    target.lock().unwrap_or_else(PoisonError::into_inner)
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
        for n in [1, 63, 64, 1024, 5000, 3 * BATCH / POINT] {
            let points: Vec<DVec3> = (0..n).map(point).collect();
            let ids = if at_once {
                out.points(&points).unwrap()
            } else {
                points.iter().map(|p| out.point(*p).unwrap()).collect()
            };
            out.open("LIST")
                .references(&ids[..n.min(9)])
                .close()
                .unwrap();
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
        let told = out.points(&points).err();
        assert!(!out.is_finite() || told.is_some());
        let told = told.or_else(|| out.finish().err()).unwrap();
        assert_eq!(told.kind(), io::ErrorKind::StorageFull);
    }
}
