//! Diagonal-key surfaces.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::need;
use crate::data::{Datum, Item, Object};
use nappe::DVec3;
use nappe::basis::FunctionsRef;
use nappe::curve::on_unit_domain;
use nappe::expr::Bound;
use nappe::surface::{Contour, DiagonalKey, DiagonalKeyError, DiagonalKeyOptions, Free, Side};
use std::sync::Arc;

impl Builder<'_> {
    pub(crate) fn diagonal_key(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let (surface, _) = self.diagonal_key_with_options(o)?;
        Ok(Patch::one(Arc::new(surface)))
    }

    /// The surface, and what it is made with beside its contour.
    pub(crate) fn diagonal_key_with_options(
        &mut self,
        o: &Object,
    ) -> Built<(DiagonalKey, DiagonalKeyOptions)> {
        let f = &o.fields;
        let boundary = self.boundary(o);
        let exchange = f.text("generators") == Some("west-east");
        let across = [
            ["tangent_west", "tangent_east"],
            ["tangent_south", "tangent_north"],
        ];
        let [guides, generators] = if exchange {
            [across[1], across[0]]
        } else {
            across
        };
        if let Some(key) = generators.into_iter().find(|k| f.get(k).is_some()) {
            let message = format!(
                "`{key}` is on a generator; only the tangents along the guides can be prescribed"
            );
            let help = format!(
                "write `{}` or `{}`, or change `generators`",
                guides[0], guides[1]
            );
            return Err(self.refuse(o, (key, &[]), message, help));
        }
        let tangents = guides.map(|k| self.tangent(o, k));
        let free = self.free(o);
        let [south, north, west, east] = boundary?.map(on_unit_domain);
        let [first, second] = tangents;
        let options = DiagonalKeyOptions {
            exchange,
            plane_axes: pair(f.list("plane_axes")),
            free: free?,
            tangents: [first?, second?],
            blend: None,
        };
        let contour =
            Contour::new(south, north, west, east).map_err(|e| self.contour_error(o, &e))?;
        let surface =
            DiagonalKey::new(contour, &options).map_err(|e| self.diagonal_key_error(o, &e))?;
        Ok((surface, options))
    }

    /// The free functions: p and q in the plane, or two vectors in space.
    fn free(&mut self, o: &Object) -> Built<Free> {
        let f = &o.fields;
        let plane = ["p", "q"].iter().any(|k| f.get(k).is_some());
        if f.get("normals").is_some() && f.get("free").is_none() {
            let message = "`normals` are for the free functions of space, and no `free` is given";
            return Err(self.refuse(o, ("normals", &[]), message, "give free, or remove normals"));
        }
        match f.list("free").map(<[Item]>::to_vec) {
            Some(_) if plane => {
                let message =
                    "`free` is for space, `p` and `q` are for generators in parallel planes";
                Err(self.refuse(o, ("free", &[]), message, "give p and q, or free"))
            }
            Some(vectors) => {
                let mut g: Vec<FunctionsRef> = Vec::new();
                for vector in &vectors {
                    let formulas: Option<Vec<Bound>> =
                        vector.list().and_then(|l| l.iter().map(formula).collect());
                    g.push(Arc::new(self.functions(
                        &o.label,
                        f,
                        &["free"],
                        need(formulas)?,
                    )?));
                }
                let g = need(<[FunctionsRef; 2]>::try_from(g).ok())?;
                Ok(Free::Space {
                    g,
                    normals: pair(f.list("normals")),
                })
            }
            None if plane => {
                let zero = Bound::constant(0.0, "v");
                let mut one = |key: &str| -> Built<FunctionsRef> {
                    let b = f.get(key).and_then(formula).unwrap_or_else(|| zero.clone());
                    Ok(Arc::new(self.functions(
                        &o.label,
                        f,
                        &[key, key],
                        vec![b],
                    )?))
                };
                Ok(Free::Plane {
                    p: one("p")?,
                    q: one("q")?,
                })
            }
            None => Ok(Free::None),
        }
    }

    fn diagonal_key_error(&mut self, o: &Object, e: &DiagonalKeyError) -> Stop {
        let f = &o.fields;
        let given = |keys: &[&'static str]| {
            keys.iter()
                .copied()
                .find(|k| f.get(k).is_some())
                .unwrap_or("")
        };
        let named = |name: &str| match name {
            "p" => "p",
            "q" => "q",
            "g1" | "g2" => "free",
            "south" => given(&["tangent_south", "south"]),
            "north" => given(&["tangent_north", "north"]),
            "west" => given(&["tangent_west", "west"]),
            "east" => given(&["tangent_east", "east"]),
            _ => "",
        };
        let (key, help) = match e {
            DiagonalKeyError::Contour(e) => return self.contour_error(o, e),
            DiagonalKeyError::Parallelogram { .. } => (
                "",
                "write kind = \"coons\" for this contour, or move a corner so that d11 is not 0",
            ),
            DiagonalKeyError::NoDirection { .. } | DiagonalKeyError::Direction { .. } => (
                given(&["east", "west"]),
                "change a guide, or write kind = \"coons\"",
            ),
            DiagonalKeyError::NotPlane { .. } => (
                given(&["p", "q", "plane_axes"]),
                "write free = [g1, g2] instead of p and q",
            ),
            DiagonalKeyError::AxesNeeded { .. } => {
                (given(&["p", "q"]), "write plane_axes = [e1, e2]")
            }
            DiagonalKeyError::Axes { .. } => {
                ("plane_axes", "give two directions that are not parallel")
            }
            DiagonalKeyError::Normals { .. } => {
                ("normals", "give two directions square to d11, or none")
            }
            DiagonalKeyError::FunctionEnd { name, .. } => {
                (named(name), "multiply the function by v*(1 - v)")
            }
            DiagonalKeyError::FunctionCount { name, .. }
            | DiagonalKeyError::FunctionDomain { name, .. }
            | DiagonalKeyError::FunctionNotFinite { name, .. } => {
                (named(name), "give functions that are finite on [0, 1]")
            }
            DiagonalKeyError::Tangent { side, .. } => {
                let key = match side {
                    Side::South => "tangent_south",
                    Side::North => "tangent_north",
                    Side::West => "tangent_west",
                    Side::East => "tangent_east",
                };
                (
                    key,
                    "let the tangent begin and end with the derivatives of the generators",
                )
            }
            DiagonalKeyError::Singular { .. } => (
                given(&[
                    "tangent_east",
                    "tangent_west",
                    "tangent_north",
                    "tangent_south",
                ]),
                "prescribe one side only, or write kind = \"coons\"",
            ),
            DiagonalKeyError::FreeAndTangents => (
                given(&["p", "q", "free"]),
                "remove the free functions or the tangents",
            ),
        };
        self.refuse(o, (key, &[]), e, help)
    }
}

fn formula(item: &Item) -> Option<Bound> {
    match &item.datum {
        Datum::Formula(b) => Some(b.clone()),
        _ => None,
    }
}

fn pair(list: Option<&[Item]>) -> Option<[DVec3; 2]> {
    let vectors: Option<Vec<DVec3>> = list?.iter().map(Item::vector).collect();
    <[DVec3; 2]>::try_from(vectors?).ok()
}
