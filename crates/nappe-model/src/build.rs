//! Builds the objects of a file in the order in which they need each other.

use crate::MAX_REFERENCE_DEPTH;
use crate::data::{CurveSource, Fields, Item, Object, SideName};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::import::Imports;
use crate::model::Join;
use crate::value::Span;
use nappe::curve::{Curve, CurveRef, Isocurve};
use nappe::expr::nearest;
use nappe::surface::{CollapsedError, SurfaceRef, check_not_collapsed};
use nappe::{Breaks, DVec3, Frame, LARGEST_LENGTH};
use std::collections::HashMap;
use std::sync::Arc;

/// Why an object is not built.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Stop {
    /// Something of its own is wrong; it has been reported.
    Reported,
    /// It needs something that is wrong.
    Depends,
}

pub(crate) type Built<T> = Result<T, Stop>;

/// A surface with what pictures show of its making.
#[derive(Clone, Debug)]
pub(crate) struct Patch {
    /// What is added to the object's name, if it makes several surfaces.
    pub(crate) suffix: Option<String>,
    pub(crate) surface: SurfaceRef,
    pub(crate) net: Option<Vec<Vec<DVec3>>>,
}

impl Patch {
    /// The only surface of an object.
    pub(crate) fn one(surface: SurfaceRef) -> Vec<Patch> {
        vec![Patch {
            suffix: None,
            surface,
            net: None,
        }]
    }
}

#[derive(Clone, Debug)]
enum State<T> {
    Waiting,
    Busy,
    Done(T),
    Failed,
}

/// One table of objects: curves or surfaces.
#[derive(Debug)]
struct Shelf<T> {
    names: Vec<String>,
    index: HashMap<String, usize>,
    objects: Vec<Option<Arc<Object>>>,
    states: Vec<State<T>>,
}

impl<T: Clone> Shelf<T> {
    fn new(list: Vec<(String, Option<Object>)>) -> Self {
        let mut shelf = Self {
            names: Vec::new(),
            index: HashMap::new(),
            objects: Vec::new(),
            states: Vec::new(),
        };
        for (name, object) in list {
            shelf.index.insert(name.clone(), shelf.names.len());
            shelf.names.push(name);
            shelf.states.push(if object.is_some() {
                State::Waiting
            } else {
                State::Failed
            });
            shelf.objects.push(object.map(Arc::new));
        }
        shelf
    }

    fn object(&self, i: usize) -> Option<Arc<Object>> {
        self.objects[i].clone()
    }

    fn done(&self, i: usize) -> Option<T> {
        match &self.states[i] {
            State::Done(x) => Some(x.clone()),
            _ => None,
        }
    }
}

/// Builds objects, each once.
#[derive(Debug)]
pub(crate) struct Builder<'a> {
    pub(crate) diags: &'a mut Diagnostics,
    pub(crate) imports: Imports,
    curves: Shelf<CurveRef>,
    surfaces: Shelf<Arc<Vec<Patch>>>,
    /// The objects being built, outermost first.
    path: Vec<String>,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(
        curves: Vec<(String, Option<Object>)>,
        surfaces: Vec<(String, Option<Object>)>,
        imports: Imports,
        diags: &'a mut Diagnostics,
    ) -> Self {
        Self {
            diags,
            imports,
            curves: Shelf::new(curves),
            surfaces: Shelf::new(surfaces),
            path: Vec::new(),
        }
    }

    /// Builds everything that can be built.
    pub(crate) fn all(&mut self) {
        for i in 0..self.curves.names.len() {
            if matches!(self.curves.states[i], State::Waiting)
                && self.curve_at(i) == Err(Stop::Depends)
            {
                self.diags.skipped += 1;
            }
        }
        for i in 0..self.surfaces.names.len() {
            if matches!(self.surfaces.states[i], State::Waiting)
                && self.surface_at(i) == Err(Stop::Depends)
            {
                self.diags.skipped += 1;
            }
        }
    }

    /// The curves that were built, with their objects.
    pub(crate) fn curves(&self) -> impl Iterator<Item = (&str, Arc<Object>, CurveRef)> {
        let shelf = &self.curves;
        (0..shelf.names.len())
            .filter_map(|i| Some((shelf.names[i].as_str(), shelf.object(i)?, shelf.done(i)?)))
    }

    /// The surfaces that were built, with their objects.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = (&str, Arc<Object>, Arc<Vec<Patch>>)> {
        let shelf = &self.surfaces;
        (0..shelf.names.len())
            .filter_map(|i| Some((shelf.names[i].as_str(), shelf.object(i)?, shelf.done(i)?)))
    }

    /// The joins that were built.
    pub(crate) fn joins(&self) -> Vec<Join> {
        let joins = self.surfaces().filter(|(_, o, _)| o.kind.name == "join");
        joins
            .map(|(name, _, patches)| Join {
                name: name.to_owned(),
                members: patches.iter().filter_map(|p| p.suffix.clone()).collect(),
            })
            .collect()
    }

    fn curve_at(&mut self, i: usize) -> Result<(), Stop> {
        let Some(object) = self.curves.object(i) else {
            return Err(Stop::Depends);
        };
        self.curves.states[i] = State::Busy;
        let result = self.inside(&object, |b| {
            let curve = b.curve_of(&object)?;
            b.in_range(&object, curve.as_ref())?;
            Ok(curve)
        });
        // A cycle has marked the object as failed already.
        let failed = matches!(self.curves.states[i], State::Failed);
        self.curves.states[i] = match &result {
            Ok(c) if !failed => State::Done(c.clone()),
            _ => State::Failed,
        };
        result.map(|_| ())
    }

    fn surface_at(&mut self, i: usize) -> Result<(), Stop> {
        let Some(object) = self.surfaces.object(i) else {
            return Err(Stop::Depends);
        };
        self.surfaces.states[i] = State::Busy;
        let result = self.inside(&object, |b| {
            let patches = b.surface_of(&object)?;
            b.spread_out(&object, &patches)?;
            Ok(patches)
        });
        self.surfaces.states[i] = match result {
            Ok(patches) => {
                self.surfaces.states[i] = State::Done(Arc::new(patches));
                return Ok(());
            }
            Err(_) => State::Failed,
        };
        result.map(|_| ())
    }

    /// Refuses surfaces without area. The place is that of what gives its size.
    fn spread_out(&mut self, object: &Object, patches: &[Patch]) -> Built<()> {
        for p in patches {
            if let Err(e) = check_not_collapsed(p.surface.as_ref()) {
                let key = size_key(object);
                let help = match e {
                    CollapsedError::TooLarge { .. } => "use smaller numbers, or a larger unit",
                    CollapsedError::TooSmall { .. } => "use larger numbers, or a smaller unit",
                    CollapsedError::NotFinite { .. } => {
                        "use numbers of a reasonable size, and formulas that are finite everywhere"
                    }
                    _ => "give points or curves that span a surface",
                };
                return Err(self.refuse(object, (key, &[]), e, help));
            }
        }
        Ok(())
    }

    /// Refuses curves whose points are beyond what the kernel computes with.
    fn in_range(&mut self, object: &Object, curve: &dyn Curve) -> Built<()> {
        /// Places in each piece that are looked at.
        const PLACES: [f64; 3] = [0.0, 0.5, 1.0];
        let breaks = curve.breaks();
        let pieces = (0..breaks.pieces()).map(|i| breaks.piece(i));
        let places = pieces.flat_map(|p| PLACES.map(|s| p.lo + (p.hi - p.lo) * s));
        let far = places.map(|t| (t, curve.point(t))).find(|(_, p)| {
            // Written so that it is true of NaN.
            !(p.abs().max_element() <= LARGEST_LENGTH && p.is_finite())
        });
        let Some((t, p)) = far else {
            return Ok(());
        };
        let key = size_key(object);
        let message = format!(
            "at t = {t} the curve is at ({:e}, {:e}, {:e}); coordinates are at most ±{LARGEST_LENGTH:e}",
            p.x, p.y, p.z
        );
        let help = "use smaller numbers, or a larger unit";
        Err(self.refuse(object, (key, &[]), message, help))
    }

    /// Runs a part of the work as a part of an object: the path of names is kept for cycles and the depth.
    fn inside<T>(&mut self, object: &Object, work: impl FnOnce(&mut Self) -> Built<T>) -> Built<T> {
        if self.path.len() >= MAX_REFERENCE_DEPTH {
            self.diags.push(
                Diagnostic::new(
                    "limit",
                    format!(
                        "{}: references are nested deeper than {MAX_REFERENCE_DEPTH}",
                        object.label
                    ),
                )
                .at(object.fields.span.clone(), "too deep")
                .help("refer to the first of them directly"),
            );
            return Err(Stop::Reported);
        }
        self.path.push(object.label.clone());
        let result = work(self);
        self.path.pop();
        result
    }

    /// Reports that an object needs itself.
    fn cycle(&mut self, label: &str, span: &Span) -> Stop {
        let from = self.path.iter().position(|p| p == label).unwrap_or(0);
        let mut names: Vec<&str> = self.path[from..].iter().map(String::as_str).collect();
        names.push(label);
        self.diags.push(
            Diagnostic::new(
                "cycle",
                format!("objects depend on each other: {}", names.join(" → ")),
            )
            .at(span.clone(), "closes the cycle")
            .help("let one of them be built from points"),
        );
        Stop::Reported
    }

    fn unknown<'n>(
        &mut self,
        what: &str,
        name: &str,
        label: &str,
        span: &Span,
        help: String,
        all: impl Iterator<Item = &'n str>,
    ) -> Stop {
        let help = match nearest(name, all) {
            Some(n) => format!("did you mean `{n}`?"),
            None => help,
        };
        self.diags.push(
            Diagnostic::new(
                "unknown-reference",
                format!("{label}: there is no {what} `{name}`"),
            )
            .at(span.clone(), "not defined")
            .help(help),
        );
        Stop::Reported
    }

    /// A curve by name.
    fn named_curve(&mut self, name: &str, label: &str, span: &Span) -> Built<CurveRef> {
        let Some(&i) = self.curves.index.get(name) else {
            let help = if self.surfaces.index.contains_key(name) {
                format!("`{name}` is a surface; its sides are curves, such as \"{name}.south\"")
            } else {
                listed("curves", &self.curves.names)
            };
            let names = self.curves.names.clone();
            return Err(self.unknown(
                "curve",
                name,
                label,
                span,
                help,
                names.iter().map(String::as_str),
            ));
        };
        match self.curves.states[i] {
            State::Busy => return Err(self.cycle(&format!("curve `{name}`"), span)),
            State::Waiting => {
                // What is wrong has been reported at the other object.
                if self.curve_at(i) == Err(Stop::Depends) {
                    self.diags.skipped += 1;
                }
            }
            State::Done(_) | State::Failed => {}
        }
        self.curves.done(i).ok_or(Stop::Depends)
    }

    /// The surfaces that an object makes, by its name.
    pub(crate) fn patches(
        &mut self,
        name: &str,
        label: &str,
        span: &Span,
    ) -> Built<Arc<Vec<Patch>>> {
        let Some(&i) = self.surfaces.index.get(name) else {
            let help = if self.curves.index.contains_key(name) {
                format!("`{name}` is a curve; a surface is needed")
            } else {
                listed("surfaces", &self.surfaces.names)
            };
            let names = self.surfaces.names.clone();
            return Err(self.unknown(
                "surface",
                name,
                label,
                span,
                help,
                names.iter().map(String::as_str),
            ));
        };
        match self.surfaces.states[i] {
            State::Busy => return Err(self.cycle(&format!("surface `{name}`"), span)),
            State::Waiting => {
                if self.surface_at(i) == Err(Stop::Depends) {
                    self.diags.skipped += 1;
                }
            }
            State::Done(_) | State::Failed => {}
        }
        self.surfaces.done(i).ok_or(Stop::Depends)
    }

    /// One surface: by the name of an object that makes one, or `name/part` of an object that makes several.
    pub(crate) fn surface(&mut self, name: &str, label: &str, span: &Span) -> Built<SurfaceRef> {
        let (object, part) = match name.split_once('/') {
            Some((o, p)) => (o, Some(p)),
            None => (name, None),
        };
        let patches = self.patches(object, label, span)?;
        let parts: Vec<&str> = patches.iter().filter_map(|p| p.suffix.as_deref()).collect();
        match (part, patches.as_slice()) {
            (None, [one]) => Ok(one.surface.clone()),
            (Some(part), list) if list.iter().any(|p| p.suffix.as_deref() == Some(part)) => {
                let found = list.iter().find(|p| p.suffix.as_deref() == Some(part));
                found.map(|p| p.surface.clone()).ok_or(Stop::Depends)
            }
            (None, _) => {
                let first = parts.first().copied().unwrap_or_default();
                self.diags.push(
                    Diagnostic::new(
                        "several",
                        format!(
                            "{label}: `{object}` is made of {} surfaces; one is needed",
                            patches.len()
                        ),
                    )
                    .at(span.clone(), "which part?")
                    .help(format!(
                        "name a part, such as \"{object}/{first}\"; parts are {}",
                        parts.join(", ")
                    )),
                );
                Err(Stop::Reported)
            }
            (Some(part), _) => {
                let help = if parts.is_empty() {
                    format!("`{object}` is one surface; write \"{object}\"")
                } else {
                    format!("parts are {}", parts.join(", "))
                };
                let known: Vec<String> = parts.iter().map(|p| format!("{object}/{p}")).collect();
                let name = format!("{object}/{part}");
                Err(self.unknown(
                    "surface",
                    &name,
                    label,
                    span,
                    help,
                    known.iter().map(String::as_str),
                ))
            }
        }
    }

    /// A side of a surface as a curve.
    pub(crate) fn side(&mut self, side: &SideName, label: &str, span: &Span) -> Built<CurveRef> {
        let s = self.surface(&side.surface, label, span)?;
        Ok(Arc::new(Isocurve::side(s, side.side)))
    }

    /// The curve that a datum asks for.
    pub(crate) fn curve(&mut self, item: &Item, label: &str) -> Built<CurveRef> {
        match &item.datum {
            crate::data::Datum::Curve(source) => match source {
                CurveSource::Named(name) => self.named_curve(name, label, &item.span),
                CurveSource::Side(side) => self.side(side, label, &item.span),
                CurveSource::Inline(object) => {
                    let object = object.clone();
                    self.inside(&object, |b| b.curve_of(&object))
                }
            },
            _ => Err(Stop::Depends),
        }
    }

    /// The curve of a required key.
    pub(crate) fn curve_key(&mut self, object: &Object, key: &str) -> Built<CurveRef> {
        let item = object.fields.get(key).ok_or(Stop::Depends)?;
        self.curve(item, &format!("{}, `{key}`", object.label))
    }

    /// The surface that a required key names.
    pub(crate) fn surface_key(&mut self, object: &Object, key: &str) -> Built<SurfaceRef> {
        let name = object.fields.text(key).ok_or(Stop::Depends)?.to_owned();
        let span = object.fields.place(key, &[]);
        self.surface(&name, &format!("{}, `{key}`", object.label), &span)
    }

    /// Reports what the kernel refused, at the most specific place.
    pub(crate) fn refuse(
        &mut self,
        object: &Object,
        at: (&str, &[usize]),
        message: impl std::fmt::Display,
        help: impl Into<String>,
    ) -> Stop {
        self.refuse_in(&object.label, &object.fields, at, message, help)
    }

    /// The same for a table inside an object.
    pub(crate) fn refuse_in(
        &mut self,
        label: &str,
        fields: &Fields,
        at: (&str, &[usize]),
        message: impl std::fmt::Display,
        help: impl Into<String>,
    ) -> Stop {
        let remark = if at.0.is_empty() {
            String::new()
        } else {
            format!("`{}`", at.0)
        };
        self.diags.push(
            Diagnostic::new("geometry", format!("{label}: {message}"))
                .at(fields.place(at.0, at.1), remark)
                .help(help),
        );
        Stop::Reported
    }

    /// An axis: `x`, `y`, `z`, or a table with origin and direction. The default is z.
    pub(crate) fn axis(&mut self, label: &str, fields: &Fields, key: &str) -> Built<Frame> {
        let (origin, direction) = match (fields.record(key), fields.vector(key)) {
            (Some(r), _) => (
                r.vector("origin").unwrap_or(DVec3::ZERO),
                r.vector("direction").unwrap_or(DVec3::Z),
            ),
            (None, Some(d)) => (DVec3::ZERO, d),
            (None, None) => (DVec3::ZERO, DVec3::Z),
        };
        Frame::along(origin, direction).map_err(|e| {
            self.refuse_in(
                label,
                fields,
                (key, &[]),
                e,
                "give a direction that is not zero",
            )
        })
    }
}

/// The key that gives an object its size, or its first.
fn size_key(o: &Object) -> &'static str {
    let mut keys = ["scale", "semi_axes", "radius"].into_iter();
    keys.find(|k| o.fields.get(k).is_some())
        .or_else(|| o.fields.entries.first().map(|(k, _)| *k))
        .unwrap_or_default()
}

/// All names, for a help text.
fn listed(what: &str, names: &[String]) -> String {
    /// More names than this help nobody.
    const MOST: usize = 12;
    match names.len() {
        0 => format!("the model has no {what}"),
        n if n <= MOST => format!("{what} are {}", names.join(", ")),
        n => format!(
            "{what} are {}, and {} more",
            names[..MOST].join(", "),
            n - MOST
        ),
    }
}
