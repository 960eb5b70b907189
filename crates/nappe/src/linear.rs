//! Small and banded systems of linear equations.

/// A square matrix whose entries are zero beyond a distance from the diagonal, factored without exchange of rows: for
/// the totally positive matrices of spline interpolation that is stable. Source: de Boor, *A Practical Guide to
/// Splines*, chapter XIII.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    size: usize,
    band: usize,
    /// Row-major, `2 * band + 1` entries a row, the diagonal in the middle.
    entries: Vec<f64>,
}

impl Banded {
    pub(crate) fn new(size: usize, band: usize) -> Self {
        Self {
            size,
            band,
            entries: vec![0.0; size * (2 * band + 1)],
        }
    }

    fn at(&self, i: usize, j: usize) -> usize {
        i * (2 * self.band + 1) + j + self.band - i
    }

    /// Adds to an entry within the band.
    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        let k = self.at(i, j);
        self.entries[k] += value;
    }

    /// Replaces the matrix by its factors. False if a pivot is not a number other than zero.
    pub(crate) fn factor(&mut self) -> bool {
        for k in 0..self.size {
            let pivot = self.entries[self.at(k, k)];
            if pivot == 0.0 || !pivot.is_finite() {
                return false;
            }
            let end = (k + self.band + 1).min(self.size);
            for i in k + 1..end {
                let ik = self.at(i, k);
                let f = self.entries[ik] / pivot;
                self.entries[ik] = f;
                for j in k + 1..end {
                    let (ij, kj) = (self.at(i, j), self.at(k, j));
                    self.entries[ij] -= f * self.entries[kj];
                }
            }
        }
        true
    }

    /// Solves with the factors; `x` holds the right-hand side and becomes the solution.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for i in 0..self.size {
            for j in i.saturating_sub(self.band)..i {
                x[i] -= self.entries[self.at(i, j)] * x[j];
            }
        }
        for i in (0..self.size).rev() {
            for j in i + 1..(i + self.band + 1).min(self.size) {
                x[i] -= self.entries[self.at(i, j)] * x[j];
            }
            x[i] /= self.entries[self.at(i, i)];
        }
    }
}

/// Solves a small dense system (row-major) for several right-hand sides by elimination with exchange of rows. False
/// if the matrix is singular.
pub(crate) fn solve_dense(size: usize, a: &mut [f64], sides: &mut [Vec<f64>]) -> bool {
    for k in 0..size {
        let best = (k..size).max_by(|&i, &j| {
            let (x, y) = (a[i * size + k].abs(), a[j * size + k].abs());
            x.total_cmp(&y)
        });
        let r = best.unwrap_or(k);
        let pivot = a[r * size + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        for j in 0..size {
            a.swap(k * size + j, r * size + j);
        }
        sides.iter_mut().for_each(|s| s.swap(k, r));
        for i in k + 1..size {
            let f = a[i * size + k] / a[k * size + k];
            for j in k..size {
                a[i * size + j] -= f * a[k * size + j];
            }
            sides.iter_mut().for_each(|s| s[i] -= f * s[k]);
        }
    }
    for s in sides {
        for i in (0..size).rev() {
            let sum = (i + 1..size).fold(s[i], |x, j| x - a[i * size + j] * s[j]);
            s[i] = sum / a[i * size + i];
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_their_equations() {
        let (n, band) = (7, 2);
        let entry = |i: usize, j: usize| {
            if i.abs_diff(j) > band {
                0.0
            } else {
                1.0 / (1.0 + i as f64 + 2.0 * j as f64) + if i == j { 1.0 } else { 0.0 }
            }
        };
        let mut m = Banded::new(n, band);
        let mut dense = Vec::new();
        for i in 0..n {
            for j in 0..n {
                dense.push(entry(i, j));
                if i.abs_diff(j) <= band {
                    m.add(i, j, entry(i, j));
                }
            }
        }
        let want: Vec<f64> = (0..n).map(|i| (i as f64).sin() + 2.0).collect();
        let side: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|j| entry(i, j) * want[j]).sum())
            .collect();
        let mut x = side.clone();
        assert!(m.factor());
        m.solve(&mut x);
        let mut sides = [side];
        assert!(solve_dense(n, &mut dense, &mut sides));
        for i in 0..n {
            assert!((x[i] - want[i]).abs() < 1e-14 && (sides[0][i] - want[i]).abs() < 1e-14);
        }
        assert!(!solve_dense(2, &mut [1.0, 2.0, 2.0, 4.0], &mut []));
        assert!(!Banded::new(2, 1).factor());
    }
}
