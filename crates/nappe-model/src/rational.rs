//! Rational surfaces on a user's basis.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::need;
use crate::data::{Datum, Object};
use nappe::DVec3;
use nappe::basis::FunctionsRef;
use nappe::expr::Bound;
use nappe::surface::{RationalError, rational};
use std::sync::Arc;

impl Builder<'_> {
    pub(crate) fn rational(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let rows = need(o.fields.vector_rows("points"))?;
        let columns = rows.first().map_or(0, Vec::len);
        let basis = [
            self.basis(o, "basis_u", rows.len(), "rows"),
            self.basis(o, "basis_v", columns, "columns"),
        ];
        let weights = self.weights(o, rows.len(), columns);
        let [basis_u, basis_v] = basis;
        let points: Vec<DVec3> = rows.iter().flatten().copied().collect();
        let surface = rational(basis_u?, basis_v?, &points, weights?.as_deref()).map_err(|e| match &e {
            RationalError::Net(e) => self.net_error(o, e, columns),
            RationalError::NotPositive { .. } | RationalError::Unproven { .. } => {
                let help = "use a basis whose functions are not negative and sum to 1, or larger weights there";
                self.refuse(o, ("basis_u", &[]), &e, help)
            }
        })?;
        Ok(vec![Patch {
            suffix: None,
            surface: Arc::new(surface),
            net: Some(rows),
            fillet: None,
        }])
    }

    /// A basis of as many functions as the net has rows or columns.
    fn basis(&mut self, o: &Object, key: &str, count: usize, what: &str) -> Built<FunctionsRef> {
        let items = need(o.fields.list(key))?;
        let formulas: Option<Vec<Bound>> = items
            .iter()
            .map(|i| match &i.datum {
                Datum::Formula(b) => Some(b.clone()),
                _ => None,
            })
            .collect();
        let formulas = need(formulas)?;
        if formulas.len() != count {
            let message = format!(
                "`{key}` has {} functions, but the net has {count} {what}",
                formulas.len()
            );
            let help = format!("give one function for each of the {what}");
            return Err::<_, Stop>(self.refuse(o, (key, &[]), message, help));
        }
        Ok(Arc::new(self.functions(
            &o.label,
            &o.fields,
            &[key],
            formulas,
        )?))
    }
}
