//! The page of the figures.

use crate::number;
use crate::plot::svg;
use crate::scaling::Plot;
use crate::tasks::Row;
use std::fmt::Write;
use std::fs;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");

const HEAD: &str = "\
# Performance

<!-- Written by `cargo xtask bench --page`; change crates/nappe/benches/surfaces/page.rs instead. -->

Each row is the best of several runs, one core unless said, results written to places that are already mapped. *Limit* is
the time to fill the same places with one number, measured in turns with the task: nothing that stores its answer can be
faster. Where there is a limit, the times are for results that go to memory: each run writes to another place, and all
places together are several times larger than the last-level cache. *In cache* is the time if each run writes to the same
place and the cache holds it; then *× limit in cache* compares it with filling that place. *Plain* is a loop over single points (in rows of two threads: one thread). Other libraries stand beside the tasks they have a call for, in
their fastest public call; they are those of `bench/peers.py` that were installed. Compare ratios, not times.
";

const BOUNDS: &str = "
## What bounds each row

* **T1, T4, grid**: writing, and one short sum of products a point, eight columns at a time with AVX-512, four with AVX2.
  Results of 16 MB and more go past the caches, which takes less than the fill they are compared with: that reads each
  line before it writes it. Blocks of whole lines leave from the registers. Smaller ones cost the sums, and the divisions of
  rational surfaces. The sides
  are evaluated n + m times by the exact formulas, eight parameters at a time, which counts for small grids and for kinds
  made of curves: a side that takes half a microsecond a point costs half a nanosecond a point of a grid of 1000 × 1000.
* **T2, normal**: writing first; then the arithmetic: two tangents, a cross product, a square root and a division a point.
* **T3, T3b, list, list1**: the arithmetic of one point after the other: finding the pieces, and Horner's scheme along u
  and along v with the coefficients of that pair of pieces, from the second-level cache. Where all pairs would need more
  than 8 MB, the sides by powers about the piece's middle and the products with the net or the core; nets beyond the
  caches are walked through in their own order, a quarter of a million points at a time, and there the time goes into
  waiting for memory, for the net and for results out of order.
* **Sides that are no polynomials** (turns by angle, trigonometric blending, fillets, expressions) are taken by Taylor
  polynomials of degree 7 at most, where their remainder is proven to be below rounding and their own rounding, measured
  by what it does to the surface, is fine. Preparing them takes the first list of a surface up to some tens of
  milliseconds, a Diagonal-key surface in space up to a third of a second. Where functions are singular, they are
  evaluated as single points are: such lists cost what their functions cost.
* **T5, nearest points**: on polynomial pieces the Bernstein coefficients of the squared distance, best first, which bound it
  and prove it convex; elsewhere bounds of parts of the surface. Then Newton's method, whose gradients prove the gap. The bounds
  take more time.
* **T6, mesh**: of coarse meshes, the enclosures that prove the tolerance and the samples of squares with few triangles. Of
  fine ones, about half goes into dividing squares (a quarter of it into bounds for their parts, as much into squares of few
  triangles beside pieces and sides), under a third into evaluating vertices and emitting triangles, and a fifth into first
  touching fresh memory. The choice of grids and the numbering in between run on one thread.

Grids are the same as single points to the last bit, with any instruction set and any number of threads. Lists are the
same with any instruction set and any number of threads, and agree with single points within four units in the last place
of the surface's size. No sum is fused with its product, since that would change the last bit from machine to machine.
";

/// The processor, in words.
fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|l| l.strip_prefix("model name")?.split(':').nth(1));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!(
        "{}, {cores} cores",
        model.map_or("unknown processor", str::trim)
    )
}

fn cells(row: &Row) -> String {
    let or_none = |x: Option<f64>| x.map_or("–".into(), number);
    let peers: Vec<String> = row
        .peers
        .iter()
        .map(|(name, ns)| format!("{name} {} ({}×)", number(*ns), number(ns / row.ns)))
        .collect();
    format!(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        row.task,
        row.kind,
        row.n,
        number(row.ns),
        or_none(row.limit),
        or_none(row.ratio()),
        or_none(row.cached.map(|c| c[0])),
        or_none(row.ratio_in_cache()),
        or_none(row.plain),
        peers.join(", ")
    )
}

/// Writes the page and its plots.
pub(crate) fn write(rows: &[Row], plots: &[Plot]) {
    let mut page = String::from(HEAD);
    write!(
        page,
        "\nMachine: {}. Command: `cargo xtask bench --page`.\n\n\
         | task | kind | n | ns an item | limit | × limit in memory | in cache | × limit in cache | plain | others, ns (times ours) |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|---|\n",
        machine()
    )
    .unwrap();
    rows.iter().for_each(|r| page += &cells(r));
    page += "\nT1 grid of positions, T2 with unit normals, T3 scattered points with first derivatives, T3b with second too,\n\
        T4 as T1 for a rational net; *list1* with first derivatives; T5 the nearest point of the surface, proven, to points within\n\
        5 % of the diagonal; T6 a mesh on two threads, for each triangle, proven to that\n\
        share of the diagonal; *mesh* the same for every kind, to a thousandth.\n";
    page += BOUNDS;
    page += "\n## How cost grows\n";
    fs::create_dir_all(format!("{FOLDER}/performance")).unwrap();
    for plot in plots {
        fs::write(format!("{FOLDER}/performance/{}.svg", plot.file), svg(plot)).unwrap();
        write!(
            page,
            "\n![Time over {}](performance/{}.svg)\n\n{}",
            plot.x,
            plot.file,
            growth(plot)
        )
        .unwrap();
    }
    page += "\nMemory is that of the parameters and results for points, of the nets for nets and for grids of many surfaces;\n\
        for meshes it is by how much the process grew at most, and *× result* compares it with the mesh that remains.\n";
    fs::write(format!("{FOLDER}/performance.md"), page).unwrap();
}

/// The numbers of a plot as a table.
pub(crate) fn growth(plot: &Plot) -> String {
    let mut table = format!(
        "| line | {} | ns an item | memory, MB | × result |\n|---|--:|--:|--:|--:|\n",
        plot.x
    );
    for (line, p) in plot
        .lines
        .iter()
        .flat_map(|l| l.points.iter().map(move |p| (l, p)))
    {
        table += &format!(
            "| {} | {} | {} | {} | {} |\n",
            line.name,
            p.x,
            number(p.ns),
            number(p.bytes / 1e6),
            p.result.map_or("–".into(), |r| number(p.bytes / r))
        );
    }
    table
}
