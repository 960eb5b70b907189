//! The velocities of surfaces.

use super::curves::{axis_rate, number, vector};
use super::slide::{Moved, together};
use super::still::{self};
use super::{Mover, Pair};
use crate::build::Patch;
use crate::curves::clamped_uniform;
use crate::data::{Datum, Fields, Item};
use crate::surfaces::square;
use nappe::basis::ExpressionFunctions;
use nappe::curve::CurveRef;
use nappe::exact::{NurbsError, NurbsSurface};
use nappe::surface::{
    Coons, CoonsOptions, Cross, Dir, HermiteData, IncompatibleTwists, QuadricShape, Side,
    SurfaceRef, bilinear, hermite, rational, ruled,
};
use nappe::velocity::{
    FrameRate, Net, QuadricRate, Sum, Term, TurnRate, continuation, quadric, revolution, torus,
};
use nappe::{DMat3, DVec3};
use std::sync::Arc;

/// The velocities of an object's patches, in their order.
type Motions = Result<Vec<Option<Moved<SurfaceRef>>>, String>;

fn one(surface: SurfaceRef) -> Vec<Option<Moved<SurfaceRef>>> {
    vec![Some(Moved::new(surface))]
}

impl Mover<'_, '_> {
    /// The velocities of an object's patches, from those of its parts.
    pub(super) fn moved_surface(&mut self, pair: Pair<'_>, patches: &[Patch]) -> Motions {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        if self.parts_stay(f)? && still::fields(r) {
            return Ok(vec![None; patches.len()]);
        }
        let Some(at) = patches.first().map(|p| &p.surface) else {
            return Ok(Vec::new());
        };
        let fault = |e: &dyn std::fmt::Display| pair.unknown(format!("its velocity: {e}"));
        let missing = |_| pair.unknown("its data are missing");
        let table = |key: &str| square(pair.rate, key).map_err(missing);
        Ok(match pair.at.kind.name {
            "bilinear" => one(Arc::new(
                bilinear(table("corners")?).map_err(|e| fault(&e))?,
            )),
            "hermite" => {
                let twists = match r.get("twists") {
                    Some(_) => table("twists")?,
                    None => Default::default(),
                };
                let data = HermiteData {
                    corners: table("corners")?,
                    tangents_u: table("tangents_u")?,
                    tangents_v: table("tangents_v")?,
                    twists,
                };
                one(Arc::new(hermite(&data).map_err(|e| fault(&e))?))
            }
            "ruled" => {
                let (keys, along) = match f.get("south") {
                    Some(_) => (["south", "north"], Dir::U),
                    None => (["west", "east"], Dir::V),
                };
                let rails = [self.key(pair, keys[0])?, self.key(pair, keys[1])?];
                let ([first, second], slide) = together(rails)?;
                let made = Arc::new(ruled(first, second, along).map_err(|e| fault(&e))?);
                vec![Some(Moved::surface(made, along, slide))]
            }
            "bezier" | "nurbs" | "biquadratic" | "rational" => one(self.moved_net(pair, at)?),
            "revolution" => vec![Some(self.moved_revolution(pair)?)],
            "torus" => {
                if !pair.stays("range") {
                    return Err(pair.unknown(RANGE));
                }
                let axis = [f, r].map(|f| f.get("axis"));
                let axis = match axis {
                    [Some(at), Some(_)] => [at.vector().unwrap_or(DVec3::Z), vector(r, "axis")],
                    _ => [DVec3::Z, DVec3::ZERO],
                };
                let frame = FrameRate::new(vector(r, "center"), axis, None);
                let frame = frame.ok_or_else(|| pair.unknown(JUMPS))?;
                let own = self.builder.torus(pair.at).map_err(missing)?;
                let radii = [number(r, "major"), number(r, "minor")];
                one(torus(&own, &frame, radii).map_err(|e| fault(&e))?)
            }
            "quadric" => one(self.moved_quadric(pair)?),
            "coons" => one(self.moved_coons(pair)?),
            "diagonal-key" => one(self.moved_diagonal_key(pair)?),
            "transform" => self.moved_images(pair)?,
            "join" => {
                let items = f.list("surfaces").unwrap_or_default();
                let mut moved = Vec::with_capacity(patches.len());
                for item in items {
                    let Datum::Text(name) = &item.datum else {
                        continue;
                    };
                    if name.contains('/') {
                        moved.push(self.surface(name)?);
                    } else {
                        moved.extend(self.patches(name)?.iter().cloned());
                    }
                }
                moved
            }
            _ => return Err(pair.unknown_kind()),
        })
    }

    /// A surface that is linear in its net, but for weights.
    fn moved_net(&mut self, pair: Pair<'_>, at: &SurfaceRef) -> Result<SurfaceRef, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let (Some(rows), Some(rates)) = (f.vector_rows("points"), r.vector_rows("points")) else {
            return Err(pair.unknown("it has no points"));
        };
        let columns = rows.first().map_or(0, Vec::len);
        let flat = |rows: &[Vec<DVec3>]| rows.concat();
        let (points, rates) = (flat(&rows), flat(&rates));
        let weights = match pair.at.kind.name {
            "biquadratic" => {
                let at = |key: &str| [f.number(key).unwrap_or(1.0), number(r, key)];
                let [[u, du], [v, dv]] = [at("weight_u"), at("weight_v")];
                let ([us, dus], [vs, dvs]) = (
                    [[1.0, u, 1.0], [0.0, du, 0.0]],
                    [[1.0, v, 1.0], [0.0, dv, 0.0]],
                );
                let each = |w: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
                    (0..9).map(|k| w(k / 3, k % 3)).collect()
                };
                let at = each(&|i, j| us[i] * vs[j]);
                let rate = each(&|i, j| dus[i] * vs[j] + us[i] * dvs[j]);
                Some([at, rate])
            }
            _ => match [f, r].map(|f| f.number_rows("weights")) {
                [Some(at), Some(rate)] => Some([at.concat(), rate.concat()]),
                _ => None,
            },
        };
        let net = Net {
            points: &points,
            rates: &rates,
            weights: weights.as_ref().map(|w| w.each_ref().map(Vec::as_slice)),
        };
        let w = weights.as_ref().map(|w| w[0].as_slice());
        let fault = |e: &dyn std::fmt::Display| pair.unknown(format!("its velocity: {e}"));
        if pair.at.kind.name == "rational" {
            if !pair.stays("basis_u") || !pair.stays("basis_v") {
                return Err(pair.unknown("its basis functions change"));
            }
            let basis = ["basis_u", "basis_v"].map(|key| {
                let items = f.list(key).unwrap_or_default().iter();
                let formulas = items.filter_map(|i: &Item| match &i.datum {
                    Datum::Formula(b) => Some(b.clone()),
                    _ => None,
                });
                ExpressionFunctions::new(formulas, [0.0, 1.0])
            });
            let [u, v] = basis.map(|b| b.map(Arc::new));
            let (u, v) = (u.map_err(|e| fault(&e))?, v.map_err(|e| fault(&e))?);
            let make = |p: &[DVec3]| {
                let made = rational(u.clone(), v.clone(), p, w)?;
                Ok(Arc::new(made) as SurfaceRef)
            };
            return net
                .surface(at, make)
                .map_err(|e: nappe::surface::RationalError| fault(&e));
        }
        if !pair.stays("knots_u") || !pair.stays("knots_v") {
            return Err(pair.unknown("its knots change"));
        }
        let make = |p: &[DVec3]| {
            let made = match f.numbers("degree").as_deref() {
                Some([du, dv]) => {
                    let (du, dv) = (*du as usize, *dv as usize);
                    let knots = [("knots_u", rows.len(), du), ("knots_v", columns, dv)];
                    let knots = knots.map(|(key, count, degree)| {
                        f.numbers(key)
                            .unwrap_or_else(|| clamped_uniform(count, degree))
                    });
                    NurbsSurface::new([du, dv], knots, p, w)?
                }
                _ => NurbsSurface::bezier(rows.len(), p, w)?,
            };
            Ok(Arc::new(made) as SurfaceRef)
        };
        net.surface(at, make).map_err(|e: NurbsError| fault(&e))
    }

    fn moved_revolution(&mut self, pair: Pair<'_>) -> Result<Moved<SurfaceRef>, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let own = self.builder.revolution(pair.at);
        let own = own.map_err(|_| pair.unknown("its data are missing"))?;
        let (_, profile) = self.key(pair, "profile")?;
        let slide = profile.as_ref().and_then(|m| m.slide().cloned());
        let rate = TurnRate {
            profile: profile.map(|m| m.velocity),
            axis: axis_rate([f, r], "axis"),
            start: number(r, "start"),
            angle: number(r, "angle"),
        };
        let moved = revolution(&own, &rate).ok_or_else(|| {
            pair.unknown(if f.get("section").is_some() {
                "how sections by a conic change is not known"
            } else {
                "how rational arcs change with their angle is not known: use construction = \"angle\""
            })
        })?;
        // The profile is along u.
        Ok(Moved::surface(moved, Dir::U, slide))
    }

    fn moved_quadric(&mut self, pair: Pair<'_>) -> Result<SurfaceRef, String> {
        use QuadricShape::*;
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let own = self.builder.quadric(pair.at);
        let own = own.map_err(|_| pair.unknown("its data are missing"))?;
        let rates = r.numbers("semi_axes").unwrap_or_default();
        let rate = |k: usize| rates.get(k).copied().unwrap_or(0.0);
        let semi_axes = match own.shape() {
            Sphere => [rate(0); 3],
            Cylinder if rates.len() == 1 => [rate(0), rate(0), 0.0],
            Cylinder | HyperbolicCylinder => [rate(0), rate(1), 0.0],
            ParabolicCylinder => [rate(0), 0.0, rate(1)],
            _ => [rate(0), rate(1), rate(2)],
        };
        let direction = |key: &str| {
            let at = f.record("frame")?.get(key)?.vector()?;
            Some([at, vector(r.record("frame")?, key)])
        };
        let z = direction("z").unwrap_or([DVec3::Z, DVec3::ZERO]);
        let frame = FrameRate::new(vector(r, "center"), z, direction("x"));
        // A range that is not given is so many times a semi-axis.
        let default = match own.shape() {
            Ellipsoid | Sphere => [None, None],
            Hyperboloid1 | Hyperboloid2 | EllipticParaboloid | Cone => [None, Some(2)],
            HyperbolicParaboloid => [Some(0), Some(1)],
            Cylinder => [None, Some(0)],
            ParabolicCylinder => [Some(0), Some(0)],
            HyperbolicCylinder => [Some(1), Some(0)],
        };
        let mut range = [[0.0; 2]; 2];
        for (k, key) in ["u", "v"].into_iter().enumerate() {
            let given = r.record("range").and_then(|range| range.numbers(key));
            range[k] = match (given.as_deref(), default[k]) {
                (Some(&[from, to]), _) => [from, to],
                (_, Some(axis)) => {
                    let growth = semi_axes[axis] / own.semi_axes()[axis];
                    own.range()[k].map(|x| x * growth)
                }
                _ => [0.0; 2],
            };
        }
        let rate = QuadricRate {
            frame: frame.ok_or_else(|| pair.unknown(JUMPS))?,
            semi_axes,
            range,
        };
        quadric(&own, &rate).map_err(|dir| pair.unknown(format!("{RANGE} (of {dir})")))
    }

    fn moved_images(&mut self, pair: Pair<'_>) -> Motions {
        let name = pair
            .at
            .fields
            .text("surface")
            .unwrap_or_default()
            .to_owned();
        let [map, rate] = self.map(pair)?;
        let sources = if name.contains('/') {
            let label = pair.at.label.clone();
            let span = pair.at.fields.place("surface", &[]);
            let surface = self.builder.surface(&name, &label, &span);
            let surface = surface.map_err(|_| pair.unknown("its surface is not built"))?;
            vec![(surface, self.surface(&name)?)]
        } else {
            let moved = self.patches(&name)?;
            let own = self.surfaces.get(&name).map(|s| s.1.clone());
            let own = own.unwrap_or_default();
            let own = own.iter().map(|p| p.surface.clone());
            own.zip(moved.iter().cloned()).collect()
        };
        let image = |(source, moved): (SurfaceRef, Option<Moved<SurfaceRef>>)| {
            let from = source.point(source.domain().map(|d| d.lo));
            if rate.matrix3 == DMat3::ZERO && rate.translation == DVec3::ZERO && moved.is_none() {
                return None;
            }
            let mut terms = vec![Term::image(source, rate.matrix3, from)];
            let slides = moved.as_ref().map(|m| m.slides.clone());
            terms.extend(moved.map(|m| Term::image(m.velocity, map.matrix3, DVec3::ZERO)));
            Some(Moved {
                velocity: Arc::new(Sum::new(rate.transform_point3(from), terms)) as SurfaceRef,
                slides: slides.unwrap_or_default(),
            })
        };
        Ok(sources.into_iter().map(image).collect())
    }

    /// A Coons surface is linear in its curves and twists.
    fn moved_coons(&mut self, pair: Pair<'_>) -> Result<SurfaceRef, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        if !pair.stays("blend") {
            return Err(pair.unknown("its blending functions change"));
        }
        let missing = |_| pair.unknown("its data are missing");
        let blend = self.builder.blend(pair.at).map_err(missing)?;
        let (given, estimate) = self.builder.cross(pair.at).map_err(missing)?;
        let mut cross: [Cross; 4] = Default::default();
        let (mut own, mut sides): (Vec<CurveRef>, Vec<CurveRef>) = Default::default();
        for side in Side::ALL {
            own.push(self.key(pair, side.name())?.0);
            sides.push(self.velocity_of(pair, side.name())?);
        }
        let [own, rates] = [&own, &sides].map(|s| [0, 1, 2, 3].map(|k: usize| s[k].clone()));
        for ((to, given), side) in cross.iter_mut().zip(&given).zip(Side::ALL) {
            let records = [f, r].map(|f| f.record("cross"));
            let [Some(at), Some(rate)] = records.map(|c: Option<&Fields>| c?.get(side.name()))
            else {
                continue;
            };
            *to = Cross::Curve(match given {
                Cross::Estimated => continue,
                Cross::Curve(_) => self.cross_rate(at, rate, &pair.at.label)?,
                Cross::Neighbour {
                    surface,
                    side: other,
                } => {
                    if blend.order() > 1 {
                        return Err(pair.unknown(
                            "how the second derivatives that it takes from a neighbour change is not known",
                        ));
                    }
                    let velocity = match self.taken_from(at)? {
                        Some(moved) => moved.fixed()?,
                        None => Arc::new(Sum::still([Dir::U, Dir::V].map(|d| surface.breaks(d)))),
                    };
                    let both = [surface, &velocity];
                    continuation([&own, &rates], side, both, *other).ok_or_else(|| {
                        pair.unknown("its neighbour has no tangent plane in a corner")
                    })?
                }
            });
        }
        let given = self.builder.second(pair.at).map_err(missing)?;
        let mut second: [Option<CurveRef>; 4] = Default::default();
        for ((to, given), side) in second.iter_mut().zip(&given).zip(Side::ALL) {
            if given.is_none() {
                continue;
            }
            let records = [f, r].map(|f| f.record("second"));
            let [Some(at), Some(rate)] = records.map(|c: Option<&Fields>| c?.get(side.name()))
            else {
                return Err(pair.unknown("its data are missing"));
            };
            let (curve, moved) = self.item(at, rate, &pair.at.label)?;
            let velocity = moved.map(Moved::fixed).transpose()?;
            let still = || nappe::velocity::still_curve(curve.breaks());
            *to = Some(velocity.unwrap_or_else(still));
        }
        let twists = match r.get("twists") {
            Some(_) => Some(square(pair.rate, "twists").map_err(missing)?),
            None => None,
        };
        let options = CoonsOptions {
            blend,
            cross,
            second,
            estimate,
            twists,
            incompatible_twists: match f.text("incompatible_twists") {
                Some("gregory") => IncompatibleTwists::Gregory,
                Some("average") => IncompatibleTwists::Average,
                _ => IncompatibleTwists::Error,
            },
            ..CoonsOptions::default()
        };
        let [south, north, west, east] = rates;
        let made = Coons::new(south, north, west, east, &options);
        Ok(Arc::new(made.map_err(|e| {
            pair.unknown(format!("the velocities of its boundary: {e}"))
        })?))
    }
}

const RANGE: &str = "how its rational arcs change with their range is not known";
const JUMPS: &str = "its x direction jumps as its axis turns: give a frame with x";
