//! STEP files out.

mod body;
mod conic;
mod forms;
mod geometry;
mod out;
mod text;
mod together;

use crate::atomic::write_atomically;
use crate::report::{Progress, Shares};
use crate::{Colour, Document, ExchangeError, Item, ItemForm};
use forms::CurveShape;
use nappe::Units;
use nappe::mesh::Certainty;
use nappe::parallel;
use out::{Out, encoded};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::path::Path;

/// The standard that a file follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Schema {
    /// AP242, managed model based engineering.
    #[default]
    Ap242,
    /// AP214, automotive design: what older systems read.
    Ap214,
}

/// How to write.
#[derive(Clone, Copy, Debug)]
pub struct StepOptions {
    /// The standard.
    pub schema: Schema,
    /// How far what has no exact form may be from the surface it stands for.
    pub tolerance: f64,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// How far curves and surfaces of the file are from the document's.
    pub certainty: Certainty,
    /// How many surfaces are approximated.
    pub approximated: usize,
    /// The uncertainty that the file states.
    pub uncertainty: f64,
    /// Solids and sheets.
    pub bodies: [usize; 2],
}

/// Why nothing was written.
#[derive(Debug)]
pub(super) enum WriteError {
    Io(io::Error),
    Shape(String),
}

impl From<io::Error> for WriteError {
    fn from(e: io::Error) -> Self {
        WriteError::Io(e)
    }
}

/// The least uncertainty that is stated, relative to the largest coordinate: what other systems compute with.
const LEAST: f64 = 1e-12;
/// So many faces' forms are found at once, before they are written: enough for all cores, few in memory.
const GROUP: usize = 128;
/// The uncertainty that other systems expect of exact shapes, millimetres.
const USUAL: f64 = 1e-7;

/// Writes a document to a file, which is replaced only when the new one is whole.
///
/// Surfaces and curves go out as what they are in elementary geometry, else as NURBS; what has no exact form is
/// approximated within [`StepOptions::tolerance`].
///
/// # Errors
/// [`ExchangeError`]: nothing to write, numbers that are not finite, a file that cannot be written.
pub fn write(
    path: &Path,
    document: &Document,
    options: &StepOptions,
) -> Result<StepReport, ExchangeError> {
    write_telling(path, document, options, Progress::default())
}

/// The same, telling how far it is.
pub(crate) fn write_telling(
    path: &Path,
    document: &Document,
    options: &StepOptions,
    progress: Progress<'_>,
) -> Result<StepReport, ExchangeError> {
    document.holds_something(path)?;
    let mut shape = None;
    let written = write_atomically(path, |to| match put(to, document, options, progress) {
        Ok(report) => Ok(report),
        Err(WriteError::Io(e)) => Err(e),
        Err(WriteError::Shape(why)) => {
            shape = Some(why.clone());
            Err(io::Error::other(why))
        }
    });
    match shape {
        Some(why) => Err(ExchangeError::Shape {
            path: path.to_owned(),
            why,
        }),
        None => written,
    }
}

/// Writes a document to any place.
pub(super) fn put(
    to: &mut (dyn Write + Send),
    document: &Document,
    options: &StepOptions,
    progress: Progress<'_>,
) -> Result<StepReport, WriteError> {
    let threads = parallel::all_threads();
    let mut out = Out::new(to, threads);
    let name = document.name.as_deref().unwrap_or("");
    header(&mut out, name, options.schema);
    let mut report = StepReport {
        certainty: Certainty::Exact,
        approximated: 0,
        uncertainty: USUAL * Units::Millimetre.metres() / document.units.metres(),
        bodies: [0, 0],
    };
    // Solids, sheets, curves and points: representations hold one kind each.
    let mut roots: [Vec<u64>; 3] = Default::default();
    let mut styled: Vec<(u64, Colour, bool)> = Vec::new();
    let mut tolerance = document.uncertainty.unwrap_or(0.0);
    let steps = Shares::new(progress, document.items.iter().map(steps).sum());
    let mut forms = VecDeque::new();
    for (i, item) in document.items.iter().enumerate() {
        if forms.is_empty() {
            let next = &document.items[i..];
            let next = &next[..group(next)];
            forms = forms::forms(next, options.tolerance, threads, &steps)?.into();
        }
        let mut forms = forms.pop_front().unwrap_or_default();
        match &item.form {
            ItemForm::Body { body, faces } => {
                let parts = body::body(&mut out, body, &item.name, faces, forms, &steps)?;
                for (id, solid) in parts.roots {
                    roots[usize::from(!solid)].push(id);
                    report.bodies[usize::from(!solid)] += 1;
                    styled.extend(item.colour.map(|c| (id, c, false)));
                }
                for (id, style) in parts.faces.iter().zip(faces) {
                    styled.extend(style.colour.map(|c| (*id, c, false)));
                }
                report.certainty = report.certainty.and(parts.certainty);
                report.approximated += parts.approximated;
                tolerance = tolerance.max(parts.tolerance);
            }
            ItemForm::Curve(curve) => {
                let form = forms.curve(0);
                report.certainty = report.certainty.and(form.certainty);
                let ends = matches!(form.shape, CurveShape::Spline(_));
                let id = geometry::curve(&mut out, form.shape, &item.name)?;
                let id = if ends {
                    id
                } else {
                    // Lines and ellipses end where they are trimmed.
                    let [from, to] = curve.ends();
                    let ends = [out.point(from)?, out.point(to)?];
                    out.open("TRIMMED_CURVE")
                        .text(&item.name)
                        .reference(id)
                        .references(&ends[..1])
                        .references(&ends[1..])
                        .word(".T.")
                        .word(".CARTESIAN.")
                        .close()?
                };
                let set = out
                    .open("GEOMETRIC_CURVE_SET")
                    .text("")
                    .references(&[id])
                    .close()?;
                styled.extend(item.colour.map(|c| (id, c, true)));
                roots[2].push(set);
            }
            ItemForm::Points(points) if points.is_empty() => {}
            ItemForm::Points(points) => {
                let first = out.points(points.clone())?;
                let set = out
                    .open("GEOMETRIC_CURVE_SET")
                    .text(&item.name)
                    .references_from(first, points.len())
                    .close()?;
                roots[2].push(set);
            }
        }
        if !out.is_finite() {
            let why = format!("`{}`: it has a number that is not finite", item.name);
            return Err(WriteError::Shape(why));
        }
    }
    if roots.iter().all(Vec::is_empty) {
        let why = "its items have no faces, curves or points";
        return Err(WriteError::Shape(why.into()));
    }
    report.uncertainty = report
        .uncertainty
        .max(tolerance)
        .max(report.certainty.error())
        .max(f64::MIN_POSITIVE / LEAST);
    product(
        &mut out,
        name,
        document.units,
        &report,
        &roots,
        &styled,
        options.schema,
    )?;
    if !out.is_finite() {
        let why = "its uncertainty or a colour is not a finite number";
        return Err(WriteError::Shape(why.into()));
    }
    out.raw("ENDSEC;\nEND-ISO-10303-21;\n");
    out.finish()?;
    Ok(report)
}

/// The steps that an item takes: finding a form for each face and edge, and writing each face.
fn steps(item: &Item) -> usize {
    match &item.form {
        ItemForm::Body { body, .. } => 2 * body.faces.len() + body.edges.len(),
        ItemForm::Curve(_) => 1,
        ItemForm::Points(_) => 0,
    }
}

/// How many of the first items have [`GROUP`] faces, curves and points, or more.
fn group(items: &[Item]) -> usize {
    let mut size = 0;
    let large = items.iter().position(|item| {
        size += match &item.form {
            ItemForm::Body { body, .. } => body.faces.len(),
            _ => 1,
        };
        size >= GROUP
    });
    large.map_or(items.len(), |i| i + 1)
}

fn header(out: &mut Out<'_>, name: &str, schema: Schema) {
    let schema = match schema {
        Schema::Ap242 => "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
        Schema::Ap214 => "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
    };
    let version = concat!("nappe ", env!("CARGO_PKG_VERSION"));
    out.raw(&format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME({},'',(''),(''),'{version}','nappe','');\n\
         FILE_SCHEMA(('{schema}'));\nENDSEC;\nDATA;\n",
        encoded(name)
    ));
}

/// What the numbers mean, and the product that has the shapes.
fn product(
    out: &mut Out<'_>,
    name: &str,
    units: Units,
    report: &StepReport,
    roots: &[Vec<u64>; 3],
    styled: &[(u64, Colour, bool)],
    schema: Schema,
) -> Result<(), WriteError> {
    let length = length_unit(out, units)?;
    let angle = out.whole("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")?;
    let solid = out.whole("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")?;
    out.open("UNCERTAINTY_MEASURE_WITH_UNIT");
    out.raw("LENGTH_MEASURE(");
    out.real(report.uncertainty);
    let uncertainty = out
        .end()
        .reference(length)
        .text("distance_accuracy_value")
        .text("")
        .close()?;
    let context = out.whole(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('',''))"
    ))?;
    let (application, year, words) = match schema {
        Schema::Ap242 => (
            "ap242_managed_model_based_3d_engineering",
            2014,
            "managed model based 3d engineering",
        ),
        Schema::Ap214 => (
            "automotive_design",
            2000,
            "core data for automotive mechanical design processes",
        ),
    };
    let name = encoded(name);
    let app = out.whole(&format!("APPLICATION_CONTEXT('{words}')"))?;
    out.whole(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','{application}',{year},#{app})"
    ))?;
    let of_product = out.whole(&format!("PRODUCT_CONTEXT('',#{app},'mechanical')"))?;
    let product = out.whole(&format!("PRODUCT({name},{name},'',(#{of_product}))"))?;
    out.whole(&format!(
        "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"
    ))?;
    let formation = out.whole(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"))?;
    let stage = out.whole(&format!(
        "PRODUCT_DEFINITION_CONTEXT('part definition',#{app},'design')"
    ))?;
    let definition = out.whole(&format!(
        "PRODUCT_DEFINITION('design','',#{formation},#{stage})"
    ))?;
    let shape = out.whole(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"))?;
    let kinds = [
        "ADVANCED_BREP_SHAPE_REPRESENTATION",
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
        "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION",
    ];
    let mut main = None;
    for (kind, roots) in kinds.into_iter().zip(roots).filter(|k| !k.1.is_empty()) {
        let id = out
            .open(kind)
            .text("")
            .references(roots)
            .reference(context)
            .close()?;
        match main {
            None => {
                main = Some(id);
                out.whole(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{id})"))?;
            }
            Some(first) => {
                out.whole(&format!(
                    "SHAPE_REPRESENTATION_RELATIONSHIP('','',#{first},#{id})"
                ))?;
            }
        }
    }
    let mut items = Vec::new();
    for (id, colour, is_curve) in styled {
        items.push(style(out, *id, *colour, *is_curve)?);
    }
    if !items.is_empty() {
        let keyword = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION";
        out.open(keyword)
            .text("")
            .references(&items)
            .reference(context)
            .close()?;
    }
    Ok(())
}

fn length_unit(out: &mut Out<'_>, units: Units) -> io::Result<u64> {
    let si = |prefix: &str| format!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))");
    let (name, millimetres) = match units {
        Units::Millimetre => return out.whole(&si(".MILLI.")),
        Units::Centimetre => return out.whole(&si(".CENTI.")),
        Units::Metre => return out.whole(&si("$")),
        Units::Inch => ("INCH", "25.4"),
        Units::Foot => ("FOOT", "304.8"),
    };
    let own = out.whole(&si(".MILLI."))?;
    let size = out.whole(&format!(
        "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({millimetres}),#{own})"
    ))?;
    let dimensions = out.whole("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")?;
    out.whole(&format!(
        "(CONVERSION_BASED_UNIT('{name}',#{size})LENGTH_UNIT()NAMED_UNIT(#{dimensions}))"
    ))
}

fn style(out: &mut Out<'_>, item: u64, colour: Colour, is_curve: bool) -> io::Result<u64> {
    // The shortest decimals of f32, as f64 shows nine digits that nobody stated.
    let shortest = |x: f32| x.to_string().parse().unwrap_or(f64::from(x));
    out.open("COLOUR_RGB").text("");
    for x in colour {
        out.real(shortest(x.clamp(0.0, 1.0)));
    }
    let rgb = out.close()?;
    let style = if is_curve {
        let font = out.whole("DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')")?;
        out.whole(&format!(
            "CURVE_STYLE('',#{font},POSITIVE_LENGTH_MEASURE(0.1),#{rgb})"
        ))?
    } else {
        let fill = out.whole(&format!("FILL_AREA_STYLE_COLOUR('',#{rgb})"))?;
        let area = out.whole(&format!("FILL_AREA_STYLE('',(#{fill}))"))?;
        let surface = out.whole(&format!("SURFACE_STYLE_FILL_AREA(#{area})"))?;
        let side = out.whole(&format!("SURFACE_SIDE_STYLE('',(#{surface}))"))?;
        out.whole(&format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"))?
    };
    let assigned = out.whole(&format!("PRESENTATION_STYLE_ASSIGNMENT((#{style}))"))?;
    out.whole(&format!("STYLED_ITEM('color',(#{assigned}),#{item})"))
}
