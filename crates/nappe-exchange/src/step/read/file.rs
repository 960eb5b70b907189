//! A file with its entities, found by number and by kind.

use super::super::StepError;
use super::scan::{Entry, Kind, Lines, Scan, line, scan};
use super::text;
use super::value::{Cursor, Value};
use crate::report::Progress;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

/// Why one entity cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refused {
    /// Its keyword.
    pub(super) what: String,
    /// The reason.
    pub(super) why: String,
    /// Its number.
    pub(super) id: u64,
}

/// What reading an entity gives.
pub(super) type Got<T> = Result<T, Refused>;

/// How to get from numbers to entities.
#[derive(Debug)]
enum Places {
    /// For each number the entity's index plus one, 0 for none.
    Table(Vec<u32>),
    /// Indices in the order of the numbers.
    Order(Vec<u32>),
}

/// A table may be this many times as long as the list of entities; sparser numbers are searched.
const SPARSE: u64 = 3;
/// Entities may be read so often for each byte of the file: parts that are placed often are read again for each place.
const READS: u64 = 16;
/// And so often however small the file is.
const FEW_READS: u64 = 4_000_000;
/// So many bytes of one entity count as another read.
const LONG: usize = 64;

/// So many reads are told at once.
const TOLD: u64 = 1 << 8;

/// What is known of a file.
#[derive(Debug)]
struct Index {
    scan: Scan,
    places: Places,
    extent: OnceLock<f64>,
    lines: OnceLock<Lines>,
    /// Reads of all views, in units of [`TOLD`].
    told: AtomicU64,
}

/// A file in memory, and how much of it was read.
#[derive(Debug)]
pub(super) struct File<'b> {
    bytes: &'b [u8],
    index: Arc<Index>,
    /// Only one thread counts: others have views of their own.
    reads: AtomicU64,
    most: u64,
    progress: Progress<'b>,
}

impl<'b> File<'b> {
    /// Finds the entities of a file on some threads. Errors: as [`scan`].
    pub(super) fn new(
        bytes: &'b [u8],
        threads: usize,
        progress: Progress<'b>,
    ) -> Result<Self, StepError> {
        let mut scan = scan(bytes, threads)?;
        let places = places(bytes, &scan.entries)?;
        scan.entries.shrink_to_fit();
        Ok(Self {
            bytes,
            index: Arc::new(Index {
                scan,
                places,
                extent: OnceLock::new(),
                lines: OnceLock::new(),
                told: AtomicU64::new(0),
            }),
            reads: AtomicU64::new(0),
            most: FEW_READS + READS * bytes.len() as u64,
            progress,
        })
    }

    /// The same file for another thread, with as many reads as now. All but one in `share` of the reads that are left are held
    /// back.
    pub(super) fn view(&self, share: u64) -> Self {
        let reads = self.reads();
        let left = self.most.saturating_sub(reads);
        Self {
            bytes: self.bytes,
            index: self.index.clone(),
            reads: AtomicU64::new(reads),
            most: reads + left / share,
            progress: self.progress,
        }
    }

    /// Reads until now.
    pub(super) fn reads(&self) -> u64 {
        self.reads.load(Relaxed)
    }

    /// Whether more was read than may be.
    pub(super) fn is_spent(&self) -> bool {
        self.reads() > self.most
    }

    /// Counts reads of others.
    pub(super) fn add_reads(&self, reads: u64) {
        self.reads
            .store(self.reads().saturating_add(reads), Relaxed);
    }

    /// Counts reads of its own, and tells how far they are: nearly all entities are read once.
    fn count_reads(&self, reads: u64) {
        let before = self.reads();
        self.add_reads(reads);
        let steps = self.reads() / TOLD - before / TOLD;
        if steps > 0 {
            let told = steps + self.index.told.fetch_add(steps, Relaxed);
            let share = (told * TOLD) as f64 / self.count() as f64;
            self.progress.tell(share.min(1.0));
        }
    }

    /// How many entities there are.
    pub(super) fn count(&self) -> usize {
        self.index.scan.entries.len()
    }

    /// All keywords with how often they occur.
    pub(super) fn kinds(&self) -> &[Kind] {
        &self.index.scan.kinds
    }

    /// The numbers of all entities of a kind, in the order of the file.
    pub(super) fn all<'a>(&'a self, kind: &str) -> impl Iterator<Item = u64> + 'a {
        let number = self.index.scan.kinds.iter().position(|k| k.name == kind);
        let entries: &[Entry] = if number.is_some() {
            &self.index.scan.entries
        } else {
            &[]
        };
        let of = move |e: &&Entry| Some(e.kind as usize) == number;
        entries.iter().filter(of).map(|e| e.id)
    }

    fn entry(&self, id: u64) -> Option<Entry> {
        let entries = &self.index.scan.entries;
        match &self.index.places {
            Places::Table(table) => {
                let i = *table.get(usize::try_from(id).ok()?)?;
                Some(entries[(i as usize).checked_sub(1)?])
            }
            Places::Order(order) => {
                let i = order.binary_search_by_key(&id, |&i| entries[i as usize].id);
                Some(entries[order[i.ok()?] as usize])
            }
        }
    }

    /// The keyword of an entity (with a parenthesis before it for a complex one); empty if there is none.
    pub(super) fn kind(&self, id: u64) -> &str {
        self.entry(id)
            .map_or("", |e| &self.index.scan.kinds[e.kind as usize].name)
    }

    /// A refusal of an entity.
    pub(super) fn refused(&self, id: u64, why: impl Into<String>) -> Refused {
        let what = match self.kind(id).trim_start_matches('(') {
            "" => format!("#{id}"),
            kind => kind.to_owned(),
        };
        let why = why.into();
        Refused { what, why, id }
    }

    /// Counts what is made of the file's text, in bytes, as reads.
    pub(super) fn charge(&self, bytes: usize) {
        self.count_reads((bytes / LONG) as u64);
    }

    /// Refuses an entity of a file that asks for far more than it holds: a few lines can place parts in parts any number of
    /// times.
    pub(super) fn bounded(&self, id: u64) -> Got<()> {
        if !self.is_spent() {
            return Ok(());
        }
        let most = self.most;
        let why = format!(
            "the file places its parts so often that they take more than {most} reads of its entities"
        );
        Err(self.refused(id, why))
    }

    /// The diagonal of all points' box, in the numbers of the file.
    pub(super) fn extent(&self) -> f64 {
        *self.index.extent.get_or_init(|| {
            let points = self
                .all("CARTESIAN_POINT")
                .filter_map(|id| self.triple(id, "CARTESIAN_POINT").ok());
            let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for p in points.map(DVec3::from) {
                (lo, hi) = (lo.min(p), hi.max(p));
            }
            if lo.is_finite() { hi.distance(lo) } else { 0.0 }
        })
    }

    fn begin(&self, id: u64) -> Got<Entry> {
        self.count_reads(1);
        self.bounded(id)?;
        self.entry(id)
            .ok_or_else(|| self.refused(id, "the file refers to it, but does not have it"))
    }

    /// Where an entity is, for a message.
    fn placed(&self, entry: Entry, why: &str) -> Refused {
        let lines = self.index.lines.get_or_init(|| Lines::new(self.bytes));
        self.refused(
            entry.id,
            format!("line {}: {why}", lines.line(self.bytes, entry.at)),
        )
    }

    /// An entity with its parameters.
    pub(super) fn record(&self, id: u64) -> Got<Record<'_>> {
        let entry = self.begin(id)?;
        let mut cursor = Cursor::new(self.bytes, entry.at);
        let mut parts = Vec::with_capacity(1);
        let mut read = || -> Result<(), String> {
            if cursor.peek() != Some(b'(') {
                parts.push((cursor.keyword()?, cursor.list(0)?));
                return Ok(());
            }
            cursor.expect(b'(', "`(`")?;
            while cursor.peek() != Some(b')') {
                parts.push((cursor.keyword()?, cursor.list(0)?));
            }
            Ok(())
        };
        read().map_err(|why| self.placed(entry, &why))?;
        self.charge(cursor.place() - entry.at);
        let file = self;
        Ok(Record { file, id, parts })
    }

    /// The numbers of a `CARTESIAN_POINT` or `DIRECTION`, as many as there are up to three; the rest are 0.
    pub(super) fn triple(&self, id: u64, kind: &str) -> Got<[f64; 3]> {
        let entry = self.begin(id)?;
        if self.index.scan.kinds[entry.kind as usize].name != kind {
            return Err(self.refused(id, format!("it is not a {kind}")));
        }
        let mut cursor = Cursor::new(self.bytes, entry.at);
        let mut read = || -> Result<[f64; 3], String> {
            cursor.keyword()?;
            cursor.expect(b'(', "`(`")?;
            cursor.value(0)?;
            cursor.expect(b',', "`,`")?;
            cursor.expect(b'(', "`(`")?;
            let mut x = [0.0; 3];
            for (i, x) in x.iter_mut().enumerate() {
                if i > 0 {
                    if cursor.peek() == Some(b')') {
                        break;
                    }
                    cursor.expect(b',', "`,` or `)`")?;
                }
                *x = cursor.real()?;
            }
            cursor.expect(b')', "`)` after at most three numbers")?;
            Ok(x)
        };
        read().map_err(|why| self.placed(entry, &why))
    }

    /// The first text of an entity of the header: the file's name of `FILE_NAME`.
    pub(super) fn header(&self, keyword: &str) -> Option<String> {
        self.index.scan.header.iter().find_map(|&at| {
            let mut cursor = Cursor::new(self.bytes, at);
            let name = cursor.keyword().ok()?;
            if !name.eq_ignore_ascii_case(keyword.as_bytes()) {
                return None;
            }
            first_text(&cursor.list(0).ok()?)
        })
    }
}

fn first_text(values: &[Value<'_>]) -> Option<String> {
    values.iter().find_map(|v| match v {
        Value::Text(t) => Some(text::decode(t)),
        Value::List(l) => first_text(l),
        _ => None,
    })
}

fn places(bytes: &[u8], entries: &[Entry]) -> Result<Places, StepError> {
    let twice = |a: Entry, b: Entry| StepError::Twice {
        id: a.id,
        lines: [a, b].map(|e| line(bytes, e.at)),
    };
    let greatest = entries.iter().map(|e| e.id).max().unwrap_or(0);
    if greatest <= SPARSE * entries.len() as u64 {
        let mut table = vec![0; greatest as usize + 1];
        for (i, e) in entries.iter().enumerate() {
            let place = &mut table[e.id as usize];
            if *place != 0 {
                return Err(twice(entries[*place as usize - 1], *e));
            }
            *place = i as u32 + 1;
        }
        return Ok(Places::Table(table));
    }
    let mut order: Vec<u32> = (0..entries.len() as u32).collect();
    order.sort_by_key(|&i| entries[i as usize].id);
    for pair in order.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|i| entries[i as usize]);
        if a.id == b.id {
            return Err(twice(a, b));
        }
    }
    Ok(Places::Order(order))
}

/// An entity with its parameters.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    file: &'a File<'a>,
    /// Its number.
    pub(super) id: u64,
    /// Keyword and parameters; several of a complex entity.
    parts: Vec<(&'a [u8], Vec<Value<'a>>)>,
}

impl<'a> Record<'a> {
    /// The keyword of an entity that is not complex; else empty.
    pub(super) fn kind(&self) -> &'a str {
        match self.parts.as_slice() {
            [(name, _)] => std::str::from_utf8(name).unwrap_or(""),
            _ => "",
        }
    }

    /// The parameters under a keyword.
    pub(super) fn part(&self, keyword: &str) -> Option<Args<'_, 'a>> {
        let part = self
            .parts
            .iter()
            .find(|p| p.0.eq_ignore_ascii_case(keyword.as_bytes()))?;
        Some(self.arguments(&part.1))
    }

    /// The same, or a refusal.
    pub(super) fn needed(&self, keyword: &str) -> Got<Args<'_, 'a>> {
        self.part(keyword)
            .ok_or_else(|| self.refused(format!("it has no part {keyword}")))
    }

    /// The parameters of an entity that is not complex (of a complex one those of its first part).
    pub(super) fn args(&self) -> Args<'_, 'a> {
        self.arguments(self.parts.first().map_or(&[], |p| &p.1))
    }

    fn arguments<'r>(&'r self, values: &'r [Value<'a>]) -> Args<'r, 'a> {
        Args {
            file: self.file,
            id: self.id,
            values,
        }
    }

    /// A refusal of this entity.
    pub(super) fn refused(&self, why: impl Into<String>) -> Refused {
        self.file.refused(self.id, why)
    }

    /// All references among the parameters, at any depth.
    pub(super) fn references(&self) -> Vec<u64> {
        let mut found = Vec::new();
        for part in &self.parts {
            references(&part.1, &mut found);
        }
        found
    }
}

fn references(values: &[Value<'_>], found: &mut Vec<u64>) {
    for v in values {
        match v {
            Value::Ref(id) => found.push(*id),
            Value::List(l) | Value::Typed(_, l) => references(l, found),
            _ => {}
        }
    }
}

/// A list of parameters, of which each is of the kind that is asked for or refused.
#[derive(Clone, Copy, Debug)]
pub(super) struct Args<'r, 'a> {
    file: &'a File<'a>,
    id: u64,
    /// The parameters.
    pub(super) values: &'r [Value<'a>],
}

impl<'r, 'a> Args<'r, 'a> {
    fn wrong(&self, i: usize, what: &str) -> Refused {
        self.file
            .refused(self.id, format!("its parameter {} is not {what}", i + 1))
    }

    /// A refusal of the entity.
    pub(super) fn refused(&self, why: impl Into<String>) -> Refused {
        self.file.refused(self.id, why)
    }

    pub(super) fn get(&self, i: usize) -> Option<&'r Value<'a>> {
        self.values.get(i)
    }

    pub(super) fn reference(&self, i: usize) -> Got<u64> {
        match self.get(i) {
            Some(Value::Ref(id)) => Ok(*id),
            _ => Err(self.wrong(i, "a reference")),
        }
    }

    pub(super) fn real(&self, i: usize) -> Got<f64> {
        self.get(i)
            .and_then(number)
            .ok_or_else(|| self.wrong(i, "a number"))
    }

    /// A number that is not negative and not too large to be a count.
    pub(super) fn count(&self, i: usize) -> Got<usize> {
        match self.get(i) {
            Some(Value::Int(n)) if (0..=i64::from(u32::MAX)).contains(n) => Ok(*n as usize),
            _ => Err(self.wrong(i, "a whole number")),
        }
    }

    /// The text of a name; empty where there is none.
    pub(super) fn text(&self, i: usize) -> String {
        match self.get(i) {
            Some(Value::Text(t)) => text::decode(t),
            _ => String::new(),
        }
    }

    /// `.T.` or `.F.`.
    pub(super) fn flag(&self, i: usize) -> Got<bool> {
        match self.get(i) {
            Some(Value::Enum(b"T")) => Ok(true),
            Some(Value::Enum(b"F")) => Ok(false),
            _ => Err(self.wrong(i, "true or false")),
        }
    }

    pub(super) fn list(&self, i: usize) -> Got<Args<'r, 'a>> {
        match self.get(i) {
            Some(Value::List(values)) => Ok(Args { values, ..*self }),
            _ => Err(self.wrong(i, "a list")),
        }
    }

    pub(super) fn references(&self, i: usize) -> Got<Vec<u64>> {
        let list = self.list(i)?;
        (0..list.values.len()).map(|k| list.reference(k)).collect()
    }

    pub(super) fn reals(&self, i: usize) -> Got<Vec<f64>> {
        let list = self.list(i)?;
        (0..list.values.len()).map(|k| list.real(k)).collect()
    }

    pub(super) fn counts(&self, i: usize) -> Got<Vec<usize>> {
        let list = self.list(i)?;
        (0..list.values.len()).map(|k| list.count(k)).collect()
    }
}

/// The number of a value, in a type or not.
pub(super) fn number(v: &Value<'_>) -> Option<f64> {
    match v {
        Value::Real(x) => Some(*x),
        Value::Int(i) => Some(*i as f64),
        Value::Typed(_, l) => number(l.first()?),
        _ => None,
    }
}
