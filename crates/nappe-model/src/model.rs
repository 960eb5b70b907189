//! A model: what a file describes, built.

use crate::checks::Check;
use crate::diagnostics::{Diagnostic, Diagnostics, Label};
use crate::import::Importer;
use crate::params::Parameter;
use nappe::curve::CurveRef;
use nappe::surface::SurfaceRef;
use nappe::{DVec3, Units};
use std::ops::Range;
use std::sync::Arc;

/// A curve of a model.
#[derive(Clone, Debug)]
pub struct NamedCurve {
    /// Its name.
    pub name: String,
    /// Its kind, as written.
    pub kind: &'static str,
    /// The curve.
    pub curve: CurveRef,
    /// Built for others; not put out.
    pub construction_only: bool,
    /// Where in the file it is named.
    pub place: Range<usize>,
}

/// A surface of a model.
///
/// An object that makes several surfaces (the image of a join) gives one entry for each, named `object/part`, in a fixed
/// order.
#[derive(Clone, Debug)]
pub struct NamedSurface {
    /// Its name: the object's, or `object/part`.
    pub name: String,
    /// The name of the object that made it.
    pub object: String,
    /// Its kind, as written.
    pub kind: &'static str,
    /// The surface.
    pub surface: SurfaceRef,
    /// Built for others; not put out.
    pub construction_only: bool,
    /// Where in the file it is named.
    pub place: Range<usize>,
    /// The control net, rows along u, if the kind is given by one.
    pub control_net: Option<Vec<Vec<DVec3>>>,
}

/// A `join`. Its members stand in the model's list of surfaces by their own names and are put out once, there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Join {
    /// Its name.
    pub name: String,
    /// The names of its members in the model's list of surfaces.
    pub members: Vec<String>,
}

/// What a file describes.
#[derive(Clone, Debug)]
pub struct Model {
    /// The title, or the file's name.
    pub title: String,
    /// The unit of length.
    pub units: Units,
    /// The greatest distance of a mesh from the surface, in units, if given.
    pub tolerance: Option<f64>,
    /// Where in the file the tolerance stands.
    pub tolerance_place: Option<Range<usize>>,
    /// The parameters in the order of the file, overrides applied.
    pub params: Vec<Parameter>,
    /// All curves in the order of the file.
    pub curves: Vec<NamedCurve>,
    /// All surfaces in the order of the file.
    pub surfaces: Vec<NamedSurface>,
    /// The joins: surfaces that were found to belong together without gaps.
    pub joins: Vec<Join>,
    /// The declared checks.
    pub checks: Vec<Check>,
    /// What should be known about it; no errors.
    pub warnings: Diagnostics,
    /// What read its files, for when it is built again.
    pub(crate) importer: Option<Arc<dyn Importer>>,
}

impl Model {
    /// An error that showed only when the model was used, as it is shown: at its places in the file. `code` is the
    /// class of the problem, a short stable name.
    pub fn fault(
        &self,
        code: &'static str,
        message: impl Into<String>,
        labels: Vec<Label>,
        help: impl Into<String>,
    ) -> Diagnostics {
        let mut all = Diagnostics::new(&self.warnings.file, &self.warnings.text);
        let mut fault = Diagnostic::new(code, message).help(help);
        fault.labels = labels;
        all.push(fault);
        all
    }

    /// A surface by name.
    pub fn surface(&self, name: &str) -> Option<&NamedSurface> {
        self.surfaces.iter().find(|s| s.name == name)
    }

    /// A curve by name.
    pub fn curve(&self, name: &str) -> Option<&NamedCurve> {
        self.curves.iter().find(|c| c.name == name)
    }

    /// The surfaces that are put out.
    pub fn output(&self) -> impl Iterator<Item = &NamedSurface> {
        self.surfaces.iter().filter(|s| !s.construction_only)
    }
}
