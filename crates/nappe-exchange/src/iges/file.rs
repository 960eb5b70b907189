//! The sections of an IGES file: lines of 80 columns, of which column 73 says the section.

use super::record::{Param, params};
use crate::read::Fault;

/// Columns before the letter of the section.
const DATA: usize = 72;
/// Columns of data in a line of parameters; the rest names the entity.
const PARAMETERS: usize = 64;
/// Columns of a line.
const LINE: usize = 80;
/// Columns of a directory field.
const FIELD: usize = 8;

/// What the directory says of an entity.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entry {
    pub(super) kind: i64,
    /// Its first line of parameters, counted from 1.
    pub(super) start: usize,
    /// The entity of its transformation matrix, or 0.
    pub(super) matrix: i64,
    pub(super) blanked: bool,
    /// 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 in parameters, 6 construction.
    pub(super) purpose: u8,
    pub(super) colour: i64,
    pub(super) form: i64,
    pub(super) label: String,
}

/// A file taken apart.
#[derive(Debug)]
pub(super) struct File {
    pub(super) global: Vec<Param>,
    pub(super) entries: Vec<Entry>,
    /// All parameter data, 64 columns for each line.
    pub(super) text: Vec<u8>,
    delimiters: [u8; 2],
}

impl File {
    pub(super) fn new(bytes: &[u8]) -> Result<File, Fault> {
        let (mut global, mut text): (Vec<u8>, Vec<u8>) = (Vec::new(), Vec::new());
        let mut directory: Vec<(usize, [u8; LINE])> = Vec::new();
        for (number, line) in lines(bytes) {
            let line = columns(line);
            match line[DATA] {
                b'G' => global.extend(&line[..DATA]),
                b'D' => directory.push((number, line)),
                b'P' => text.extend(&line[..PARAMETERS]),
                b'C' | b'B' if directory.is_empty() => {
                    return Err(Fault::line(
                        number,
                        "the compressed and binary forms of IGES cannot be read; export it as fixed-length text",
                    ));
                }
                // The start is for people, the end repeats counts; what else there is, is no part of the file.
                _ => {}
            }
        }
        if directory.is_empty() || global.is_empty() {
            return Err(Fault::whole(
                "no lines with the letters G and D in column 73: this is no IGES file, or its columns are shifted",
            ));
        }
        let delimiters = delimiters(&global);
        let entries = directory
            .chunks(2)
            .map(|pair| match pair {
                [a, b] => entry(a.0, &a.1, &b.1),
                [a, ..] => Err(Fault::line(
                    a.0,
                    "an entity's second line of the directory is missing: the file is cut off",
                )),
                [] => Ok(Entry::default()),
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(File {
            global: params(skip_delimiters(&global), delimiters)?.0,
            entries,
            text,
            delimiters,
        })
    }

    /// The parameters of an entity, its number first.
    pub(super) fn params(&self, entry: &Entry) -> Result<Vec<Param>, Fault> {
        let at = entry.start.saturating_sub(1).saturating_mul(PARAMETERS);
        let rest = self.text.get(at..).filter(|r| !r.is_empty());
        let rest = rest.ok_or_else(|| Fault::whole("its parameters are not there"))?;
        let (list, ended) = params(rest, self.delimiters)?;
        if ended {
            Ok(list)
        } else {
            Err(Fault::whole(
                "its parameters have no end: the file is cut off",
            ))
        }
    }
}

/// The lines with their numbers; of a file without line ends, each 80 columns.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    let fixed = !bytes.contains(&end);
    let (broken, whole) = if fixed {
        (&bytes[..0], bytes)
    } else {
        (bytes, &bytes[..0])
    };
    let broken = broken.split(move |b| *b == end);
    let broken = broken.map(|l| l.strip_suffix(b"\r").unwrap_or(l));
    let all = broken.chain(whole.chunks(LINE));
    all.filter(|l| !l.is_empty())
        .enumerate()
        .map(|(i, l)| (i + 1, l))
}

/// A line as 80 columns, tabs as blanks to the next multiple of eight.
fn columns(line: &[u8]) -> [u8; LINE] {
    let mut out = [b' '; LINE];
    let mut at = 0;
    for &b in line {
        if at >= LINE {
            break;
        }
        if b == b'\t' {
            at = (at / 8 + 1) * 8;
        } else {
            out[at] = b;
            at += 1;
        }
    }
    out
}

/// The characters that end a parameter and a record: the first two parameters of the global section.
fn delimiters(global: &[u8]) -> [u8; 2] {
    let g = global.trim_ascii_start();
    let (first, rest) = match g {
        [b'1', b'H', d, rest @ ..] => (*d, rest.strip_prefix(&[*d]).unwrap_or(rest)),
        [d, rest @ ..] => (b',', if *d == b',' { rest } else { g }),
        [] => (b',', g),
    };
    match rest.trim_ascii_start() {
        [b'1', b'H', d, ..] => [first, *d],
        _ => [first, b';'],
    }
}

/// The global section after its first two parameters, whose own delimiters would be taken for delimiters.
fn skip_delimiters(global: &[u8]) -> &[u8] {
    let [parameter, _] = delimiters(global);
    let mut g = global.trim_ascii_start();
    for _ in 0..2 {
        g = match g.trim_ascii_start() {
            [b'1', b'H', _, rest @ ..] => rest,
            other => other,
        };
        g = g.strip_prefix(&[parameter]).unwrap_or(g);
    }
    g
}

fn entry(number: usize, a: &[u8; LINE], b: &[u8; LINE]) -> Result<Entry, Fault> {
    let field = |line: &[u8; LINE], k: usize, what: &str| -> Result<i64, Fault> {
        let text = &line[k * FIELD..(k + 1) * FIELD];
        let text = String::from_utf8_lossy(text);
        match text.trim() {
            "" => Ok(0),
            t => t.parse().map_err(|_| {
                Fault::line(
                    number,
                    format!("`{t}` is not the number of {what} in the directory"),
                )
            }),
        }
    };
    // Blanks inside the status are zeros.
    let status = a[8 * FIELD..9 * FIELD].iter();
    let status: Vec<u8> = status.map(|b| b.saturating_sub(b'0') % 10).collect();
    Ok(Entry {
        kind: field(a, 0, "an entity's kind")?,
        start: usize::try_from(field(a, 1, "a line of parameters")?).unwrap_or(0),
        matrix: field(a, 6, "a transformation")?,
        blanked: status[1] == 1,
        purpose: status[5],
        colour: field(b, 2, "a colour")?,
        form: field(b, 4, "a form")?,
        label: String::from_utf8_lossy(&b[7 * FIELD..8 * FIELD])
            .trim()
            .to_owned(),
    })
}
