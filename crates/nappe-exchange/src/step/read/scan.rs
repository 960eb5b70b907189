//! One pass over the bytes of a file: where each entity begins, and of which kind it is.
//!
//! Nothing is copied: parameters are parsed where they lie when they are asked for. So a file needs its own size in memory and 24
//! bytes an entity.

use super::super::StepError;
use nappe::parallel;
use std::collections::HashMap;

/// Where an entity is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Its number: 12 for `#12`.
    pub(super) id: u64,
    /// Where its keyword (or the parenthesis of a complex entity) begins.
    pub(super) at: usize,
    /// Index into [`Scan::kinds`].
    pub(super) kind: u32,
}

/// A keyword of the file.
#[derive(Clone, Debug)]
pub(super) struct Kind {
    /// The keyword; of a complex entity a parenthesis and its first keyword.
    pub(super) name: String,
    /// How many entities have it.
    pub(super) count: usize,
}

/// What one pass finds.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// All entities in the order of the file.
    pub(super) entries: Vec<Entry>,
    /// All keywords in the order of their first entities.
    pub(super) kinds: Vec<Kind>,
    /// Where the entities of the header begin: `FILE_NAME(…)`.
    pub(super) header: Vec<usize>,
}

/// The most entities of a file: what 32-bit indices can name.
const MOST: usize = u32::MAX as usize;
/// Letters of a wrong text that a message shows.
const SHOWN: usize = 24;

/// The line of a place, from 1.
pub(super) fn line(bytes: &[u8], at: usize) -> usize {
    1 + bytes[..at.min(bytes.len())]
        .iter()
        .filter(|b| **b == b'\n')
        .count()
}

/// Lines of a file at every so many bytes, so that those of many places are found soon.
#[derive(Debug)]
pub(super) struct Lines(Vec<usize>);

/// Bytes between two places where [`Lines`] are counted.
const COUNTED: usize = 1 << 15;

impl Lines {
    pub(super) fn new(bytes: &[u8]) -> Self {
        let mut lines = 0;
        let counted = bytes.chunks(COUNTED).map(|part| {
            let before = lines;
            lines += line(part, part.len()) - 1;
            before
        });
        Lines(counted.collect())
    }

    /// The line of a place, from 1.
    pub(super) fn line(&self, bytes: &[u8], at: usize) -> usize {
        let part = at / COUNTED;
        self.0.get(part).map_or_else(
            || line(bytes, at),
            |before| before + line(&bytes[part * COUNTED..], at - part * COUNTED),
        )
    }
}

/// The beginning of what stands at a place, for a message.
pub(super) fn shown(bytes: &[u8], at: usize) -> String {
    let rest = &bytes[at.min(bytes.len())..];
    let rest = &rest[..rest.len().min(SHOWN)];
    let end = rest.iter().position(|b| *b == b'\n' || *b == b'\r');
    String::from_utf8_lossy(&rest[..end.unwrap_or(rest.len())])
        .replace(char::is_control, " ")
        .trim_end()
        .to_owned()
}

/// What a byte means between the tokens of a statement.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    Nothing,
    End,
    Quote,
    Slash,
}

const MARKS: [Mark; 256] = {
    let mut marks = [Mark::Nothing; 256];
    marks[b';' as usize] = Mark::End;
    marks[b'\'' as usize] = Mark::Quote;
    marks[b'/' as usize] = Mark::Slash;
    marks
};

/// A place in a file.
struct Walk<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Walk<'_> {
    fn cut_off(&self, at: usize, what: &'static str) -> StepError {
        StepError::CutOff {
            line: line(self.bytes, at),
            what,
        }
    }

    /// Skips blanks and comments.
    fn blanks(&mut self) -> Result<(), StepError> {
        loop {
            match self.bytes.get(self.at) {
                Some(b' ' | b'\t' | b'\r' | b'\n') => self.at += 1,
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'*') => self.comment()?,
                _ => return Ok(()),
            }
        }
    }

    fn comment(&mut self) -> Result<(), StepError> {
        let start = self.at;
        let rest = &self.bytes[start + 2..];
        match rest.windows(2).position(|w| w == b"*/") {
            Some(n) => self.at = start + 2 + n + 2,
            None => return Err(self.cut_off(start, "a comment")),
        }
        Ok(())
    }

    /// Goes behind the semicolon that ends the statement beginning at `start`.
    fn statement(&mut self, start: usize) -> Result<(), StepError> {
        loop {
            let Some(&b) = self.bytes.get(self.at) else {
                return Err(self.cut_off(start, "an entity"));
            };
            match MARKS[b as usize] {
                Mark::Nothing => self.at += 1,
                Mark::End => {
                    self.at += 1;
                    return Ok(());
                }
                Mark::Quote => {
                    let quote = self.at;
                    let rest = &self.bytes[quote + 1..];
                    // A doubled quote ends one string and begins the next, which comes to the same.
                    match rest.iter().position(|b| *b == b'\'') {
                        Some(n) => self.at = quote + 1 + n + 1,
                        None => return Err(self.cut_off(quote, "a text")),
                    }
                }
                Mark::Slash if self.bytes.get(self.at + 1) == Some(&b'*') => self.comment()?,
                Mark::Slash => self.at += 1,
            }
        }
    }

    fn wrong(&self, what: &'static str) -> StepError {
        StepError::Syntax {
            line: line(self.bytes, self.at),
            what,
            found: shown(self.bytes, self.at),
        }
    }

    /// The number after a `#`, without the digits' place in the file.
    fn number(&mut self) -> Result<u64, StepError> {
        let start = self.at;
        let mut id: u64 = 0;
        while let Some(d) = self.bytes.get(self.at).filter(|b| b.is_ascii_digit()) {
            let next = id
                .checked_mul(10)
                .and_then(|n| n.checked_add(u64::from(d - b'0')));
            id = next.ok_or_else(|| StepError::Number {
                line: line(self.bytes, start),
                digits: shown(self.bytes, start),
            })?;
            self.at += 1;
        }
        if self.at == start {
            return Err(self.wrong("the number of an entity"));
        }
        Ok(id)
    }

    fn keyword(&self) -> &[u8] {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let end = rest
            .iter()
            .position(|b| !(b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'!')));
        &rest[..end.unwrap_or(rest.len())]
    }
}

/// Which part of the file statements belong to.
#[derive(PartialEq, Eq)]
enum Section {
    None,
    Header,
    Data,
    /// Anchors, references and signatures, which say nothing about shapes.
    Other,
}

/// Keywords with their indices.
type Numbers = HashMap<Vec<u8>, u32>;

/// The entities of a part of the file, if an entity begins where it does.
struct Found {
    start: usize,
    /// Behind the last of them.
    end: usize,
    found: Scan,
}

/// Files are divided in parts of so many bytes, each of which may be read by another thread.
const PART: usize = 1 << 20;

/// The entities of parts of a file that begin at lines with a `#` after lines that end with a semicolon. Where such a line is
/// no entity but inside a text or a comment, what is found there is of no use, but does no harm: nobody gets there.
fn parts(bytes: &[u8], threads: usize) -> Vec<Found> {
    let count = if threads > 1 { bytes.len() / PART } else { 0 };
    let begin = |i: usize| {
        let rest = &bytes[i * PART..];
        let rest = &rest[..rest.len().min(PART)];
        rest.windows(3)
            .position(|w| w == b";\n#")
            .map(|n| i * PART + n + 2)
    };
    let work = |i: usize| -> Option<Found> {
        let start = begin(i)?;
        let most = (i + 1..=count).find_map(begin).unwrap_or(bytes.len());
        let (mut walk, mut found) = (Walk { bytes, at: start }, Scan::default());
        let mut numbers = Numbers::new();
        let mut end = start;
        while walk.at < most && bytes.get(walk.at) == Some(&b'#') {
            if entity(&mut walk, &mut found, &mut numbers).is_err() || walk.blanks().is_err() {
                return None;
            }
            end = walk.at;
        }
        Some(Found { start, end, found })
    };
    let found = parallel::each(threads, count, |i| work(i + 1), |_| false);
    found.into_iter().flatten().collect()
}

impl Scan {
    /// Adds the entities that follow.
    fn append(&mut self, next: Scan, numbers: &mut Numbers) -> Result<(), StepError> {
        if self.entries.len() + next.entries.len() > MOST {
            return Err(StepError::TooMany { most: MOST });
        }
        let kinds = next.kinds.into_iter().map(|k| {
            let number = numbered(&mut self.kinds, numbers, k.name.as_bytes());
            self.kinds[number as usize].count += k.count;
            number
        });
        let kinds: Vec<u32> = kinds.collect();
        let own = |e: Entry| Entry {
            kind: kinds[e.kind as usize],
            ..e
        };
        self.entries.extend(next.entries.into_iter().map(own));
        Ok(())
    }
}

/// Reads over an entity.
fn entity(walk: &mut Walk<'_>, found: &mut Scan, numbers: &mut Numbers) -> Result<(), StepError> {
    let start = walk.at;
    walk.at += 1;
    let id = walk.number()?;
    walk.blanks()?;
    if walk.bytes.get(walk.at) != Some(&b'=') {
        return Err(walk.wrong("`=` after the number of an entity"));
    }
    walk.at += 1;
    walk.blanks()?;
    let at = walk.at;
    let kind = kind(walk, &mut found.kinds, numbers, &found.entries)?;
    walk.statement(start)?;
    if found.entries.len() == MOST {
        return Err(StepError::TooMany { most: MOST });
    }
    found.kinds[kind as usize].count += 1;
    found.entries.push(Entry { id, at, kind });
    Ok(())
}

/// Finds all entities, on so many threads, of which the result does not depend. Errors: no STEP file, a text, comment or
/// entity without an end.
pub(super) fn scan(bytes: &[u8], threads: usize) -> Result<Scan, StepError> {
    let mut walk = Walk { bytes, at: 0 };
    if bytes.starts_with(b"\xef\xbb\xbf") {
        walk.at = 3;
    }
    walk.blanks()?;
    if walk.keyword() != b"ISO-10303-21" {
        return Err(StepError::NotStep {
            line: line(bytes, walk.at),
            found: shown(bytes, walk.at),
        });
    }
    let mut found = Scan::default();
    let mut numbers = Numbers::new();
    let mut parts = parts(bytes, threads).into_iter().peekable();
    let (mut section, mut data) = (Section::None, false);
    let mut begun = walk.at;
    loop {
        walk.blanks()?;
        let start = walk.at;
        if section == Section::Data && bytes.get(start) == Some(&b'#') {
            // What another thread found begins where an entity does, or else counts for nothing.
            while parts.next_if(|p| p.start < start).is_some() {}
            if let Some(part) = parts.next_if(|p| p.start == start) {
                walk.at = part.end;
                found.append(part.found, &mut numbers)?;
                continue;
            }
            entity(&mut walk, &mut found, &mut numbers)?;
            continue;
        }
        let what = match section {
            Section::None => "the file",
            Section::Header => "the HEADER section",
            Section::Data => "the DATA section",
            Section::Other => "a section",
        };
        if start >= bytes.len() {
            return Err(walk.cut_off(begun, what));
        }
        match walk.keyword() {
            b"HEADER" => (section, begun) = (Section::Header, start),
            b"DATA" => (section, begun, data) = (Section::Data, start, true),
            b"ANCHOR" | b"REFERENCE" | b"SIGNATURE" if section == Section::None => {
                (section, begun) = (Section::Other, start);
            }
            b"ENDSEC" => section = Section::None,
            b"END-ISO-10303-21" => break,
            b"" if section == Section::Data => return Err(walk.wrong("an entity (`#1 = …;`)")),
            _ if section == Section::Header => found.header.push(start),
            _ => {}
        }
        walk.statement(start)?;
    }
    if data {
        Ok(found)
    } else {
        Err(StepError::NoData)
    }
}

/// The kind of the entity whose keyword stands here.
fn kind<'a>(
    walk: &mut Walk<'a>,
    kinds: &mut Vec<Kind>,
    numbers: &mut Numbers,
    entries: &[Entry],
) -> Result<u32, StepError> {
    let complex = walk.bytes.get(walk.at) == Some(&b'(');
    if complex {
        walk.at += 1;
        walk.blanks()?;
    }
    let name = walk.keyword();
    if name.is_empty() {
        return Err(walk.wrong("the keyword of an entity"));
    }
    // Most entities are of the kind of the one before.
    if let Some(last) = entries.last()
        && !complex
        && kinds[last.kind as usize].name.as_bytes() == name
    {
        walk.at += name.len();
        return Ok(last.kind);
    }
    let mut key = Vec::with_capacity(name.len() + 1);
    if complex {
        key.push(b'(');
    }
    key.extend(name.iter().map(u8::to_ascii_uppercase));
    Ok(numbered(kinds, numbers, &key))
}

/// The index of a keyword.
fn numbered(kinds: &mut Vec<Kind>, numbers: &mut Numbers, key: &[u8]) -> u32 {
    if let Some(&n) = numbers.get(key) {
        return n;
    }
    let n = kinds.len() as u32;
    kinds.push(Kind {
        name: String::from_utf8_lossy(key).into_owned(),
        count: 0,
    });
    numbers.insert(key.to_vec(), n);
    n
}
