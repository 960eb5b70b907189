//! Points, directions and placements, brought to the document's coordinates.

use super::file::{File, Got};
use super::units::Context;
use super::value::Value;
use glam::{DAffine3, DMat3, DVec3};
use nappe::{Frame, LARGEST_LENGTH, Units};

/// How a representation's numbers become the document's.
#[derive(Clone, Debug)]
pub(super) struct Space<'a> {
    /// The file.
    pub(super) file: &'a File<'a>,
    /// Lengths are multiplied with this.
    pub(super) factor: f64,
    /// Angles are multiplied with this.
    pub(super) radians: f64,
    /// Where the part lies in the whole; `None` where it is.
    pub(super) map: Option<DAffine3>,
    /// The distance within which parts agree, in the document's unit.
    pub(super) uncertainty: f64,
}

/// Relative difference of lengths within which a map keeps shapes as they are.
const RIGID: f64 = 1e-9;
/// What a file that says nothing is taken to be accurate to, relative to a length of 1.
const UNSTATED: f64 = 1e-6;

impl<'a> Space<'a> {
    pub(super) fn new(
        file: &'a File<'a>,
        context: &Context,
        units: Units,
        map: Option<DAffine3>,
    ) -> Self {
        let factor = context.factor(units);
        Space {
            file,
            factor,
            radians: context.radians,
            map: map.filter(|m| *m != DAffine3::IDENTITY),
            uncertainty: context.uncertainty.unwrap_or(UNSTATED) * factor,
        }
    }

    /// The same without the place in the whole.
    pub(super) fn own(&self) -> Self {
        Space {
            map: None,
            ..self.clone()
        }
    }

    /// The map scales by this (maps that do anything but move, turn and scale evenly are refused before).
    pub(super) fn length(&self, x: f64) -> f64 {
        let x = if self.factor == 1.0 {
            x
        } else {
            x * self.factor
        };
        match &self.map {
            Some(m) => x * scale_of(m),
            None => x,
        }
    }

    /// A `CARTESIAN_POINT`.
    pub(super) fn point(&self, id: u64) -> Got<DVec3> {
        let p = DVec3::from(self.file.triple(id, "CARTESIAN_POINT")?);
        let p = if self.factor == 1.0 {
            p
        } else {
            p * self.factor
        };
        let p = match &self.map {
            Some(m) => m.transform_point3(p),
            None => p,
        };
        // Not a number is not within either.
        if p.to_array().iter().all(|x| x.abs() <= LARGEST_LENGTH) {
            return Ok(p);
        }
        let why = format!("it is farther than {LARGEST_LENGTH:e} from the origin");
        Err(self.file.refused(id, why))
    }

    /// A `DIRECTION`, of any length but 0.
    pub(super) fn direction(&self, id: u64) -> Got<DVec3> {
        let d = DVec3::from(self.file.triple(id, "DIRECTION")?);
        if d == DVec3::ZERO {
            return Err(self.file.refused(id, "it is zero and points nowhere"));
        }
        Ok(match &self.map {
            Some(m) => m.matrix3 * d,
            None => d,
        })
    }

    /// A `VECTOR`: a direction with a length.
    pub(super) fn vector(&self, id: u64) -> Got<DVec3> {
        let record = self.file.record(id)?;
        let args = record.needed("VECTOR")?;
        let direction = self.direction(args.reference(1)?)?.normalize_or_zero();
        let vector = direction * self.length(args.real(2)?);
        if vector == DVec3::ZERO || !vector.is_finite() {
            return Err(record.refused("it has no length"));
        }
        Ok(vector)
    }

    /// An `AXIS2_PLACEMENT_3D` or `AXIS1_PLACEMENT`.
    pub(super) fn frame(&self, id: u64) -> Got<Frame> {
        let record = self.file.record(id)?;
        let (args, round) = match (
            record.part("AXIS2_PLACEMENT_3D"),
            record.part("AXIS1_PLACEMENT"),
        ) {
            (Some(args), _) => (args, false),
            (_, Some(args)) => (args, true),
            _ => return Err(record.refused("it is not a placement in space")),
        };
        let origin = self.point(args.reference(1)?)?;
        let direction = |i: usize| match args.get(i) {
            Some(Value::Ref(id)) => self.direction(*id).map(Some),
            _ => Ok(None),
        };
        let mapped = |d: DVec3| self.map.map_or(d, |m| m.matrix3 * d);
        let z = direction(2)?.unwrap_or_else(|| mapped(DVec3::Z));
        let x = if round { None } else { direction(3)? };
        // Without a direction, x is that of space, or y where the axis runs along that (ISO 10303-42, first_proj_axis).
        let frame = match x.filter(|x| x.normalize().cross(z.normalize()).length() > RIGID) {
            Some(x) => Frame::new(origin, z, x),
            None => Frame::new(origin, z, mapped(DVec3::X))
                .or_else(|_| Frame::new(origin, z, mapped(DVec3::Y))),
        };
        frame.map_err(|e| record.refused(e.to_string()))
    }

    /// The map from the coordinates of a placement to space, or that of a `CARTESIAN_TRANSFORMATION_OPERATOR_3D`.
    pub(super) fn map_of(&self, id: u64) -> Got<DAffine3> {
        if self.file.kind(id) != "CARTESIAN_TRANSFORMATION_OPERATOR_3D" {
            return Ok(map_of(&self.frame(id)?));
        }
        let record = self.file.record(id)?;
        // In files of the second edition a name and two texts more come first.
        let args = record.args();
        let first = args
            .values
            .iter()
            .rposition(|v| matches!(v, Value::Text(_)))
            .map_or(0, |i| i + 1);
        let axis = |i: usize, default: DVec3| match args.get(first + i) {
            Some(Value::Ref(id)) => self.direction(*id).map(DVec3::normalize),
            _ => Ok(default),
        };
        let origin = self.point(args.reference(first + 2)?)?;
        let z = axis(4, DVec3::Z)?;
        let default = if z.cross(DVec3::X).length() > RIGID {
            DVec3::X
        } else {
            DVec3::Y
        };
        let x = axis(0, default)?;
        let frame = Frame::new(origin, z, x).map_err(|e| record.refused(e.to_string()))?;
        let y = axis(1, frame.y())?;
        if y.dot(frame.y()) < 0.0 {
            return Err(record.refused("it mirrors, which is not read"));
        }
        let scale = match args.get(first + 3) {
            Some(Value::Real(_) | Value::Int(_)) => args.real(first + 3)?,
            _ => 1.0,
        };
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(record.refused(format!("its scale is {scale}, not a positive number")));
        }
        Ok(map_of(&frame) * DAffine3::from_scale(DVec3::splat(scale)))
    }
}

fn map_of(frame: &Frame) -> DAffine3 {
    let [x, y, z] = frame.directions();
    DAffine3 {
        matrix3: DMat3::from_cols(x, y, z),
        translation: frame.origin(),
    }
}

/// How an even map scales.
pub(super) fn scale_of(map: &DAffine3) -> f64 {
    let scale = map.matrix3.x_axis.length();
    if (scale - 1.0).abs() < RIGID {
        1.0
    } else {
        scale
    }
}
