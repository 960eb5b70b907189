//! How the objects of a model move with a parameter: forward mode through the model.
//!
//! The file is read a second time, each number as its derivative with respect to the parameter. Every object then has
//! its values and their rates side by side, and its velocity is made from both, after the velocities of what it is made
//! of. What is not known is told by name, never approximated.

mod curves;
mod diagonal_key;
mod slide;
mod still;
mod surfaces;

use crate::build::{Builder, Patch, Stop};
use crate::data::{CurveSource, Datum, Item, Object, SideName};
use crate::diagnostics::Diagnostics;
use crate::import::Imports;
use crate::reader::{self, Overrides};
use crate::{MAX_REFERENCE_DEPTH, Model};
use nappe::curve::{CurveRef, Isocurve};
use nappe::expr::nearest;
use nappe::surface::{Dir, SurfaceRef};
use nappe::velocity::still_curve;
use slide::{Carried, Moved};
use std::collections::HashMap;
use std::sync::Arc;

/// How an object moves.
#[derive(Clone, Debug)]
pub enum Velocity<T> {
    /// Not at all.
    Still,
    /// With this velocity, in units of length for each unit of the parameter, at the parameters of the object.
    Moves(T),
    /// With this velocity of points that slide along the parameters: each keeps its share of the way between two corners,
    /// and these move along the parameter. At fixed parameters the velocity would jump there. Area, volume, box and all else
    /// that belongs to the shape alone change in the same way.
    Follows(T),
    /// It is not known; why.
    Unknown(String),
}

/// How all objects of a model move with a parameter.
#[derive(Clone, Debug)]
pub struct Velocities {
    /// The parameter.
    pub parameter: String,
    /// Its value.
    pub value: f64,
    /// For each of the model's curves.
    pub curves: Vec<Velocity<CurveRef>>,
    /// For each of the model's surfaces.
    pub surfaces: Vec<Velocity<SurfaceRef>>,
}

/// The velocities of all objects of a model that was loaded with these overrides.
///
/// A parameter that is itself an expression is taken as a number: what it is computed from stays. Errors: there is no such
/// parameter, or a number has no derivative, as on a kink of `max` or where a degree changes.
pub fn velocities(
    model: &Model,
    overrides: &Overrides,
    parameter: &str,
) -> Result<Velocities, Diagnostics> {
    let Some(known) = model.params.iter().find(|p| p.name == parameter) else {
        return Err(unknown(model, parameter));
    };
    let mut diags = Diagnostics::new(&model.warnings.file, &model.warnings.text);
    let mut found = None;
    let imports = Imports {
        importer: model.importer.clone(),
        units: model.units,
    };
    reader::with_rates(
        overrides,
        imports,
        parameter,
        &mut diags,
        |builder, rates| {
            let mut mover = Mover::new(builder, rates);
            let curves = model.curves.iter().map(|c| told(mover.curve(&c.name)));
            let curves = curves.collect();
            let surfaces = model.surfaces.iter();
            let surfaces = surfaces.map(|s| told(mover.surface(&s.name)));
            found = Some(Velocities {
                parameter: parameter.to_owned(),
                value: known.value,
                surfaces: surfaces.collect(),
                curves,
            });
        },
    );
    diags.sort();
    match found {
        Some(found) if !diags.has_errors() => Ok(found),
        _ => Err(diags),
    }
}

fn told<T>(motion: Motion<T>) -> Velocity<T> {
    match motion {
        Ok(None) => Velocity::Still,
        Ok(Some(m)) if m.slides.iter().any(Option::is_some) => Velocity::Follows(m.velocity),
        Ok(Some(m)) => Velocity::Moves(m.velocity),
        Err(why) => Velocity::Unknown(why),
    }
}

fn unknown(model: &Model, parameter: &str) -> Diagnostics {
    let names = || model.params.iter().map(|p| p.name.as_str());
    let help = match nearest(parameter, names()) {
        Some(n) => format!("did you mean `{n}`?"),
        None if model.params.is_empty() => "the model has no [params]".to_owned(),
        None => format!("parameters are {}", names().collect::<Vec<_>>().join(", ")),
    };
    let message = format!("there is no parameter `{parameter}`");
    model.fault("sensitivity", message, Vec::new(), help)
}

/// A velocity; none: it does not move. The error says why it is not known.
type Motion<T> = Result<Option<Moved<T>>, String>;
/// The velocities of an object's patches, in their order.
type Patches = Arc<Vec<Option<Moved<SurfaceRef>>>>;

/// The rates of all numbers of objects by name.
pub(crate) struct Rates {
    pub(crate) curves: HashMap<String, Arc<Object>>,
    pub(crate) surfaces: HashMap<String, Arc<Object>>,
}

/// Finds velocities, each once.
struct Mover<'b, 'd> {
    builder: &'b mut Builder<'d>,
    rates: Rates,
    curves: HashMap<String, (Arc<Object>, CurveRef)>,
    surfaces: HashMap<String, (Arc<Object>, Arc<Vec<Patch>>)>,
    moved_curves: HashMap<String, Motion<CurveRef>>,
    moved_surfaces: HashMap<String, Result<Patches, String>>,
    depth: usize,
}

/// An object: its values and their rates.
#[derive(Clone, Copy)]
struct Pair<'a> {
    at: &'a Object,
    rate: &'a Object,
}

impl Pair<'_> {
    /// The motion of the object is not known.
    fn unknown(&self, why: impl std::fmt::Display) -> String {
        format!("{}: {why}", self.at.label)
    }

    /// The same for a kind as a whole.
    fn unknown_kind(&self) -> String {
        self.unknown(format!(
            "how the kind \"{}\" changes with its data is not known",
            self.at.kind.name
        ))
    }

    /// True if all numbers of a key stay.
    fn stays(&self, key: &str) -> bool {
        self.rate.fields.get(key).is_none_or(still::item)
    }
}

impl<'b, 'd> Mover<'b, 'd> {
    fn new(builder: &'b mut Builder<'d>, rates: Rates) -> Self {
        let curves = builder.curves().map(|(n, o, c)| (n.to_owned(), (o, c)));
        let curves = curves.collect();
        let surfaces = builder.surfaces().map(|(n, o, p)| (n.to_owned(), (o, p)));
        let surfaces = surfaces.collect();
        Self {
            builder,
            rates,
            curves,
            surfaces,
            moved_curves: HashMap::new(),
            moved_surfaces: HashMap::new(),
            depth: 0,
        }
    }

    /// The velocity of a curve by name.
    fn curve(&mut self, name: &str) -> Motion<CurveRef> {
        if let Some(known) = self.moved_curves.get(name) {
            return known.clone();
        }
        let (Some((at, curve)), Some(rate)) = (
            self.curves.get(name).cloned(),
            self.rates.curves.get(name).cloned(),
        ) else {
            return Err(format!("curve `{name}`: it is not built"));
        };
        let pair = Pair {
            at: &at,
            rate: &rate,
        };
        let moved = self.nested(pair, |m| m.moved_curve(pair, &curve));
        self.moved_curves.insert(name.to_owned(), moved.clone());
        moved
    }

    /// The velocities of all patches of an object.
    fn patches(&mut self, name: &str) -> Result<Patches, String> {
        if let Some(known) = self.moved_surfaces.get(name) {
            return known.clone();
        }
        let (Some((at, patches)), Some(rate)) = (
            self.surfaces.get(name).cloned(),
            self.rates.surfaces.get(name).cloned(),
        ) else {
            return Err(format!("surface `{name}`: it is not built"));
        };
        let pair = Pair {
            at: &at,
            rate: &rate,
        };
        let moved = self.nested(pair, |m| m.moved_surface(pair, &patches));
        let moved = moved.map(Arc::new);
        self.moved_surfaces.insert(name.to_owned(), moved.clone());
        moved
    }

    /// The velocity of a surface by name, `object` or `object/part`.
    fn surface(&mut self, name: &str) -> Motion<SurfaceRef> {
        let (object, part) = match name.split_once('/') {
            Some((o, p)) => (o, Some(p)),
            None => (name, None),
        };
        let moved = self.patches(object)?;
        let patches = self.surfaces.get(object).map(|s| s.1.clone());
        let index = patches.and_then(|p| p.iter().position(|p| p.suffix.as_deref() == part));
        match index.and_then(|i| moved.get(i)) {
            Some(v) => Ok(v.clone()),
            None => Err(format!("surface `{name}`: it is not built")),
        }
    }

    /// Runs a part of the work one level deeper.
    fn nested<T>(
        &mut self,
        pair: Pair<'_>,
        work: impl FnOnce(&mut Self) -> Result<T, String>,
    ) -> Result<T, String> {
        if self.depth >= MAX_REFERENCE_DEPTH {
            return Err(pair.unknown("references are nested too deep"));
        }
        self.depth += 1;
        let result = work(self);
        self.depth -= 1;
        result
    }

    /// A curve that a datum asks for, with its velocity.
    fn item(&mut self, item: &Item, rate: &Item, label: &str) -> Result<Carried, String> {
        let built = |stop: Stop| format!("{label}: it is not built ({stop:?})");
        let curve = self.builder.curve(item, label).map_err(built)?;
        let velocity = match (&item.datum, &rate.datum) {
            (Datum::Curve(CurveSource::Named(name)), _) => self.curve(name)?,
            (Datum::Curve(CurveSource::Side(side)), _) => self.side(side)?,
            (Datum::Curve(CurveSource::Inline(at)), Datum::Curve(CurveSource::Inline(rate))) => {
                let pair = Pair { at, rate };
                self.nested(pair, |m| m.moved_curve(pair, &curve))?
            }
            _ => return Err(format!("{label}: it is not a curve")),
        };
        Ok((curve, velocity))
    }

    /// The velocity of a side of a surface: where points slide across it they stay on it.
    fn side(&mut self, side: &SideName) -> Motion<CurveRef> {
        let Some(moved) = self.surface(&side.surface)? else {
            return Ok(None);
        };
        let [u, v] = moved.slides;
        let slide = match side.side.along() {
            Dir::U => u,
            Dir::V => v,
        };
        let velocity = Arc::new(Isocurve::side(moved.velocity, side.side));
        Ok(Some(Moved::sliding(velocity, slide)))
    }

    /// The curve of a required key, with its velocity.
    fn key(&mut self, pair: Pair<'_>, key: &str) -> Result<Carried, String> {
        let label = format!("{}, `{key}`", pair.at.label);
        match (pair.at.fields.get(key), pair.rate.fields.get(key)) {
            (Some(item), Some(rate)) => self.item(item, rate, &label),
            _ => Err(format!("{label}: it is missing")),
        }
    }

    /// The velocity of the curve of a required key at fixed parameters, zero if it does not move.
    fn velocity_of(&mut self, pair: Pair<'_>, key: &str) -> Result<CurveRef, String> {
        let (curve, moved) = self.key(pair, key)?;
        match moved {
            Some(moved) => moved.fixed(),
            None => Ok(still_curve(curve.breaks())),
        }
    }
}
