//! `nappe eval`: against closed forms, in every format, and what it says to bad tables.

use crate::run::{Folder, nappe};
use insta::assert_snapshot;
use parquet::basic::{Compression, Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RowAccessor;
use parquet::schema::types::Type;
use std::fs::File;
use std::io::Read;
use std::process::Stdio;
use std::sync::Arc;

/// r(u, v) = (u (1 - v), v, u), and the cubic curve (t, t², t³) over [-1, 2].
const MODEL: &str = r#"
[surfaces.sheet]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [0, 1, 1]]]

[curves.twisted]
kind = "expression"
x = "t"
y = "t^2"
z = "t^3"
domain = [-1, 2]
"#;

/// The header and the numbers of a table of text.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let rows = lines
        .map(|l| l.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    (header, rows)
}

fn assert_close(a: f64, b: f64) {
    assert!(
        (a - b).abs() <= 1e-14 * b.abs().max(1.0),
        "{a} instead of {b}"
    );
}

#[test]
fn a_surface_and_its_derivatives_match_the_closed_form() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("eval model.nappe.toml --surface sheet --grid 4x3 --order 3");
    let (header, rows) = table(run.data());
    assert_eq!(
        header.join(","),
        "u,v,x,y,z,x_u,y_u,z_u,x_v,y_v,z_v,x_uu,y_uu,z_uu,x_uv,y_uv,z_uv,x_vv,y_vv,z_vv,\
         x_uuu,y_uuu,z_uuu,x_uuv,y_uuv,z_uuv,x_uvv,y_uvv,z_uvv,x_vvv,y_vvv,z_vvv"
    );
    assert_eq!(rows.len(), 12);
    for (k, row) in rows.iter().enumerate() {
        let (u, v) = (row[0], row[1]);
        assert_close(u, (k / 3) as f64 / 3.0);
        assert_close(v, (k % 3) as f64 / 2.0);
        let mut expected = vec![u * (1.0 - v), v, u];
        expected.extend([1.0 - v, 0.0, 1.0, -u, 1.0, 0.0]);
        expected.extend([0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        expected.extend([0.0; 12]);
        for (&a, b) in row[2..].iter().zip(expected) {
            assert_close(a, b);
        }
    }
}

#[test]
fn a_curve_and_its_derivatives_match_the_closed_form() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe_with(
        "eval model.nappe.toml --curve twisted --order 2",
        b"-1\n0.5\n2\n",
    );
    let (header, rows) = table(run.data());
    assert_eq!(header.join(","), "t,x,y,z,x_t,y_t,z_t,x_tt,y_tt,z_tt");
    for (row, t) in rows.iter().zip([-1.0, 0.5, 2.0]) {
        let expected = [
            t,
            t,
            t * t,
            t * t * t,
            1.0,
            2.0 * t,
            3.0 * t * t,
            0.0,
            2.0,
            6.0 * t,
        ];
        for (&a, b) in row.iter().zip(expected) {
            assert_close(a, b);
        }
    }
}

#[test]
fn numbers_read_back_as_the_same_numbers() {
    let folder = Folder::with_model(MODEL);
    let (u, v) = (0.1 + 0.2, 1.0 / 3.0);
    let run = folder.nappe_with(
        "eval model.nappe.toml --surface sheet",
        format!("{u:?},{v:?}\n").as_bytes(),
    );
    let (_, rows) = table(run.data());
    assert_eq!(rows[0][..2], [u, v]);
    let short = folder.nappe_with("eval model.nappe.toml --surface sheet", b"0.25,0.5");
    assert_eq!(short.data(), "u,v,x,y,z\n0.25,0.5,0.125,0.5,0.25\n");
}

#[test]
fn a_header_orders_the_columns_and_others_are_passed_over_with_a_note() {
    let folder = Folder::with_model(MODEL);
    let input = "\u{feff}# measured\nid, V ,u\r\n\n 7,0.5 ,0.25\n8,\"1\",0\n";
    let run = folder.nappe_with("eval model.nappe.toml --surface sheet", input.as_bytes());
    assert_eq!(
        run.data(),
        "u,v,x,y,z\n0.25,0.5,0.125,0.5,0.25\n0.0,1.0,0.0,1.0,0.0\n"
    );
    assert!(run.stderr.contains("not used: id"), "{}", run.stderr);
    let quiet = folder.nappe_with("eval -q model.nappe.toml --surface sheet", input.as_bytes());
    assert_eq!(quiet.stderr, "");
}

#[test]
fn an_empty_table_gives_the_header_alone() {
    let folder = Folder::with_model(MODEL);
    for input in ["", "u,v\n", "# nothing\n"] {
        let run = folder.nappe_with("eval model.nappe.toml --surface sheet", input.as_bytes());
        assert_eq!(run.data(), "u,v,x,y,z\n");
    }
}

#[test]
fn jsonl_and_parquet_hold_the_same_numbers_as_csv() {
    let folder = Folder::with_model(MODEL);
    let eval = "eval model.nappe.toml --surface sheet --grid 7x9 --order 1";
    let (header, rows) = table(folder.nappe(eval).data());

    let jsonl = folder.nappe(&format!("{eval} --format jsonl"));
    let lines: Vec<&str> = jsonl.data().lines().collect();
    assert_eq!(lines.len(), rows.len());
    for (line, row) in lines.iter().zip(&rows) {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        let object = value.as_object().unwrap();
        assert_eq!(object.len(), header.len());
        for (name, &x) in header.iter().zip(row) {
            assert_eq!(object[name].as_f64(), Some(x));
        }
    }

    assert_eq!(folder.nappe(&format!("{eval} -o out.parquet")).code, 0);
    let file = SerializedFileReader::new(File::open(folder.path("out.parquet")).unwrap()).unwrap();
    let mut count = 0;
    for (parquet_row, row) in file.get_row_iter(None).unwrap().zip(&rows) {
        let parquet_row = parquet_row.unwrap();
        for (i, &x) in row.iter().enumerate() {
            assert_eq!(parquet_row.get_double(i).unwrap(), x);
        }
        count += 1;
    }
    assert_eq!(count, rows.len());
}

/// Writes a table with these columns; `None` is null.
fn write_parquet(
    folder: &Folder,
    name: &str,
    columns: &[(&str, Vec<Option<f64>>)],
    compression: Compression,
) {
    let fields = columns
        .iter()
        .map(|(name, _)| {
            Type::primitive_type_builder(name, PhysicalType::DOUBLE)
                .with_repetition(Repetition::OPTIONAL)
                .build()
                .map(Arc::new)
                .unwrap()
        })
        .collect();
    let schema = Type::group_type_builder("t")
        .with_fields(fields)
        .build()
        .unwrap();
    let properties = WriterProperties::builder()
        .set_compression(compression)
        .build();
    let file = File::create(folder.path(name)).unwrap();
    let mut file = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
    // Two groups of rows, so that going from one to the next is tried too.
    for half in 0..2 {
        let mut group = file.next_row_group().unwrap();
        for (_, values) in columns {
            let middle = values.len() / 2;
            let part = if half == 0 {
                &values[..middle]
            } else {
                &values[middle..]
            };
            let levels: Vec<i16> = part.iter().map(|v| v.is_some().into()).collect();
            let present: Vec<f64> = part.iter().flatten().copied().collect();
            let mut column = group.next_column().unwrap().unwrap();
            column
                .typed::<DoubleType>()
                .write_batch(&present, Some(&levels), None)
                .unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    file.close().unwrap();
}

#[test]
fn parquet_is_read_from_files_and_pipes() {
    let folder = Folder::with_model(MODEL);
    let n = 10_001;
    let u: Vec<Option<f64>> = (0..n).map(|i| Some(i as f64 / (n - 1) as f64)).collect();
    let v: Vec<Option<f64>> = u.iter().map(|u| u.map(|u| u * u)).collect();
    let ids = vec![Some(0.0); n];
    for (name, compression) in [
        ("plain.parquet", Compression::UNCOMPRESSED),
        ("snappy.data", Compression::SNAPPY),
        ("lz4.parquet", Compression::LZ4_RAW),
    ] {
        write_parquet(
            &folder,
            name,
            &[("v", v.clone()), ("id", ids.clone()), ("u", u.clone())],
            compression,
        );
        let from_file = folder.nappe(&format!(
            "eval model.nappe.toml --surface sheet --uv {name}"
        ));
        let (_, rows) = table(from_file.data());
        assert_eq!(rows.len(), n);
        for (row, u) in rows.iter().zip(&u) {
            let u = u.unwrap();
            assert_eq!(row[..2], [u, u * u]);
            assert_close(row[2], u * (1.0 - u * u));
        }
        let piped = folder.nappe_with("eval model.nappe.toml --surface sheet", &folder.read(name));
        assert_eq!(piped.stdout, from_file.stdout);
    }
}

#[test]
fn bad_parquet_is_told_by_row_or_column() {
    let folder = Folder::with_model(MODEL);
    let plain = Compression::UNCOMPRESSED;
    let good = vec![Some(0.5); 4];
    write_parquet(
        &folder,
        "null.parquet",
        &[
            ("u", good.clone()),
            ("v", vec![Some(0.0), Some(0.5), None, Some(1.0)]),
        ],
        plain,
    );
    write_parquet(
        &folder,
        "nan.parquet",
        &[
            ("u", good.clone()),
            ("v", vec![Some(0.0), Some(f64::NAN), Some(2.0), Some(1.0)]),
        ],
        plain,
    );
    write_parquet(
        &folder,
        "missing.parquet",
        &[("u", good.clone()), ("w", good)],
        plain,
    );
    folder.write("cut.parquet", "PAR1 and nothing else");
    for name in ["null", "nan", "missing", "cut"] {
        let run = folder.nappe(&format!(
            "eval model.nappe.toml --surface sheet --uv {name}.parquet"
        ));
        assert_snapshot!(format!("eval-parquet-{name}"), run.problem());
    }
}

#[test]
fn bad_rows_are_told_by_line() {
    let folder = Folder::with_model(MODEL);
    for (name, input) in [
        ("not-finite", "u,v\n0.5,0.5\nnan,0.5\n0.5,-inf\n"),
        ("outside", "0.5,0.5\n1.25,0.5\n0.5,-1e-9\n"),
        ("columns", "0.5,0.5\n0.5\n0.5,0.5,0.5\n\n"),
        ("words", "0.5,0.5\n# a comment\n0.5,half\n0;5,1\n,1\n"),
        ("header-lacks-v", "u,w\n0.5,0.5\n"),
        ("header-twice", "u,v,U\n0.5,0.5,0.5\n"),
        ("many", &"2,2\n".repeat(50)),
    ] {
        folder.write("uv.csv", input);
        let run = folder.nappe("eval model.nappe.toml --surface sheet --uv uv.csv -o out.csv");
        assert_snapshot!(format!("eval-{name}"), run.problem());
        assert!(
            !folder.path("out.csv").exists(),
            "{name}: a half-written file remains"
        );
    }
}

/// All kinds of bad rows in one run, with their places in the file as an editor counts them: comments, empty lines and
/// the mark at the beginning of the file count.
#[test]
fn all_bad_rows_are_told_before_anything_is_put_out() {
    let folder = Folder::with_model(MODEL);
    let mut input = String::from("\u{feff}# measured\r\n\r\n\"v\", \"note, or é\" ,u\r\n");
    input +=
        "0.5,\"a, é\",0.5\r\n\r\n0.5,b,1.5\r\n# half\r\nhalf,c,nan\r\n0.5,d\r\n7,\"é, e\",oops\r\n";
    // Far behind the first block.
    input += &"0.25,f,0.75\r\n".repeat(10_000);
    input += "0.5,g,inf\r\n0.5,h,x";
    folder.write("uv.csv", &input);
    let from_file = folder.nappe("eval model.nappe.toml --surface sheet --uv uv.csv");
    assert_snapshot!("eval-all-kinds", from_file.problem());
    assert!(from_file.stdout.is_empty(), "something was put out");
    let piped = folder.nappe_with("eval model.nappe.toml --surface sheet", input.as_bytes());
    assert_eq!(
        piped.problem(),
        from_file.stderr.replace("uv.csv", "standard input")
    );
    assert!(piped.stdout.is_empty(), "something was put out");
}

/// Where the curve has no finite derivative is found before the header is put out.
#[test]
fn singular_rows_of_a_curve_are_told_with_the_others() {
    let folder = Folder::with_model(
        "[curves.root]\nkind = \"expression\"\nx = \"t\"\ny = \"t^1.5\"\nz = \"0\"\n",
    );
    folder.write("t.csv", "0.5\n0\n2\nx\n");
    let run = folder.nappe("eval model.nappe.toml --curve root --uv t.csv --order 2");
    assert_snapshot!("eval-singular", run.problem());
    assert!(run.stdout.is_empty());
}

#[test]
fn what_is_no_table_is_refused() {
    let folder = Folder::with_model(MODEL);
    let mut noise: Vec<u8> = (0..3_000_000u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    noise.retain(|&b| b != b'\n');
    std::fs::write(folder.path("noise.csv"), &noise).unwrap();
    let run = folder.nappe("eval model.nappe.toml --surface sheet --uv noise.csv");
    assert!(
        run.problem()
            .contains("noise.csv:1: the line is longer than 1048576 bytes"),
        "{}",
        run.stderr
    );
    assert!(run.stdout.is_empty());
}

#[test]
fn a_failed_run_leaves_the_old_file() {
    let folder = Folder::with_model(MODEL);
    folder.write("out.csv", "old");
    // The bad row is far behind the first block, so writing has begun.
    let mut input = "0.5,0.5\n".repeat(20_000);
    input.push_str("3,0.5\n");
    folder.write("uv.csv", &input);
    let run = folder.nappe("eval model.nappe.toml --surface sheet --uv uv.csv -o out.csv");
    assert!(
        run.problem().contains("uv.csv:20001:1: u = 3 is outside"),
        "{}",
        run.stderr
    );
    assert_eq!(folder.read("out.csv"), b"old");
    assert_eq!(folder.names(), ["model.nappe.toml", "out.csv", "uv.csv"]);
}

#[test]
fn names_files_and_formats_that_are_wrong() {
    let folder = Folder::with_model(MODEL);
    let mut all = String::new();
    for args in [
        "--surface shet --grid 3",
        "--surface twisted --grid 3",
        "--curve twist --grid 3",
        "--surface sheet --uv none.csv",
        "--surface sheet --uv .",
        "--surface sheet --grid 3 -o out.xlsx",
        "--surface sheet --grid 3 -o none/out.csv",
    ] {
        let run = folder.nappe(&format!("eval model.nappe.toml {args}"));
        all.push_str(&format!("$ {args}\n{}\n", run.problem()));
    }
    assert_snapshot!(all);
    assert_eq!(
        folder
            .nappe("eval model.nappe.toml --curve twisted --grid 3x3")
            .code,
        2
    );
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::with_model(MODEL);
    for format in ["csv", "jsonl", "parquet"] {
        let mut child = nappe(&folder.path(""))
            .args([
                "eval",
                "model.nappe.toml",
                "--surface",
                "sheet",
                "--grid",
                "700",
                "--format",
                format,
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = [0; 16];
        child.stdout.take().unwrap().read_exact(&mut first).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{format}: {output:?}");
        assert!(output.stderr.is_empty(), "{format}: {output:?}");
    }
}

/// r(u, v) = (p² u (1 - v), p q (1 - u) v + u v, u) and the curve (sin(p t), t, q t²) by p and q.
#[test]
fn velocities_are_columns() {
    let folder = Folder::with_model(
        r#"
[params]
p = 1.5
q = 2
corner = 1

[surfaces.sheet]
kind = "bilinear"
corners = [[[0, 0, 0], [0, "p*q", 0]], [["p^2", 0, 1], [0, 1, 1]]]

[curves.line]
kind = "expression"
x = "sin(p*t)"
y = "t"
z = "q*t^2"

[curves.bent]
kind = "polyline"
points = [[0, 0, 0], ["corner", 1, 0], [3, 0, 0]]
"#,
    );
    let (p, q) = (1.5, 2.0);
    let run = folder.nappe(
        "eval model.nappe.toml --surface sheet --grid 4x3 --order 1 --sensitivity p --sensitivity q --sensitivity corner",
    );
    let (header, rows) = table(run.data());
    assert_eq!(
        header.join(","),
        "u,v,x,y,z,x_u,y_u,z_u,x_v,y_v,z_v,dx_dp,dy_dp,dz_dp,dx_dq,dy_dq,dz_dq,dx_dcorner,dy_dcorner,dz_dcorner"
    );
    for row in &rows {
        let (u, v) = (row[0], row[1]);
        let by_p = [2.0 * p * u * (1.0 - v), q * (1.0 - u) * v, 0.0];
        let by_q = [0.0, p * (1.0 - u) * v, 0.0];
        for (&a, b) in row[11..].iter().zip([by_p, by_q, [0.0; 3]].concat()) {
            assert_close(a, b);
        }
        assert_close(row[2], p * p * u * (1.0 - v));
    }
    let run = folder.nappe("eval model.nappe.toml --curve line --grid 5 --sensitivity p");
    let (header, rows) = table(run.data());
    assert_eq!(header.join(","), "t,x,y,z,dx_dp,dy_dp,dz_dp");
    for row in &rows {
        assert_close(row[4], row[0] * (p * row[0]).cos());
        assert_close(row[5], 0.0);
    }
    // With --set the velocity is that of the other value; a name that is none is told, and so is a velocity that jumps.
    let run = folder.nappe("eval model.nappe.toml --curve line --grid 3 --set p=0 --sensitivity p");
    let (_, rows) = table(run.data());
    rows.iter().for_each(|row| assert_close(row[4], row[0]));
    let run = folder.nappe("eval model.nappe.toml --curve line --grid 2 --sensitivity pp");
    assert!(run.problem().contains("there is no parameter `pp`"));
    let run = folder.nappe("eval model.nappe.toml --curve bent --grid 2 --sensitivity corner");
    assert!(run.problem().contains("jumps"));
}
