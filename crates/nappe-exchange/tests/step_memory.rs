//! How much memory STEP files need beside their own size: measured by the system, so this process does nothing else.

#![allow(clippy::unwrap_used)]
#![cfg(target_os = "linux")]

use nappe_exchange::step::{self, Schema, StepOptions};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Points of each side of a face.
const SIDE: usize = 20;

/// A file of bicubic faces with straight sides, each a sheet of its own, of about so many bytes; tells how many.
fn generate(path: &Path, size: usize) -> usize {
    let mut out = BufWriter::new(File::create(path).unwrap());
    write!(
        out,
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#9=CONTEXT();\n"
    )
    .unwrap();
    let (mut written, mut id, mut bodies) = (0, 10, Vec::new());
    while written < size {
        let first = id;
        let mut text = String::new();
        let mut entity = |what: String| {
            text += &format!("#{id}={what};\n");
            id += 1;
            id - 1
        };
        for i in 0..SIDE {
            for j in 0..SIDE {
                let inside = (1..SIDE - 1).contains(&i) && (1..SIDE - 1).contains(&j);
                let z = if inside {
                    ((i * 7 + j) as f64 + first as f64).sin()
                } else {
                    0.0
                };
                let (x, y) = (i as f64 / 3.0, j as f64 / 7.0 + first as f64);
                entity(format!("CARTESIAN_POINT('',({x:?},{y:?},{z:?}))"));
            }
        }
        let at = |i: usize, j: usize| first + i * SIDE + j;
        let n = SIDE - 1;
        let corners = [at(0, 0), at(n, 0), at(n, n), at(0, n)];
        let vertices = corners.map(|c| entity(format!("VERTEX_POINT('',#{c})")));
        let edges: Vec<String> = (0..4)
            .map(|k| {
                let along = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][k];
                let d = entity(format!("DIRECTION('',({:?},{:?},0.))", along.0, along.1));
                let v = entity(format!("VECTOR('',#{d},1.)"));
                let line = entity(format!("LINE('',#{},#{v})", corners[k]));
                let (a, b) = (vertices[k], vertices[(k + 1) % 4]);
                let edge = entity(format!("EDGE_CURVE('',#{a},#{b},#{line},.T.)"));
                format!("#{}", entity(format!("ORIENTED_EDGE('',*,*,#{edge},.T.)")))
            })
            .collect();
        let rows: Vec<String> = (0..SIDE)
            .map(|i| {
                let row: Vec<String> = (0..SIDE).map(|j| format!("#{}", at(i, j))).collect();
                format!("({})", row.join(","))
            })
            .collect();
        let inner = SIDE - 4;
        let times = format!("(4{},4)", ",1".repeat(inner));
        let knots: Vec<String> = (0..inner + 2).map(|k| format!("{k}.")).collect();
        let knots = knots.join(",");
        let surface = entity(format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.,{times},{times},({knots}),({knots}),.UNSPECIFIED.)",
            rows.join(",")
        ));
        let around = entity(format!("EDGE_LOOP('',({}))", edges.join(",")));
        let bound = entity(format!("FACE_BOUND('',#{around},.T.)"));
        let face = entity(format!("ADVANCED_FACE('',(#{bound}),#{surface},.T.)"));
        let shell = entity(format!("OPEN_SHELL('',(#{face}))"));
        bodies.push(format!(
            "#{}",
            entity(format!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"))
        ));
        out.write_all(text.as_bytes()).unwrap();
        written += text.len();
    }
    write!(
        out,
        "#1=SHAPE_REPRESENTATION('',({}),#9);\nENDSEC;\nEND-ISO-10303-21;\n",
        bodies.join(",")
    )
    .unwrap();
    out.flush().unwrap();
    bodies.len()
}

/// A line of what the system says of this process, bytes.
fn status(key: &str) -> f64 {
    let text = fs::read_to_string("/proc/self/status").unwrap();
    let line = text.lines().find(|l| l.starts_with(key)).unwrap();
    let kilobytes: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kilobytes * 1024.0
}

/// How far the memory of this process grows meanwhile at most, bytes; `None` where the system does not let its peak be
/// forgotten.
fn growth<T>(f: impl FnOnce() -> T) -> Option<(T, f64)> {
    let before = status("VmRSS");
    fs::write("/proc/self/clear_refs", "5").ok()?;
    let result = f();
    Some((result, status("VmHWM") - before))
}

fn ratios(size: usize) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("large.step");
    let bodies = generate(&path, size);
    let size = fs::metadata(&path).unwrap().len() as f64;
    let Some((file, grown)) = growth(|| step::read(&fs::read(&path).unwrap()).unwrap()) else {
        return eprintln!("skipped: the system does not tell how memory grows");
    };
    assert_eq!(file.document.left_out, []);
    assert_eq!(file.document.items.len(), bodies);
    let again = dir.path().join("again.step");
    let options = StepOptions {
        schema: Schema::Ap242,
        tolerance: 1e-6,
    };
    let written = growth(|| step::write(&again, &file.document, &options).unwrap());
    let more = written.map_or(0.0, |w| w.1);
    eprintln!(
        "{:.0} MB: reading needs {:.2} times that in all, writing {:.2} times more than the document",
        size / 1e6,
        grown / size,
        more / size
    );
    assert!(grown < 4.0 * size, "{grown}");
    assert!(more < 0.5 * size + 50e6, "{more}");
}

#[test]
fn reading_needs_less_than_four_times_the_size_and_writing_little_more_than_the_document() {
    ratios(40_000_000);
}

#[test]
#[ignore = "takes gigabytes of memory; run one at a time"]
fn two_hundred_megabytes() {
    ratios(200_000_000);
}

#[test]
#[ignore = "takes gigabytes of memory; run one at a time"]
fn five_hundred_megabytes() {
    ratios(500_000_000);
}
