//! Units of length.

/// A unit of length. The kernel computes in the caller's unit, whichever it is; models and files say which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Millimetres, 0.001 m.
    #[default]
    Millimetre,
    /// Centimetres, 0.01 m.
    Centimetre,
    /// Metres.
    Metre,
    /// Inches, 0.0254 m.
    Inch,
    /// Feet, 0.3048 m.
    Foot,
}

impl Units {
    /// The length of one unit in metres.
    pub fn metres(self) -> f64 {
        match self {
            Units::Millimetre => 0.001,
            Units::Centimetre => 0.01,
            Units::Metre => 1.0,
            Units::Inch => 0.0254,
            Units::Foot => 0.3048,
        }
    }

    /// The symbol: `mm`, `cm`, `m`, `in` or `ft`.
    pub fn symbol(self) -> &'static str {
        match self {
            Units::Millimetre => "mm",
            Units::Centimetre => "cm",
            Units::Metre => "m",
            Units::Inch => "in",
            Units::Foot => "ft",
        }
    }

    /// The unit with this symbol.
    pub fn from_symbol(symbol: &str) -> Option<Units> {
        [
            Units::Millimetre,
            Units::Centimetre,
            Units::Metre,
            Units::Inch,
            Units::Foot,
        ]
        .into_iter()
        .find(|u| u.symbol() == symbol)
    }
}
