//! The model that a command works on.

use crate::failure::{Failure, Problem};
use crate::imports::Files;
use crate::screen::Screen;
use nappe::curve::CurveRef;
use nappe::expr::nearest;
use nappe::surface::SurfaceRef;
use nappe_model::{Model, NamedSurface, Overrides, Velocities};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A model file and values for its parameters.
#[derive(Debug, clap::Args)]
pub(crate) struct ModelArgs {
    /// The model file
    model: PathBuf,

    /// Set a parameter of the model to a number or an expression; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<String>,
}

/// Checks the form of a setting; the model says whether it knows the name.
fn setting(text: &str) -> Result<String, String> {
    Overrides::default()
        .set_from(text)
        .map(|()| text.to_owned())
}

impl ModelArgs {
    /// The path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.model
    }

    /// Whether values are set on the command line.
    pub(crate) fn sets_parameters(&self) -> bool {
        !self.set.is_empty()
    }

    /// The values set on the command line.
    pub(crate) fn overrides(&self) -> Result<Overrides, Failure> {
        let mut overrides = Overrides::default();
        for text in &self.set {
            overrides.set_from(text).map_err(Failure::usage)?;
        }
        Ok(overrides)
    }

    /// How its objects move with each of some parameters.
    pub(crate) fn velocities(
        &self,
        model: &Model,
        parameters: &[String],
    ) -> Result<Vec<Velocities>, Failure> {
        let overrides = self.overrides()?;
        let one = |p: &String| nappe_model::velocities(model, &overrides, p);
        let all: Result<_, _> = parameters.iter().map(one).collect();
        all.map_err(|d| Failure::Model(Box::new(d)))
    }

    /// Reads and builds the model, and shows what should be known about it.
    pub(crate) fn open(&self, screen: &Screen) -> Result<Model, Failure> {
        let overrides = self.overrides()?;
        let files = Arc::new(Files::beside(&self.model));
        let model = nappe_model::load_with(&self.model, &overrides, files)
            .map_err(|d| Failure::Model(Box::new(d)))?;
        if !model.warnings.list.is_empty() {
            screen.warn(&model.warnings);
        }
        Ok(model)
    }
}

/// A surface by its name.
pub(crate) fn surface(model: &Model, name: &str) -> Result<SurfaceRef, Problem> {
    if let Some(found) = model.surface(name) {
        return Ok(found.surface.clone());
    }
    let parts: Vec<&str> = model
        .surfaces
        .iter()
        .filter(|s| s.object == name)
        .map(|s| s.name.as_str())
        .collect();
    if !parts.is_empty() {
        return Err(
            Problem::new(format!("`{name}` is made of {} surfaces", parts.len()))
                .help(format!("name one of them: {}", parts.join(", "))),
        );
    }
    let names: Vec<&str> = model.surfaces.iter().map(|s| s.name.as_str()).collect();
    let is_curve = model.curve(name).is_some();
    Err(unknown(
        model,
        "surface",
        name,
        &names,
        is_curve.then_some("--curve"),
    ))
}

/// The surfaces of these names, of surfaces or of objects that make several, each with its name; for no names all that are
/// put out.
pub(crate) fn surfaces(
    model: &Model,
    names: &[String],
) -> Result<Vec<(String, SurfaceRef)>, Problem> {
    let named = |s: &NamedSurface| (s.name.clone(), s.surface.clone());
    if names.is_empty() {
        return Ok(model.output().map(named).collect());
    }
    let mut all: Vec<(String, SurfaceRef)> = Vec::new();
    for name in names {
        let parts = model.surfaces.iter().filter(|s| s.object == *name);
        let mut parts: Vec<_> = parts.map(named).collect();
        if parts.is_empty() {
            parts.push((name.clone(), surface(model, name)?));
        }
        parts.retain(|p| all.iter().all(|a| a.0 != p.0));
        all.extend(parts);
    }
    Ok(all)
}

/// A curve by its name.
pub(crate) fn curve(model: &Model, name: &str) -> Result<CurveRef, Problem> {
    if let Some(found) = model.curve(name) {
        return Ok(found.curve.clone());
    }
    let names: Vec<&str> = model.curves.iter().map(|c| c.name.as_str()).collect();
    let is_surface = model.surfaces.iter().any(|s| s.object == name);
    Err(unknown(
        model,
        "curve",
        name,
        &names,
        is_surface.then_some("--surface"),
    ))
}

/// Names listed in a message: more would hide what is said.
const MOST_NAMES: usize = 12;

fn unknown(model: &Model, what: &str, name: &str, known: &[&str], other: Option<&str>) -> Problem {
    let file = &model.warnings.file;
    let problem = Problem::new(format!("{file}: the model has no {what} `{name}`"));
    if let Some(flag) = other {
        return problem.help(format!("say {flag} {name}"));
    }
    if let Some(near) = nearest(name, known.iter().copied()) {
        return problem.help(format!("did you mean `{near}`?"));
    }
    match known {
        [] => problem.help(format!("it has no {what}s at all")),
        _ if known.len() > MOST_NAMES => problem.help(format!(
            "it has {}, … ({} in all)",
            known[..MOST_NAMES].join(", "),
            known.len()
        )),
        _ => problem.help(format!("it has {}", known.join(", "))),
    }
}
