//! Plots with logarithmic axes, as SVG.

use crate::scaling::{Plot, Point};

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 50.0;
const COLOURS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];

/// Nanoseconds an item over x.
pub(crate) fn svg(plot: &Plot) -> String {
    let all = || plot.lines.iter().flat_map(|l| &l.points);
    let range = |of: fn(&Point) -> f64| {
        let (lo, hi) = all()
            .map(of)
            .fold((f64::INFINITY, 0f64), |(a, b), x| (a.min(x), b.max(x)));
        (
            lo.log10().floor(),
            hi.log10().ceil().max(lo.log10().floor() + 1.0),
        )
    };
    let (x, y) = (range(|p| p.x), range(|p| p.ns));
    let px = |v: f64| LEFT + (v.log10() - x.0) / (x.1 - x.0) * (WIDTH - LEFT - RIGHT);
    let py = |v: f64| HEIGHT - BOTTOM - (v.log10() - y.0) / (y.1 - y.0) * (HEIGHT - TOP - BOTTOM);
    let mut s = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut decade = |k: f64, along_x: bool| {
        let v = 10f64.powf(k);
        let (x1, y1, x2, y2, tx, ty, anchor) = if along_x {
            (
                px(v),
                TOP,
                px(v),
                HEIGHT - BOTTOM,
                px(v),
                HEIGHT - BOTTOM + 16.0,
                "middle",
            )
        } else {
            (
                LEFT,
                py(v),
                WIDTH - RIGHT,
                py(v),
                LEFT - 6.0,
                py(v) + 4.0,
                "end",
            )
        };
        s += &format!(
            "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"#ddd\"/>\n<text x=\"{tx:.1}\" y=\"{ty:.1}\" \
             text-anchor=\"{anchor}\">10<tspan dy=\"-5\" font-size=\"9\">{k}</tspan></text>\n"
        );
    };
    for k in x.0 as i32..=x.1 as i32 {
        decade(f64::from(k), true);
    }
    for k in y.0 as i32..=y.1 as i32 {
        decade(f64::from(k), false);
    }
    for (i, line) in plot.lines.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let path: Vec<String> = line
            .points
            .iter()
            .map(|p| format!("{:.1} {:.1}", px(p.x), py(p.ns)))
            .collect();
        s += &format!(
            "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n",
            path.join("L")
        );
        for p in &line.points {
            s += &format!(
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>\n",
                px(p.x),
                py(p.ns)
            );
        }
        s += &format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{}</text>\n",
            LEFT + 10.0,
            TOP + 14.0 + 15.0 * i as f64,
            line.name
        );
    }
    s += &format!(
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
         <text x=\"{LEFT}\" y=\"13\">ns an item</text>\n</svg>\n",
        (LEFT + WIDTH - RIGHT) / 2.0,
        HEIGHT - 12.0,
        plot.x,
    );
    s
}
