//! Fillets.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::need;
use crate::data::{Datum, Item, Object};
use nappe::surface::{Fillet, FilletError, FilletOptions, Radius, SurfaceRef};
use std::sync::Arc;

impl Builder<'_> {
    pub(crate) fn fillet(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        let radius = self.radius(o);
        let supports = self.two_surfaces(o, "between");
        let options = FilletOptions {
            side: f.list("side").and_then(|l| match l {
                [a, b] => Some([a, b].map(|i| matches!(&i.datum, Datum::Text(t) if t == "front"))),
                _ => None,
            }),
            other_line: f.flag("other_line"),
            range: f
                .numbers("range")
                .and_then(|r| <[f64; 2]>::try_from(r).ok()),
            near: f.vector("near"),
        };
        let ([first, second], radius) = (supports?, radius?);
        let fillet =
            Fillet::new(&first, &second, radius, options).map_err(|e| self.fillet_error(o, &e))?;
        let fillet = Arc::new(fillet);
        let mut patches = Patch::one(fillet.clone());
        patches[0].fillet = Some(fillet);
        Ok(patches)
    }

    /// The two surfaces that a key names, both tried so that all faults are said.
    pub(crate) fn two_surfaces(&mut self, o: &Object, key: &str) -> Built<[SurfaceRef; 2]> {
        let items: Vec<Item> = need(o.fields.list(key))?.to_vec();
        let label = format!("{}, `{key}`", o.label);
        let found: Vec<Built<SurfaceRef>> = items
            .iter()
            .map(|i| match &i.datum {
                Datum::Text(name) => self.surface(name, &label, &i.span),
                _ => Err(Stop::Reported),
            })
            .collect();
        let found = found.into_iter().collect::<Built<Vec<_>>>()?;
        need(<[SurfaceRef; 2]>::try_from(found).ok())
    }

    /// A number, or a function of u.
    fn radius(&mut self, o: &Object) -> Built<Radius> {
        let Some(Datum::Formula(b)) = o.fields.get("radius").map(|i| &i.datum) else {
            return Err(Stop::Reported);
        };
        if b.is_constant() {
            let value = b.value(&[0.0]).map_err(|e| {
                let help = e.help();
                self.refuse(o, ("radius", &[]), e, help)
            })?;
            return Ok(Radius::Constant(value));
        }
        let functions =
            self.functions(&o.label, &o.fields, &["radius", "radius"], vec![b.clone()])?;
        Ok(Radius::Along(Arc::new(functions)))
    }

    fn fillet_error(&mut self, o: &Object, e: &FilletError) -> Stop {
        let (key, path, help): (&str, Vec<usize>, &str) = match e {
            FilletError::NoBall { fits: None, .. } => (
                "between",
                vec![],
                "write other sides, side = [\"front\" or \"back\", …], or extend the surfaces",
            ),
            FilletError::NoBall { .. } => (
                "radius",
                vec![],
                "write a radius for which the ball touches both, or other sides",
            ),
            FilletError::Several { .. } => (
                "between",
                vec![],
                "write near = [x, y, z], a point near the fillet that is meant",
            ),
            FilletError::CutsIn { .. } => ("radius", vec![], "lower the radius"),
            FilletError::CutsThrough { index, .. } => (
                "between",
                vec![*index],
                "take only the part of the surface beside the fillet, or lower the radius",
            ),
            FilletError::Lost { .. } | FilletError::Unproven { .. } | FilletError::Guide(_) => (
                "between",
                vec![],
                "take parts of the surfaces without that place, or another radius",
            ),
            FilletError::Leaves { index, .. } => (
                "between",
                vec![*index],
                "make the surface larger there, or write another radius",
            ),
            FilletError::Unclosed { .. } => (
                "radius",
                vec![],
                "write a function of u with period 1, such as 1 + 0.1*sin(2*pi*u)",
            ),
            FilletError::Near { .. } => ("near", vec![], "write three finite numbers"),
            FilletError::Crease { index, .. } => (
                "between",
                vec![*index],
                "make the fillet on each side of the crease",
            ),
            FilletError::RangeOfTraced => ("range", vec![], "leave `range` out"),
            FilletError::Parallel { .. } => {
                ("between", vec![], "name planes that meet at an angle")
            }
            FilletError::Radius { .. } | FilletError::RadiusFunction { .. } => (
                "radius",
                vec![],
                "write a radius greater than 0 for every u from 0 to 1",
            ),
            FilletError::TooLarge { .. } => {
                ("radius", vec![], "lower the radius, or extend the surfaces")
            }
            FilletError::TooSmall { .. } => (
                "radius",
                vec![],
                "raise the radius, or bring the surfaces together",
            ),
            FilletError::Side { index } if o.fields.get("side").is_some() => {
                ("side", vec![*index], "write the other of front and back")
            }
            FilletError::Side { index } => (
                "between",
                vec![*index],
                "write side = [\"front\" or \"back\", …]",
            ),
            FilletError::NoContact { .. } => (
                "between",
                vec![],
                "choose other sides, or bring the surfaces together",
            ),
            FilletError::Apart { .. } => (
                "between",
                vec![],
                "let both surfaces reach a common part of their edge",
            ),
            FilletError::Range { .. } => ("range", vec![], "write [from, to] with from < to"),
            FilletError::Swallowed { .. } | FilletError::SectionsCross { .. } => (
                "radius",
                vec![],
                "let the radius change more slowly, or make it smaller",
            ),
        };
        self.refuse(o, (key, &path), e, help)
    }
}
