//! Blends.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::need;
use crate::data::{Datum, Item, Object};
use nappe::surface::{Blend, BlendError, BlendOptions, Side, SurfaceRef};
use std::sync::Arc;

impl Builder<'_> {
    pub(crate) fn blend_between(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        let sides = self.blended_sides(o)?;
        let order = |word: &str| match word {
            "G0" => 0,
            "G1" => 1,
            _ => 2,
        };
        let standard = BlendOptions::default();
        let continuity = match f.get("continuity").map(|i| &i.datum) {
            Some(Datum::Text(word)) => [order(word); 2],
            Some(Datum::List(l)) => {
                let words = l.iter().map(|i| match &i.datum {
                    Datum::Text(word) => Some(order(word)),
                    _ => None,
                });
                pair(words.collect())?
            }
            _ => standard.continuity,
        };
        let bulge = match f.number("bulge") {
            Some(x) => [x; 2],
            None if f.get("bulge").is_some() => pair(f.numbers("bulge"))?,
            None => standard.bulge,
        };
        let options = BlendOptions {
            continuity,
            bulge,
            reverse: f.get("reverse").map(|_| f.flag("reverse")),
            ..standard
        };
        let [first, second] = sides;
        let blend = Blend::new(first, second, &options).map_err(|e| self.blend_error(o, &e))?;
        Ok(Patch::one(Arc::new(blend)))
    }

    /// The two sides, both tried so that all faults are said.
    fn blended_sides(&mut self, o: &Object) -> Built<[(SurfaceRef, Side); 2]> {
        let items: Vec<Item> = need(o.fields.list("between"))?.to_vec();
        let label = format!("{}, `between`", o.label);
        let found: Vec<Built<(SurfaceRef, Side)>> = items
            .iter()
            .map(|i| match &i.datum {
                Datum::Side(s) => Ok((self.surface(&s.surface, &label, &i.span)?, s.side)),
                _ => Err(Stop::Reported),
            })
            .collect();
        pair(Some(found.into_iter().collect::<Built<Vec<_>>>()?))
    }

    fn blend_error(&mut self, o: &Object, e: &BlendError) -> Stop {
        let (key, path, help): (&str, Vec<usize>, &str) = match e {
            BlendError::Continuity { end, .. } => {
                ("continuity", vec![*end], "write \"G0\", \"G1\" or \"G2\"")
            }
            BlendError::Bulge { end, .. } => ("bulge", vec![*end], "write a number greater than 0"),
            BlendError::Range { end, .. } => ("bulge", vec![*end], "write a number near 1"),
            BlendError::NotFinite { end, .. } => (
                "between",
                vec![*end],
                "name a side with finite points and derivatives",
            ),
            BlendError::Same { .. } => ("between", vec![1], "name sides with room between them"),
            BlendError::Pole { end, .. } => (
                "between",
                vec![*end],
                "name another side, or write continuity = \"G0\" for it",
            ),
            BlendError::NoPlane { end, .. } => (
                "between",
                vec![*end],
                "keep away from that place, such as by a smaller range of the surface, or write continuity = \"G0\" for \
                 this side",
            ),
        };
        self.refuse(o, (key, &path), e, help)
    }
}

/// Two of what the reader has made sure are two.
fn pair<T>(list: Option<Vec<T>>) -> Built<[T; 2]> {
    need(list.and_then(|l| <[T; 2]>::try_from(l).ok()))
}
