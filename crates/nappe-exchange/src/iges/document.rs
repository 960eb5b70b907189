//! Which entities stand for themselves, and what becomes of them.

use super::bodies::Builder;
use super::curves::{copious, is_curve};
use super::file::{Entry, File};
use super::record::Got;
use super::space::{DEEPEST, Space};
use super::surfaces::is_surface;
use crate::document::{Document, Item, ItemForm, Lost, note};
use crate::read::Fault;
use crate::report::{Progress, Shares};
use glam::{DAffine3, DVec3};
use nappe::body::Shell;
use nappe::curve;
use nappe::{CurveRef, LARGEST_LENGTH};

/// Reads the bytes of an IGES file.
pub(crate) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Document, Fault> {
    let space = Space::new(File::new(bytes)?);
    let mut out = Document {
        name: space.name.clone(),
        units: space.units,
        uncertainty: space.uncertainty,
        ..Document::default()
    };
    if let Some(scale) = space.model_scale {
        let why =
            "coordinates are those of the model, not multiplied to the size of the real thing"
                .into();
        note(
            &mut out.left_out,
            Lost::Other,
            format!("model space scale {scale}"),
            why,
            String::new(),
        );
    }
    if let Some(unit) = &space.unknown_unit {
        let why = "it is not known, and inches are taken in its place".into();
        note(
            &mut out.left_out,
            Lost::Other,
            format!("unit `{unit}`"),
            why,
            String::new(),
        );
    }
    let parts = parts(&space);
    let map = DAffine3::from_scale(DVec3::splat(space.scale));
    let steps = Shares::new(progress, space.file.entries.len());
    for (i, entry) in space.file.entries.iter().enumerate() {
        steps.step();
        // That an entity is part of another is seen where it is named: programs also mark single faces so.
        if parts[i] || is_helper(entry) {
            continue;
        }
        let number = 2 * i as i64 + 1;
        let aside = match (entry.blanked, entry.purpose) {
            (true, _) => Some("it is blanked"),
            (_, 1) => Some("it is an annotation"),
            (_, 2..=5) => Some("its use is that of a part of others, but nothing uses it"),
            _ => None,
        };
        if let Some(why) = aside {
            left(&mut out, Lost::Other, entry, number, why.into());
            continue;
        }
        if let Err(why) = item(&space, number, map, "", 0, &mut out) {
            left(&mut out, of_kind(entry), entry, number, why);
        }
    }
    Ok(out)
}

/// What says something of others, and is nothing by itself.
fn is_helper(entry: &Entry) -> bool {
    matches!(
        entry.kind,
        0 | 123 | 124 | 132 | 308 | 310 | 314 | 402 | 404 | 406 | 410 | 502 | 504 | 508 | 141 | 142
    )
}

/// What is lost with an entity that is shown: notes on drawings and numbers for analysis are no geometry.
fn of_kind(entry: &Entry) -> Lost {
    match entry.kind {
        132..=138 | 146 | 148 | 200..=406 | 410 | 416..=418 | 422 | 600..=699 => Lost::Other,
        _ => Lost::Geometry,
    }
}

fn left(out: &mut Document, lost: Lost, entry: &Entry, number: i64, why: String) {
    note(
        &mut out.left_out,
        lost,
        format!("entity {}", entry.kind),
        why,
        format!("D{number}"),
    );
}

/// Which entities are named by others as their parts.
fn parts(space: &Space) -> Vec<bool> {
    let mut is_part = vec![false; space.file.entries.len()];
    for (i, entry) in space.file.entries.iter().enumerate() {
        let number = 2 * i as i64 + 1;
        for part in named(space, number, entry).unwrap_or_default() {
            if let Ok(p) = space.index(part)
                && p != i
            {
                is_part[p] = true;
            }
        }
    }
    is_part
}

/// The entities that an entity is made of.
fn named(space: &Space, number: i64, entry: &Entry) -> Got<Vec<i64>> {
    if !matches!(
        entry.kind,
        102 | 108 | 118 | 120 | 122 | 130 | 140 | 141 | 142 | 143 | 144 | 186 | 190
            ..=198 | 308 | 504 | 508 | 510 | 514
    ) {
        return Ok(Vec::new());
    }
    let (_, mut r) = space.open(number)?;
    Ok(match entry.kind {
        102 => {
            let n = r.count(1)?;
            r.ints(n)?
        }
        108 => {
            r.skip(4);
            vec![r.int()?]
        }
        118 | 120 => r.ints(2)?,
        130 => r.ints(1)?,
        140 => {
            r.skip(4);
            r.ints(1)?
        }
        122 => r.ints(1)?,
        141 => {
            r.skip(2);
            let mut all = vec![r.int()?];
            for _ in 0..r.count(3)? {
                all.push(r.int()?);
                r.skip(1);
                let n = r.count(1)?;
                all.extend(r.ints(n)?);
            }
            all
        }
        142 => {
            r.skip(1);
            r.ints(3)?
        }
        143 => {
            r.skip(1);
            let mut all = vec![r.int()?];
            let n = r.count(1)?;
            all.extend(r.ints(n)?);
            all
        }
        144 => {
            let mut all = vec![r.int()?];
            r.skip(1);
            let n = r.count(1)?;
            all.extend(r.ints(n + 1)?);
            all
        }
        186 => {
            let mut all = vec![r.int()?];
            r.skip(1);
            for _ in 0..r.count(2)? {
                all.push(r.int()?);
                r.skip(1);
            }
            all
        }
        196 => vec![r.int()?],
        190..=198 => r.ints(2)?,
        308 => {
            r.skip(2);
            let n = r.count(1)?;
            r.ints(n)?
        }
        504 => {
            let mut all = Vec::new();
            for _ in 0..r.count(5)? {
                all.push(r.int()?);
                r.skip(4);
            }
            all
        }
        508 => {
            let mut all = Vec::new();
            for _ in 0..r.count(5)? {
                r.skip(4);
                for _ in 0..r.count(2)? {
                    r.skip(1);
                    all.push(r.int()?);
                }
            }
            all
        }
        510 => {
            let mut all = vec![r.int()?];
            let n = r.count(1)?;
            r.skip(1);
            all.extend(r.ints(n)?);
            all
        }
        _ => {
            let mut all = Vec::new();
            for _ in 0..r.count(2)? {
                all.push(r.int()?);
                r.skip(1);
            }
            all
        }
    })
}

/// Takes over one entity, below the names on the way to it.
fn item(
    space: &Space,
    number: i64,
    map: DAffine3,
    path: &str,
    depth: usize,
    out: &mut Document,
) -> Got<()> {
    let entry = space.entry(number)?;
    if depth > DEEPEST {
        return Err("subfigures that contain themselves".into());
    }
    let name = match (path, space.name_of(number)) {
        ("", own) => own,
        (path, own) if own.is_empty() => path.to_owned(),
        (path, own) => format!("{path}/{own}"),
    };
    if entry.kind == 408 {
        return instance(space, number, map, &name, depth, out);
    }
    let form = match entry.kind {
        186 | 510 | 514 => {
            let mut b = Builder::new(space, map);
            match entry.kind {
                186 => b.solid(number)?,
                514 => b.shell(number, true, false)?,
                _ => {
                    let face = b.face(number)?;
                    b.body.shells.push(Shell {
                        faces: vec![(face, true)],
                        closed: false,
                    });
                    b.faces.clear();
                }
            }
            for (face, why) in b.left {
                left(out, Lost::Geometry, space.entry(face)?, face, why);
            }
            let colour = space.colour(entry);
            // What all of it has, no face has for itself.
            for f in b.faces.iter_mut().filter(|f| f.colour == colour) {
                f.colour = None;
            }
            let plain = b
                .faces
                .iter()
                .all(|f| f.name.is_empty() && f.colour.is_none());
            if plain {
                b.faces.clear();
            }
            ItemForm::Body {
                body: b.body,
                faces: b.faces,
            }
        }
        116 => {
            let map = map * space.placement(entry)?;
            let p = map.transform_point3(space.record(number, 116)?.point()?);
            ItemForm::Points(vec![p])
        }
        106 if (1..=3).contains(&entry.form) => {
            let map = map * space.placement(entry)?;
            let points = copious(&mut space.record(number, 106)?, false)?;
            ItemForm::Points(points.iter().map(|p| map.transform_point3(*p)).collect())
        }
        143 | 144 => ItemForm::Body {
            body: space.trimmed(number, map)?,
            faces: Vec::new(),
        },
        108 if entry.form == 1 => ItemForm::Body {
            body: space.trimmed(number, map)?,
            faces: Vec::new(),
        },
        _ if is_surface(entry) => ItemForm::Body {
            body: space.trimmed(number, map)?,
            faces: Vec::new(),
        },
        _ if is_curve(entry) => ItemForm::Curve(space.curve(number, map)?),
        108 | 190 | 192 | 194 => return Err("an endless surface without a face".into()),
        kind => return Err(format!("entities of the kind {kind} are not read")),
    };
    finite(&form)?;
    out.items.push(Item {
        name,
        colour: space.colour(entry),
        form,
    });
    Ok(())
}

/// Whether all coordinates can be computed with.
fn finite(form: &ItemForm) -> Got<()> {
    let fits = |p: &DVec3| p.abs().max_element() <= LARGEST_LENGTH;
    let curve = |c: &CurveRef| curve::Curve::ends(c.as_ref()).iter().all(fits);
    let sound = match form {
        ItemForm::Points(p) => p.iter().all(fits),
        ItemForm::Curve(c) => curve(c),
        ItemForm::Body { body, .. } => {
            body.vertices.iter().all(|v| fits(&v.point))
                && body.edges.iter().all(|e| curve(&e.curve))
        }
    };
    if sound {
        Ok(())
    } else {
        Err(format!("a coordinate is larger than {LARGEST_LENGTH:e}"))
    }
}

/// 408: a subfigure 308, moved and scaled.
fn instance(
    space: &Space,
    number: i64,
    map: DAffine3,
    path: &str,
    depth: usize,
    out: &mut Document,
) -> Got<()> {
    let (entry, mut r) = space.open(number)?;
    let definition = r.int()?;
    let shift = r.point()?;
    let scale = r.real_or(1.0)?;
    let own = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
    let (inner, mut d) = space.open(definition)?;
    if inner.kind != 308 {
        return Err(format!("D{definition} should be a subfigure"));
    }
    let map = map * space.placement(entry)? * own * space.placement(inner)?;
    d.skip(1);
    let name = d.text().map(|t| t.trim().to_owned()).unwrap_or_default();
    let path = if path.is_empty() {
        name
    } else {
        path.to_owned()
    };
    let n = d.count(1)?;
    for part in d.ints(n)? {
        let entry = space.entry(part)?;
        if entry.blanked || is_silent_part(entry) {
            continue;
        }
        if let Err(why) = item(space, part, map, &path, depth + 1, out) {
            if space.is_exhausted() {
                return Err(why);
            }
            left(out, of_kind(entry), entry, part, why);
        }
    }
    Ok(())
}

/// Parts of a subfigure have the purpose of a definition.
fn is_silent_part(entry: &Entry) -> bool {
    is_helper(entry) || matches!(entry.purpose, 1 | 5)
}

impl Space {
    /// The name of an entity: that of its name property, else its label.
    pub(super) fn name_of(&self, number: i64) -> String {
        let label = self
            .entry(number)
            .map(|e| e.label.clone())
            .unwrap_or_default();
        self.property_name(number).ok().flatten().unwrap_or(label)
    }

    fn property_name(&self, number: i64) -> Got<Option<String>> {
        let (entry, mut r) = self.open(number)?;
        // What comes before the pointers to groups and properties.
        match entry.kind {
            100 => r.skip(7),
            102 | 514 | 510 | 144 | 143 => {
                let (head, each, tail) = match entry.kind {
                    102 => (0, 1, 0),
                    514 => (0, 2, 0),
                    510 => (1, 1, 1),
                    144 => (2, 1, 1),
                    _ => (2, 1, 0),
                };
                r.skip(head);
                let n = r.count(each)?;
                r.skip(each * n + tail);
            }
            108 => r.skip(9),
            110 => r.skip(6),
            116 | 122 | 118 | 120 | 408 => r.skip(match entry.kind {
                408 => 5,
                _ => 4,
            }),
            126 => {
                let (k, m) = (r.int()?, r.int()?);
                let count = r.fits(k.saturating_add(1), 5)?;
                let degree = r.fits(m, 1)?;
                r.skip(4 + count + degree + 1 + 4 * count + 5);
            }
            128 => {
                let k = [r.int()?, r.int()?, r.int()?, r.int()?];
                let [a, b, m, n] = [
                    r.fits(k[0], 1)?,
                    r.fits(k[1], 1)?,
                    r.fits(k[2], 1)?,
                    r.fits(k[3], 1)?,
                ];
                let count = (a + 1).saturating_mul(b + 1);
                r.skip(
                    (5 + a + m + 2 + b + n + 2 + 4usize.saturating_mul(count)).saturating_add(4),
                );
            }
            186 => {
                r.skip(2);
                let n = r.count(2)?;
                r.skip(2 * n);
            }
            _ => return Ok(None),
        }
        let groups = r.count(1)?;
        r.skip(groups);
        let n = r.count(1)?;
        for p in r.ints(n)? {
            let property = self.entry(p)?;
            if property.kind == 406 && property.form == 15 {
                let mut name = self.record(p, 406)?;
                name.skip(1);
                return Ok(name
                    .text()
                    .map(|t| t.trim().to_owned())
                    .filter(|t| !t.is_empty()));
            }
        }
        Ok(None)
    }
}
