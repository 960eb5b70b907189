//! Quadrics and tori.

use crate::build::{Builder, Built, Stop};
use crate::curves::need;
use crate::data::{Datum, Fields, Item, Object};
use nappe::exact::NurbsSurface;
use nappe::surface::{
    Quadric, QuadricError, QuadricOptions, QuadricShape, Torus, TorusError, TorusOptions,
};
use nappe::{DVec3, Frame};

impl Builder<'_> {
    pub(crate) fn quadric(&mut self, o: &Object) -> Built<Quadric> {
        let f = &o.fields;
        let word = need(f.text("shape"))?;
        let shape = need(QuadricShape::ALL.into_iter().find(|s| s.name() == word))?;
        let latitude = matches!(shape, QuadricShape::Ellipsoid | QuadricShape::Sphere);
        let range = self.range(o, [shape.is_round(), latitude])?;
        let center = f.vector("center").unwrap_or(DVec3::ZERO);
        let frame = self.frame(o, center)?;
        let axes = need(f.numbers("semi_axes"))?;
        Quadric::new(shape, &axes, QuadricOptions { frame, range }).map_err(|e| {
            if let QuadricError::Range { parameter, .. } | QuadricError::Outside { parameter, .. } =
                &e
            {
                let help = match &e {
                    QuadricError::Range { .. } => "write [from, to] with from < to",
                    _ => "choose a part of the shape",
                };
                return self.refuse_range(o, *parameter, &e, help);
            }
            let (key, path, help): (&str, Vec<usize>, String) = match &e {
                QuadricError::SemiAxisCount { shape, .. } => {
                    let help = match shape.semi_axes() {
                        [1, 1] => "write one number, the radius: [r]".to_owned(),
                        [a, b] if a == b => {
                            format!("write {a} numbers, such as {:?}", &[30, 20, 10][..a.min(3)])
                        }
                        [a, b] => format!("write {a} or {b} numbers"),
                    };
                    ("semi_axes", vec![], help)
                }
                QuadricError::SemiAxis { index, .. } => (
                    "semi_axes",
                    vec![*index],
                    "write a number greater than 0".into(),
                ),
                QuadricError::Range { .. } | QuadricError::Outside { .. } => {
                    ("range", vec![], String::new())
                }
                QuadricError::TwoHalves { .. } => (
                    "range",
                    vec![],
                    "choose heights on one side; make two surfaces for both".into(),
                ),
                QuadricError::Overflow { .. } => ("range", vec![], "choose a smaller part".into()),
            };
            self.refuse(o, (key, &path), &e, help)
        })
    }

    pub(crate) fn torus(&mut self, o: &Object) -> Built<Torus> {
        let f = &o.fields;
        let range = self.range(o, [true, true])?;
        let direction = f.vector("axis").unwrap_or(DVec3::Z);
        let frame = Frame::along(f.vector("center").unwrap_or(DVec3::ZERO), direction)
            .map_err(|e| self.refuse(o, ("axis", &[]), e, "give a direction that is not zero"))?;
        let mut options = TorusOptions {
            frame,
            ..TorusOptions::default()
        };
        for (to, given) in options.range.iter_mut().zip(range) {
            *to = given.unwrap_or(*to);
        }
        let [major, minor] = [need(f.number("major"))?, need(f.number("minor"))?];
        Torus::new(major, minor, options).map_err(|e| match &e {
            TorusError::Radius { name, .. } => {
                self.refuse(o, (name, &[]), &e, "write a number greater than 0")
            }
            TorusError::Range { parameter, .. } => {
                let help = "choose angles [from, to] that increase by at most one turn";
                self.refuse_range(o, *parameter, &e, help)
            }
            TorusError::CrossesAxis { .. }
                if f.record("range").is_some_and(|r| r.get("v").is_some()) =>
            {
                self.refuse_range(
                    o,
                    'v',
                    &e,
                    "choose a smaller range of v, or raise `major` to at least `minor`",
                )
            }
            TorusError::CrossesAxis { .. } => {
                let help =
                    "raise `major` to at least `minor`, or give such a range = { v = [from, to] }";
                self.refuse(o, ("major", &[]), &e, help)
            }
        })
    }

    /// The frame of a quadric: the directions x and z, or those of space.
    fn frame(&mut self, o: &Object, origin: DVec3) -> Built<Frame> {
        let record: Option<&Fields> = o.fields.record("frame");
        let (x, z) = record.map_or((None, None), |r| (r.vector("x"), r.vector("z")));
        let z = z.unwrap_or(DVec3::Z);
        let frame = match x {
            Some(x) => Frame::new(origin, z, x),
            None => Frame::along(origin, z),
        };
        frame.map_err(|e| {
            let key = if record.is_some() { "frame" } else { "center" };
            self.refuse(
                o,
                (key, &[]),
                e,
                "give z a length and let x point aside from it",
            )
        })
    }

    /// Refuses a range, at that of u or v where it is given.
    fn refuse_range(
        &mut self,
        o: &Object,
        parameter: char,
        message: impl std::fmt::Display,
        help: &str,
    ) -> Stop {
        let key = if parameter == 'u' { "u" } else { "v" };
        match o.fields.record("range").filter(|r| r.get(key).is_some()) {
            Some(range) => self.refuse_in(&o.label, range, (key, &[]), message, help),
            None => self.refuse(o, ("range", &[]), message, help),
        }
    }

    /// The ranges of u and v, which are angles or lengths as `angles` says.
    fn range(&mut self, o: &Object, angles: [bool; 2]) -> Built<[Option<[f64; 2]>; 2]> {
        let mut out = [None; 2];
        let Some(range) = o.fields.record("range") else {
            return Ok(out);
        };
        for ((key, angle), out) in ["u", "v"].into_iter().zip(angles).zip(&mut out) {
            let Some(list) = range.list(key) else {
                continue;
            };
            let wrong = |i: &&Item| matches!(i.datum, Datum::Angle(_)) != angle;
            if let Some(i) = list.iter().position(|i| wrong(&i)) {
                let (message, help) = if angle {
                    (
                        "is an angle and needs a unit",
                        "write it as [\"0deg\", \"90deg\"]",
                    )
                } else {
                    ("is a length, not an angle", "write it as [0, 10]")
                };
                let label = format!("{}, `range.{key}`", o.label);
                return Err(self.refuse_in(
                    &label,
                    range,
                    (key, &[i]),
                    format!("it {message}"),
                    help,
                ));
            }
            let numbers: Option<Vec<f64>> = list.iter().map(Item::number).collect();
            *out = numbers.and_then(|n| <[f64; 2]>::try_from(n).ok());
        }
        Ok(out)
    }
}

/// The control net of a NURBS surface by rows.
pub(crate) fn rows(s: &NurbsSurface) -> Vec<Vec<DVec3>> {
    s.control_points()
        .chunks(s.size()[1].max(1))
        .map(<[DVec3]>::to_vec)
        .collect()
}
