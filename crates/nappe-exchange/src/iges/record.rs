//! Parameters of entities, and reading them one by one.

use crate::read::Fault;
use glam::DVec3;

/// One parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Param {
    /// Left out: its default.
    Default,
    /// A number.
    Number(f64),
    /// A string, or what is neither.
    Text(String),
}

/// The parameters up to the end of the record, and whether that was found.
pub(super) fn params(text: &[u8], [next, end]: [u8; 2]) -> Result<(Vec<Param>, bool), Fault> {
    let mut list = Vec::new();
    let mut at = 0;
    loop {
        while text.get(at).is_some_and(|b| b.is_ascii_whitespace()) {
            at += 1;
        }
        let digits = text[at..].iter().take_while(|b| b.is_ascii_digit()).count();
        let param = if digits > 0 && text.get(at + digits) == Some(&b'H') {
            let count = String::from_utf8_lossy(&text[at..at + digits]);
            let from = at + digits + 1;
            let count = count.parse::<usize>().ok();
            let to = count.and_then(|n| from.checked_add(n));
            let string = to.and_then(|to| text.get(from..to));
            let Some(string) = string else {
                return Err(Fault::whole("a string is longer than what follows it"));
            };
            at = from + string.len();
            let param = Param::Text(String::from_utf8_lossy(string).into_owned());
            // Blanks until the delimiter.
            while text.get(at).is_some_and(|b| *b != next && *b != end) {
                at += 1;
            }
            param
        } else {
            let rest = &text[at..];
            let length = rest.iter().position(|b| *b == next || *b == end);
            let word = &rest[..length.unwrap_or(rest.len())];
            at += word.len();
            parse(word)
        };
        list.push(param);
        match text.get(at) {
            Some(b) if *b == end => return Ok((list, true)),
            Some(_) => at += 1,
            None => return Ok((list, false)),
        }
    }
}

/// A number with any blanks inside (lines end anywhere), and an exponent with E or D.
fn parse(word: &[u8]) -> Param {
    let text: String = word
        .iter()
        .filter(|b| !b.is_ascii_whitespace())
        .map(|b| match b {
            b'D' | b'd' => 'E',
            b => char::from(*b),
        })
        .collect();
    if text.is_empty() {
        return Param::Default;
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Param::Number(x),
        _ => Param::Text(text),
    }
}

/// Why something cannot be taken over.
pub(super) type Got<T> = Result<T, String>;

/// An entity's parameters, read one after the other.
#[derive(Clone, Debug)]
pub(super) struct Record {
    params: Vec<Param>,
    at: usize,
}

impl Record {
    /// Its number is passed over.
    pub(super) fn new(params: Vec<Param>) -> Record {
        Record { params, at: 1 }
    }

    fn next(&mut self) -> &Param {
        self.at += 1;
        self.params.get(self.at - 1).unwrap_or(&Param::Default)
    }

    /// How many are left.
    pub(super) fn left(&self) -> usize {
        self.params.len().saturating_sub(self.at)
    }

    pub(super) fn real(&mut self) -> Got<f64> {
        self.real_or(0.0)
    }

    pub(super) fn real_or(&mut self, default: f64) -> Got<f64> {
        let at = self.at;
        match self.next() {
            Param::Default => Ok(default),
            Param::Number(x) => Ok(*x),
            Param::Text(t) => {
                let t = crate::text::line(&t.chars().take(20).collect::<String>());
                Err(format!("its parameter {at} is `{t}`, not a number"))
            }
        }
    }

    pub(super) fn int(&mut self) -> Got<i64> {
        let at = self.at;
        let x = self.real()?;
        if x.fract() == 0.0 && x.abs() < 1e15 {
            Ok(x as i64)
        } else {
            Err(format!("its parameter {at} is {x}, not a whole number"))
        }
    }

    pub(super) fn point(&mut self) -> Got<DVec3> {
        Ok(DVec3::new(self.real()?, self.real()?, self.real()?))
    }

    /// A count of things that take so many parameters each: more than there are parameters is an error, so that a wrong
    /// count cannot ask for memory.
    pub(super) fn count(&mut self, each: usize) -> Got<usize> {
        let n = self.int()?;
        self.fits(n, each)
    }

    /// Whether there are so many parameters.
    pub(super) fn fits(&self, n: i64, each: usize) -> Got<usize> {
        let n = usize::try_from(n).map_err(|_| format!("it counts {n} things"))?;
        // Parameters at the end that have their default may be missing.
        if n.checked_mul(each).is_some_and(|m| m <= self.left() + 16) {
            Ok(n)
        } else {
            Err(format!(
                "it counts {n}, but has only {} parameters left",
                self.left()
            ))
        }
    }

    /// Fails unless so many parameters are there, none of them missing at the end.
    pub(super) fn has(&self, n: usize) -> Got<()> {
        if n <= self.left() {
            return Ok(());
        }
        Err(format!(
            "it ends after {} of {n} numbers of its net",
            self.left()
        ))
    }

    pub(super) fn reals(&mut self, n: usize) -> Got<Vec<f64>> {
        (0..n).map(|_| self.real()).collect()
    }

    pub(super) fn points(&mut self, n: usize) -> Got<Vec<DVec3>> {
        (0..n).map(|_| self.point()).collect()
    }

    pub(super) fn ints(&mut self, n: usize) -> Got<Vec<i64>> {
        (0..n).map(|_| self.int()).collect()
    }

    pub(super) fn skip(&mut self, n: usize) {
        self.at = self.at.saturating_add(n);
    }

    pub(super) fn text(&mut self) -> Option<String> {
        match self.next() {
            Param::Text(t) => Some(t.clone()),
            _ => None,
        }
    }
}
