//! The units and the uncertainty of a context.

use super::file::{Args, File, Got, Record, Refused, number};
use super::value::Value;
use nappe::Units;

/// What the numbers of a representation mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Context {
    /// The unit of length, metres.
    pub(super) metres: f64,
    /// The unit of angles, radians.
    pub(super) radians: f64,
    /// The distance within which its parts agree, in its own unit.
    pub(super) uncertainty: Option<f64>,
    /// Whether the file says what the unit of length is.
    pub(super) stated: bool,
}

impl Default for Context {
    /// What is meant by a file that states no units: millimetres and radians.
    fn default() -> Self {
        Context {
            metres: 0.001,
            radians: 1.0,
            uncertainty: None,
            stated: false,
        }
    }
}

/// A factor within this of a known unit's is that unit: files state inches and degrees with ten digits or so.
const SAME: f64 = 1e-8;
/// An uncertainty larger than this share of all points' extent says nothing about the shapes.
const VAGUE: f64 = 1e-2;
/// Uncertainties below this, in the file's numbers, are not compared with the extent: of shapes so small that they would be too
/// large nothing is lost by it, as curves have their own limits.
const FINE: f64 = 1e-3;
/// Units made of units are followed so far.
const DEPTH: usize = 8;

impl Context {
    /// The context with this number. What of it cannot be read is told to `fault`; the rest counts.
    pub(super) fn read(file: &File<'_>, id: u64, fault: &mut dyn FnMut(Refused)) -> Self {
        let mut context = Context::default();
        let record = match file.record(id) {
            Ok(record) => record,
            Err(r) => {
                fault(assumed(r));
                return context;
            }
        };
        if let Some(units) = record.part("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            let units = units.references(0).unwrap_or_else(|r| {
                fault(assumed(r));
                vec![]
            });
            for unit in units {
                match unit_of(file, unit, 0) {
                    Ok(Some(Unit::Length(metres))) => {
                        context.metres = snapped(metres);
                        context.stated = true;
                    }
                    Ok(Some(Unit::Angle(radians))) => {
                        let degree = 1f64.to_radians();
                        let near = (radians / degree - 1.0).abs() < SAME;
                        context.radians = if near { degree } else { radians };
                    }
                    Ok(None) => {}
                    Err(r) => fault(assumed(r)),
                }
            }
        }
        if let Some(list) = record.part("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT") {
            for id in list.references(0).unwrap_or_default() {
                match uncertainty(file, id) {
                    Ok(Some(metres)) => context.uncertainty = Some(metres / context.metres),
                    Ok(None) => {}
                    Err(r) => fault(r),
                }
            }
        }
        if let Some(x) = context.uncertainty
            && x > FINE
            && file.extent() > 0.0
            && x > VAGUE * file.extent()
        {
            context.uncertainty = None;
            let why = format!(
                "its uncertainty of {x} is not small beside the {} that its points extend; it is not used",
                file.extent()
            );
            fault(file.refused(id, why));
        }
        context
    }

    /// The nearest unit that coordinates can be given in, and the factor to it.
    pub(super) fn nearest(&self) -> Units {
        let all = [
            Units::Millimetre,
            Units::Centimetre,
            Units::Metre,
            Units::Inch,
            Units::Foot,
        ];
        let far = |u: &Units| (self.metres / u.metres()).ln().abs();
        all.into_iter()
            .min_by(|a, b| far(a).total_cmp(&far(b)))
            .unwrap_or_default()
    }

    /// What lengths are multiplied with to be in a unit: exactly 1 if that is the context's own.
    pub(super) fn factor(&self, units: Units) -> f64 {
        if self.metres == units.metres() {
            1.0
        } else {
            self.metres / units.metres()
        }
    }
}

/// A refusal of a unit, with what is done about it.
pub(super) fn assumed(r: Refused) -> Refused {
    let why = format!(
        "{}; of units that are not stated otherwise lengths are taken as millimetres, angles as radians",
        r.why
    );
    Refused { why, ..r }
}

/// The parameters of a value with its unit, which may be one part of several.
fn measure<'r, 'a>(record: &'r Record<'a>) -> Args<'r, 'a> {
    record
        .part("MEASURE_WITH_UNIT")
        .unwrap_or_else(|| record.args())
}

/// A stated uncertainty of lengths, metres.
fn uncertainty(file: &File<'_>, id: u64) -> Got<Option<f64>> {
    let record = file.record(id)?;
    let args = measure(&record);
    // The other uncertainties are of angles and parameters.
    let Some(Value::Typed(b"LENGTH_MEASURE", _)) = args.get(0) else {
        return Ok(None);
    };
    let x = args.real(0)?;
    if x.is_nan() || x < 0.0 {
        return Err(record.refused(format!(
            "the uncertainty {x} is less than nothing; it is not used"
        )));
    }
    let unit = unit_of(file, args.reference(1)?, 0)?;
    Ok(match unit {
        // Many systems write 0 where they know nothing.
        Some(Unit::Length(metres)) if x > 0.0 => Some(x * metres),
        _ => None,
    })
}

fn snapped(metres: f64) -> f64 {
    let context = Context {
        metres,
        ..Context::default()
    };
    let near = context.nearest().metres();
    if (metres / near - 1.0).abs() < SAME {
        near
    } else {
        metres
    }
}

enum Unit {
    Length(f64),
    Angle(f64),
}

fn unit_of(file: &File<'_>, id: u64, depth: usize) -> Got<Option<Unit>> {
    if depth > DEPTH {
        return Err(file.refused(id, "units are made of units without end"));
    }
    let record = file.record(id)?;
    let size = if let Some(si) = record.part("SI_UNIT") {
        prefix(&si)?
    } else if let Some(args) = record.part("CONVERSION_BASED_UNIT") {
        let measure = file.record(args.reference(1)?)?;
        let args = self::measure(&measure);
        let factor = args
            .get(0)
            .and_then(number)
            .filter(|x| *x > 0.0)
            .ok_or_else(|| measure.refused("its factor is not a positive number"))?;
        match unit_of(file, args.reference(1)?, depth + 1)? {
            Some(Unit::Length(x) | Unit::Angle(x)) => x * factor,
            None => return Ok(None),
        }
    } else {
        return Ok(None);
    };
    Ok(if record.part("LENGTH_UNIT").is_some() {
        Some(Unit::Length(size))
    } else {
        record
            .part("PLANE_ANGLE_UNIT")
            .is_some()
            .then_some(Unit::Angle(size))
    })
}

fn prefix(si: &Args<'_, '_>) -> Got<f64> {
    let Some(Value::Enum(prefix)) = si.get(0) else {
        return Ok(1.0);
    };
    Ok(match *prefix {
        b"EXA" => 1e18,
        b"PETA" => 1e15,
        b"TERA" => 1e12,
        b"GIGA" => 1e9,
        b"MEGA" => 1e6,
        b"KILO" => 1e3,
        b"HECTO" => 1e2,
        b"DECA" => 1e1,
        b"DECI" => 1e-1,
        b"CENTI" => 1e-2,
        b"MILLI" => 1e-3,
        b"MICRO" => 1e-6,
        b"NANO" => 1e-9,
        b"PICO" => 1e-12,
        b"FEMTO" => 1e-15,
        b"ATTO" => 1e-18,
        _ => return Err(si.refused("its prefix is not known")),
    })
}
