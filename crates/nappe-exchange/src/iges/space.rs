//! Entities by their numbers, and how they are placed.

use super::file::{Entry, File};
use super::record::{Got, Param, Record};
use crate::scene::Colour;
use glam::{DAffine3, DMat3, DVec3};
use nappe::Units;
use std::cell::Cell;

/// References of references.
pub(super) const DEEPEST: usize = 64;

/// A file whose entities are looked at.
pub(super) struct Space {
    pub(super) file: File,
    pub(super) units: Units,
    /// From the file's unit to `units`.
    pub(super) scale: f64,
    pub(super) uncertainty: Option<f64>,
    pub(super) name: Option<String>,
    /// The unit that the file names, if it is not known: it is taken for inches then.
    pub(super) unknown_unit: Option<String>,
    /// The model space scale, if it is not 1.
    pub(super) model_scale: Option<f64>,
    /// Entities and parameters that may still be read: subfigures that are placed many times could otherwise fill the
    /// memory.
    left: Cell<usize>,
}

/// Entities and parameters read for each that the file has, and besides.
const WORK: [usize; 2] = [64, 1_000_000];
/// The bytes of the shortest parameter.
const SHORTEST: usize = 2;

impl Space {
    pub(super) fn new(file: File) -> Space {
        let number = |k: usize| match file.global.get(k - 3) {
            Some(Param::Number(x)) => Some(*x),
            _ => None,
        };
        let text = |k: usize| match file.global.get(k - 3) {
            Some(Param::Text(t)) if !t.trim().is_empty() => Some(t.trim().to_owned()),
            _ => None,
        };
        let flag = number(14).map_or(0, |x| x as i64);
        let named = text(15).unwrap_or_default().to_uppercase();
        let (units, scale) = match (flag, named.as_str()) {
            (4, _) | (3, "FT") => (Units::Foot, 1.0),
            (5, _) | (3, "MI") => (Units::Foot, 5280.0),
            (6, _) | (3, "M") => (Units::Metre, 1.0),
            (7, _) | (3, "KM") => (Units::Metre, 1e3),
            (8, _) | (3, "MIL") => (Units::Inch, 1e-3),
            (9, _) | (3, "UM") => (Units::Millimetre, 1e-3),
            (10, _) | (3, "CM") => (Units::Centimetre, 1.0),
            (11, _) | (3, "UIN") => (Units::Inch, 1e-6),
            (2, _) | (3, "MM") => (Units::Millimetre, 1.0),
            // The default of the standard.
            _ => (Units::Inch, 1.0),
        };
        let known = match flag {
            3 => [
                "IN", "INCH", "FT", "MI", "M", "KM", "MIL", "UM", "CM", "UIN", "MM",
            ]
            .contains(&named.as_str()),
            // Left out, it is the default.
            0 => !matches!(file.global.get(11), Some(Param::Text(t)) if !t.trim().is_empty()),
            n => (1..=11).contains(&n),
        };
        let unknown_unit = (!known).then(|| match text(15) {
            Some(name) => crate::text::line(&name),
            None => format!("flag {flag}"),
        });
        Space {
            units,
            scale,
            unknown_unit,
            uncertainty: number(19).filter(|x| *x > 0.0).map(|x| x * scale),
            name: text(3).or_else(|| text(4)),
            model_scale: number(13).filter(|x| *x != 1.0 && *x > 0.0),
            left: Cell::new(WORK[0] * (file.entries.len() + file.text.len() / SHORTEST) + WORK[1]),
            file,
        }
    }

    /// The index of an entity in the directory.
    pub(super) fn index(&self, number: i64) -> Got<usize> {
        let index = usize::try_from(number.saturating_sub(1))
            .ok()
            .map(|n| n / 2);
        index
            .filter(|i| number > 0 && number % 2 == 1 && *i < self.file.entries.len())
            .ok_or_else(|| format!("it names the entity D{number}, which is not there"))
    }

    pub(super) fn entry(&self, number: i64) -> Got<&Entry> {
        Ok(&self.file.entries[self.index(number)?])
    }

    /// An entity and its parameters.
    pub(super) fn open(&self, number: i64) -> Got<(&Entry, Record)> {
        let entry = self.entry(number)?;
        let left = self.left.get();
        if left == 0 {
            return Err(
                "the file places its entities so often that they are out of proportion to its size"
                    .into(),
            );
        }
        let params = self.file.params(entry).map_err(|f| f.what)?;
        self.left.set(left.saturating_sub(1 + params.len()));
        match params.first() {
            Some(Param::Number(k)) if *k == entry.kind as f64 => Ok((entry, Record::new(params))),
            _ => Err(format!(
                "the parameters of D{number} are those of another entity"
            )),
        }
    }

    /// Whether no more entities are made.
    pub(super) fn is_exhausted(&self) -> bool {
        self.left.get() == 0
    }

    /// The parameters of an entity of one kind.
    pub(super) fn record(&self, number: i64, kind: i64) -> Got<Record> {
        let (entry, record) = self.open(number)?;
        if entry.kind == kind {
            Ok(record)
        } else {
            Err(format!(
                "D{number} should be of the kind {kind}, but is {}",
                entry.kind
            ))
        }
    }

    /// The map that an entity's matrices make, to its parent's space.
    pub(super) fn placement(&self, entry: &Entry) -> Got<DAffine3> {
        let mut map = DAffine3::IDENTITY;
        let mut next = entry.matrix;
        for _ in 0..DEEPEST {
            if next == 0 {
                return Ok(map);
            }
            let mut r = self.record(next, 124)?;
            let m = r.reals(12)?;
            let rows = [0, 4, 8].map(|k| DVec3::new(m[k], m[k + 1], m[k + 2]));
            let own = DAffine3 {
                matrix3: DMat3::from_cols_array_2d(&rows.map(|r| r.to_array())).transpose(),
                translation: DVec3::new(m[3], m[7], m[11]),
            };
            map = own * map;
            next = self.entry(next)?.matrix;
        }
        Err("its transformations go in a circle".into())
    }

    /// A point 116, in the space of what names it.
    pub(super) fn point(&self, number: i64) -> Got<DVec3> {
        let map = self.placement(self.entry(number)?)?;
        Ok(map.transform_point3(self.record(number, 116)?.point()?))
    }

    /// A direction 123.
    pub(super) fn direction(&self, number: i64) -> Got<DVec3> {
        let map = self.placement(self.entry(number)?)?;
        Ok(map.transform_vector3(self.record(number, 123)?.point()?))
    }

    /// The colour of an entity.
    pub(super) fn colour(&self, entry: &Entry) -> Option<Colour> {
        Some(match entry.colour {
            1 => [0.0, 0.0, 0.0],
            2 => [1.0, 0.0, 0.0],
            3 => [0.0, 1.0, 0.0],
            4 => [0.0, 0.0, 1.0],
            5 => [1.0, 1.0, 0.0],
            6 => [1.0, 0.0, 1.0],
            7 => [0.0, 1.0, 1.0],
            8 => [1.0, 1.0, 1.0],
            n if n < 0 => {
                let rgb = self.record(-n, 314).ok()?.point().ok()?;
                rgb.to_array().map(|x| (x / 100.0).clamp(0.0, 1.0) as f32)
            }
            _ => return None,
        })
    }
}
