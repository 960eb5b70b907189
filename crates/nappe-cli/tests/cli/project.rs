//! `nappe project`: against closed forms, in every format, and what it does with rows that have no answer.

use crate::run::{Folder, Run, nappe};
use insta::assert_snapshot;
use nappe::DVec3;
use parquet::basic::{ConvertedType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RowAccessor;
use parquet::schema::types::Type;
use std::fs::File;
use std::sync::Arc;

/// A sphere of radius 2 around the origin, a square at z = -5, and a line.
const MODEL: &str = r#"
[surfaces.ball]
kind = "quadric"
shape = "sphere"
semi_axes = [2]

[surfaces.plate]
kind = "bilinear"
corners = [[[0, 0, -5], [0, 1, -5]], [[1, 0, -5], [1, 1, -5]]]

[curves.rod]
kind = "line"
from = [0, 0, 0]
to = [10, 0, 0]
"#;

/// The cells of a table of text, by the names of their columns.
fn table(run: &Run) -> Vec<std::collections::HashMap<String, String>> {
    let mut lines = run.data().lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), header.len(), "{line}");
        let pairs = header.iter().zip(cells);
        pairs
            .map(|(h, c)| ((*h).to_owned(), c.to_owned()))
            .collect()
    };
    lines.map(row).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

/// Points all around, the same in every run.
fn points(count: usize) -> Vec<[f64; 3]> {
    let mut state = 7u64;
    let mut unit = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count)
        .map(|_| [0; 3].map(|_| 8.0 * unit() - 4.0))
        .collect()
}

fn csv(points: &[[f64; 3]]) -> String {
    let rows = points.iter().map(|[x, y, z]| format!("{x},{y},{z}\n"));
    format!("x,y,z\n{}", rows.collect::<String>())
}

#[test]
fn distances_are_the_closed_forms_and_columns_are_handed_on() {
    let folder = Folder::with_model(MODEL);
    let given = points(500);
    let mut input = String::from("id,Z,x,y,note\n");
    for (k, [x, y, z]) in given.iter().enumerate() {
        input += &format!("p{k},{z},{x},{y},\"a \"\"b\"\"\"\n");
    }
    folder.write("points.csv", &input);
    let run = folder.nappe("project model.nappe.toml --points points.csv --surface ball");
    assert!(
        run.data()
            .starts_with("px,py,pz,id,note,distance,surface,u,v,x,y,z,gap,status\n")
    );
    let rows = table(&run);
    assert_eq!(rows.len(), given.len());
    for (k, (row, p)) in rows.iter().zip(&given).enumerate() {
        let [x, y, z] = *p;
        assert_eq!(["px", "py", "pz"].map(|c| number(&row[c])), *p);
        assert_eq!(row["id"], format!("p{k}"));
        assert_eq!(row["note"], "\"a \"\"b\"\"\"");
        assert_eq!(
            (row["surface"].as_str(), row["status"].as_str()),
            ("ball", "ok")
        );
        let r = (x * x + y * y + z * z).sqrt();
        let (distance, gap) = (number(&row["distance"]), number(&row["gap"]));
        assert!((distance - (r - 2.0).abs()).abs() <= gap + 1e-13 && gap < 2e-8);
        let at = ["x", "y", "z"].map(|c| number(&row[c]));
        let off = (0..3).map(|d| (at[d] - p[d]).powi(2)).sum::<f64>().sqrt();
        assert!((off - distance).abs() < 1e-12);
    }
}

#[test]
fn all_formats_hold_the_same_and_pipes_are_files() {
    let folder = Folder::with_model(MODEL);
    // More than one block, and more than one on the second thread.
    let given = points(9000);
    let mut input = csv(&given);
    input += "nan,0,0\n";
    folder.write("points.csv", &input);
    let text = folder.nappe("project model.nappe.toml --points points.csv --signed");
    let rows = table(&text);
    assert_eq!(rows.len(), 9001);
    for (row, p) in rows.iter().zip(&given) {
        assert_eq!(["px", "py", "pz"].map(|c| number(&row[c])), *p);
        let ball = (DVec3::from(*p).length() - 2.0).abs();
        let off = |x: f64| (x - x.clamp(0.0, 1.0)).abs();
        let plate = DVec3::new(off(p[0]), off(p[1]), p[2] + 5.0).length();
        let (distance, gap) = (number(&row["distance"]), number(&row["gap"]));
        assert!((distance - ball.min(plate)).abs() <= gap + 1e-13 && gap < 2e-8);
        if !row["signed"].is_empty() {
            let inside = row["surface"] == "ball" && DVec3::from(*p).length() < 2.0;
            assert_eq!(
                number(&row["signed"]),
                if inside { -distance } else { distance }
            );
        }
    }
    let piped = folder.nappe_with("project model.nappe.toml --signed", input.as_bytes());
    assert_eq!(piped.stdout, text.stdout);
    let command = "project model.nappe.toml --points points.csv --signed";
    for name in ["out.csv", "out.jsonl", "out.parquet"] {
        let run = folder.nappe(&format!("{command} -o {name}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(run.stdout.is_empty());
    }
    assert_eq!(folder.read("out.csv"), text.stdout);

    let jsonl = String::from_utf8(folder.read("out.jsonl")).unwrap();
    assert_eq!(jsonl.lines().count(), rows.len());
    for (line, row) in jsonl.lines().zip(&rows) {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        for (name, cell) in row {
            match &value[name] {
                serde_json::Value::Null => assert_eq!(cell, ""),
                serde_json::Value::String(s) => assert_eq!(cell, s),
                x => assert_eq!(number(cell), x.as_f64().unwrap()),
            }
        }
    }

    let file = SerializedFileReader::new(File::open(folder.path("out.parquet")).unwrap()).unwrap();
    let mut count = 0;
    for (got, row) in file.get_row_iter(None).unwrap().zip(&rows) {
        let got = got.unwrap();
        for (i, (name, field)) in got.get_column_iter().enumerate() {
            let cell = &row[name];
            match field {
                parquet::record::Field::Null => assert_eq!(cell, ""),
                parquet::record::Field::Str(s) => assert_eq!(cell, s),
                _ => assert_eq!(number(cell), got.get_double(i).unwrap()),
            }
        }
        count += 1;
    }
    assert_eq!(count, rows.len());
}

/// Writes points with an id, a name and some bytes without a meaning.
fn write_parquet(folder: &Folder, name: &str, points: &[[f64; 3]]) {
    let column = |name: &str, physical, converted| {
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_converted_type(converted)
            .build()
            .map(Arc::new)
            .unwrap()
    };
    let fields = vec![
        column("id", PhysicalType::INT64, ConvertedType::NONE),
        column("x", PhysicalType::DOUBLE, ConvertedType::NONE),
        column("name", PhysicalType::BYTE_ARRAY, ConvertedType::UTF8),
        column("y", PhysicalType::DOUBLE, ConvertedType::NONE),
        column("raw", PhysicalType::BYTE_ARRAY, ConvertedType::NONE),
        column("z", PhysicalType::DOUBLE, ConvertedType::NONE),
    ];
    let schema = Type::group_type_builder("t")
        .with_fields(fields)
        .build()
        .unwrap();
    let file = File::create(folder.path(name)).unwrap();
    let properties = WriterProperties::builder().build();
    let mut file = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
    for part in points.chunks(points.len().div_ceil(2)) {
        let mut group = file.next_row_group().unwrap();
        let texts = |s: &str| vec![parquet::data_type::ByteArray::from(s); part.len()];
        for k in 0..6 {
            let mut column = group.next_column().unwrap().unwrap();
            match k {
                0 => {
                    let ids: Vec<i64> = (0..part.len() as i64).map(|i| -i).collect();
                    column
                        .typed::<Int64Type>()
                        .write_batch(&ids, None, None)
                        .unwrap();
                }
                2 | 4 => {
                    let texts = texts("a,b");
                    column
                        .typed::<ByteArrayType>()
                        .write_batch(&texts, None, None)
                        .unwrap();
                }
                _ => {
                    let numbers: Vec<f64> = part.iter().map(|p| p[(k - 1) / 2]).collect();
                    column
                        .typed::<DoubleType>()
                        .write_batch(&numbers, None, None)
                        .unwrap();
                }
            }
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    file.close().unwrap();
}

#[test]
fn parquet_is_read_with_its_columns() {
    let folder = Folder::with_model(MODEL);
    let mut given = points(5001);
    given[3][1] = f64::NAN;
    write_parquet(&folder, "points.parquet", &given);
    let run = folder.nappe("project model.nappe.toml --points points.parquet -o out.jsonl");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("not used: raw"), "{}", run.stderr);
    assert!(
        run.stderr.contains("points.parquet, row 4: "),
        "{}",
        run.stderr
    );
    let text = String::from_utf8(folder.read("out.jsonl")).unwrap();
    assert_eq!(text.lines().count(), given.len());
    for (k, (line, p)) in text.lines().zip(&given).enumerate() {
        let row: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(row["id"], format!("{}", -(k as i64 % 2501)));
        assert_eq!(row["name"], "a,b");
        assert_eq!(row["px"].as_f64().unwrap(), p[0]);
        assert_eq!(row["status"], if k == 3 { "not finite" } else { "ok" });
    }
    // Cut short: the end with the description of the columns is missing.
    let bytes = folder.read("points.parquet");
    std::fs::write(folder.path("cut.parquet"), &bytes[..bytes.len() / 2]).unwrap();
    let run = folder.nappe("project model.nappe.toml --points cut.parquet -o none.csv");
    assert!(
        run.problem()
            .contains("cut.parquet: could not be read as Parquet"),
        "{}",
        run.stderr
    );
    assert!(!folder.path("none.csv").exists());
}

/// Writes four points in columns that may be null, or none.
fn write_nulls(folder: &Folder, name: &str, empty: bool) {
    let column = |name: &str, physical, converted| {
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_converted_type(converted)
            .build()
            .map(Arc::new)
            .unwrap()
    };
    let number = |name| column(name, PhysicalType::DOUBLE, ConvertedType::NONE);
    let mut all = vec![column(
        "name",
        PhysicalType::BYTE_ARRAY,
        ConvertedType::UTF8,
    )];
    all.extend(["x", "y", "z"].map(number));
    let schema = Type::group_type_builder("t")
        .with_fields(all)
        .build()
        .unwrap();
    let file = File::create(folder.path(name)).unwrap();
    let properties = WriterProperties::builder().build();
    let mut file = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
    if !empty {
        let mut group = file.next_row_group().unwrap();
        let mut names = group.next_column().unwrap().unwrap();
        let texts = ["a", "c", "d"].map(parquet::data_type::ByteArray::from);
        names
            .typed::<ByteArrayType>()
            .write_batch(&texts, Some(&[1, 0, 1, 1]), None)
            .unwrap();
        names.close().unwrap();
        // The y of the third point is null.
        let levels = [[1; 4], [1, 1, 0, 1], [1; 4]];
        let values = [
            vec![3.0, 0.0, 5.0, 0.0],
            vec![0.0, 4.0, 0.0],
            vec![0.0, 0.0, 0.0, 5.0],
        ];
        for (levels, values) in levels.iter().zip(values) {
            let mut column = group.next_column().unwrap().unwrap();
            column
                .typed::<DoubleType>()
                .write_batch(&values, Some(levels), None)
                .unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    file.close().unwrap();
}

#[test]
fn nulls_of_parquet_are_missing_cells_and_no_rows_are_refused() {
    let folder = Folder::with_model(MODEL);
    write_nulls(&folder, "points.parquet", false);
    let run = folder.nappe("project model.nappe.toml --points points.parquet");
    let rows = table(&run);
    let told: Vec<[&str; 3]> = rows
        .iter()
        .map(|r| ["name", "py", "status"].map(|c| r[c].as_str()))
        .collect();
    let expected = [
        ["a", "0.0", "ok"],
        ["", "4.0", "ok"],
        ["c", "", "unreadable"],
        ["d", "0.0", "ok"],
    ];
    assert_eq!(told, expected);
    for (k, exact) in [(0, 1.0), (1, 2.0), (3, 3.0)] {
        assert!((number(&rows[k]["distance"]) - exact).abs() < 1e-8);
    }
    assert!(
        run.stderr
            .contains("points.parquet, row 3, column `y`: it is null"),
        "{}",
        run.stderr
    );
    write_nulls(&folder, "none.parquet", true);
    let run = folder.nappe("project model.nappe.toml --points none.parquet");
    assert!(
        run.problem()
            .contains("none.parquet: there are no points in it"),
        "{}",
        run.stderr
    );
    assert!(run.stdout.is_empty());
}

#[test]
fn rows_without_an_answer_are_marked_and_told() {
    let folder = Folder::with_model(MODEL);
    let input = "id,x,y,z\na,3,0,0\nb,nan,0,0\nc,1,inf,0\nd,1,two,0\ne,1,2\nf,1e300,0,0\n\ng,,0,0\nh,0,0,3\n";
    folder.write("points.csv", input);
    let run = folder.nappe("project model.nappe.toml --points points.csv");
    let rows = table(&run);
    let status: Vec<String> = rows
        .iter()
        .map(|r| format!("{} {}", r["id"], r["status"]))
        .collect();
    let expected = [
        "a ok",
        "b not finite",
        "c not finite",
        "d unreadable",
        "e unreadable",
        "f no distance",
        "g unreadable",
        "h ok",
    ];
    assert_eq!(status, expected);
    assert!((number(&rows[7]["distance"]) - 1.0).abs() < 1e-7);
    // What could be read stands there, and nothing where there is no answer.
    assert_eq!(
        (rows[3]["px"].as_str(), rows[3]["py"].as_str()),
        ("1.0", "")
    );
    assert!(
        rows[1..7]
            .iter()
            .all(|r| r["distance"].is_empty() && r["u"].is_empty())
    );
    assert_snapshot!("project-unanswered", run.stderr);
    // Many of them.
    folder.write(
        "many.csv",
        &format!("x,y,z\n3,0,0\n{}", "x,0,0\n".repeat(5000)),
    );
    let run = folder.nappe("project model.nappe.toml --points many.csv -o out.csv");
    assert!(
        run.stderr.contains("and 4990 more problems in other rows"),
        "{}",
        run.stderr
    );
    assert!(
        run.stderr.contains("5000 of 5001 points have no answer"),
        "{}",
        run.stderr
    );
    let out = String::from_utf8(folder.read("out.csv")).unwrap();
    assert_eq!(
        out.lines().filter(|l| l.ends_with(",unreadable")).count(),
        5000
    );
}

#[test]
fn what_is_no_table_of_points_is_refused() {
    let folder = Folder::with_model(MODEL);
    folder.write("out.csv", "old");
    for (name, input) in [
        ("empty", ""),
        ("header", "x,y,z\n"),
        ("lacks", "id,x,y\n1,2,3\n"),
        ("wide", "1,2,3,4\n"),
        ("twice", "x,y,z,distance\n1,2,3,4\n"),
        ("words", "just some words\nand more\n"),
    ] {
        folder.write("points.csv", input);
        let run = folder.nappe("project model.nappe.toml --points points.csv -o out.csv");
        assert_snapshot!(format!("project-no-table-{name}"), run.problem());
        assert_eq!(folder.read("out.csv"), b"old", "{name}");
        let run = folder.nappe("project model.nappe.toml --points points.csv");
        assert_eq!(run.code, 1);
        assert!(run.stdout.is_empty(), "{name}");
    }
    let refused = folder.nappe("project model.nappe.toml --points none.csv");
    assert!(
        refused
            .problem()
            .contains("none.csv: could not read the points")
    );
    let refused = folder.nappe("project model.nappe.toml --points points.csv --surface bal");
    assert!(
        refused.problem().contains("did you mean `ball`?"),
        "{}",
        refused.stderr
    );
    let bare =
        Folder::with_model("[curves.rod]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n");
    let refused = bare.nappe_with("project model.nappe.toml", b"0,0,0\n");
    assert!(
        refused.problem().contains("there is no surface"),
        "{}",
        refused.stderr
    );
}

#[test]
fn signs_all_places_and_curves() {
    let folder = Folder::with_model(MODEL);
    let input = b"0.5,0,0\n3,0,0\n0.5,0.5,-4.5\n0.5,0.5,-6\n9,9,-5\n0,0,0\n";
    let rows = table(&folder.nappe_with("project model.nappe.toml --signed", input));
    for (row, exact) in rows
        .iter()
        .zip([Some(-1.5), Some(1.0), Some(0.5), Some(-1.0), None])
    {
        match exact {
            Some(exact) => assert!((number(&row["signed"]) - exact).abs() < 1e-8, "{row:?}"),
            None => assert_eq!(row["signed"], ""),
        }
    }
    // The middle of the ball: inside, though all of its points are equally near.
    assert!(
        number(&rows[5]["signed"]) < -1.9 && rows[5]["status"] == "gap",
        "{:?}",
        rows[5]
    );

    let all = folder.nappe_with(
        "project model.nappe.toml --all --tolerance 1e-5",
        b"0,0,0\n0,0,-3.5\n1,0,0\n",
    );
    let rows = table(&all);
    let of = |z: &str| {
        rows.iter()
            .filter(|r| r["pz"] == z && r["px"] == "0.0")
            .count()
    };
    assert_eq!((rows.len(), of("0.0"), of("-3.5")), (4, 1, 2));
    assert_eq!(
        (rows[0]["locus"].as_str(), number(&rows[0]["extent"]) > 3.0),
        ("spread", true)
    );
    assert!(rows[1..].iter().all(|r| r["locus"] == "point"));
    let mut names: Vec<&str> = rows[1..3].iter().map(|r| r["surface"].as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["ball", "plate"]);

    let run = folder.nappe_with("project model.nappe.toml --curve rod", b"3,4,0\n-3,0,4\n");
    assert!(
        run.data()
            .starts_with("px,py,pz,distance,curve,t,x,y,z,gap,status\n")
    );
    let rows = table(&run);
    assert!((number(&rows[0]["distance"]) - 4.0).abs() < 1e-8);
    assert!((number(&rows[0]["t"]) - 0.3).abs() < 1e-8);
    assert!((number(&rows[1]["distance"]) - 5.0).abs() < 1e-8);
}

#[test]
fn coordinates_of_any_size_are_answered_or_marked() {
    let folder = Folder::with_model(MODEL);
    let input = "1e6,0,0\n1e12,0,0\n-1e100,1e100,0\n1e-300,0,2.5\n1e308,1e308,1e308\n";
    let rows =
        table(&folder.nappe_with("project model.nappe.toml --surface ball", input.as_bytes()));
    for (row, exact) in rows
        .iter()
        .zip([1e6 - 2.0, 1e12 - 2.0, 2f64.sqrt() * 1e100, 0.5])
    {
        let (distance, gap) = (number(&row["distance"]), number(&row["gap"]));
        assert!((distance - exact).abs() <= gap, "{row:?}");
        assert!(
            gap <= 2e-8 || row["status"] == "gap" && gap <= 1e-12 * exact,
            "{row:?}"
        );
    }
    assert_eq!(rows[4]["status"], "no distance");
}

#[test]
fn no_row_is_skipped_and_no_text_changed_silently() {
    let folder = Folder::with_model(MODEL);
    // A mark at the beginning, Windows line ends, comments above the header, and texts that look like comments.
    let input = "\u{feff}# measured\r\n\r\nid,\"a \"\"b\"\"\",x,y,z\r\n#12,ä,3,0,0\r\n13,,0,4,0\r\n# 14,\"#\",0,0,5\r\n";
    let run = folder.nappe_with("project model.nappe.toml --format jsonl", input.as_bytes());
    let rows: Vec<serde_json::Value> = run
        .data()
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(rows.len(), 3, "{}", run.data());
    for (row, (id, text, distance)) in rows.iter().zip([
        ("#12", "ä".into(), 1.0),
        ("13", serde_json::Value::Null, 2.0),
        ("# 14", "#".into(), 3.0),
    ]) {
        assert_eq!((&row["id"], &row["a \"b\""]), (&id.into(), &text));
        assert!((row["distance"].as_f64().unwrap() - distance).abs() < 1e-8);
    }
    assert!(run.stderr.is_empty(), "{}", run.stderr);
    // A marked header names the columns; one without a mark may follow.
    for head in ["#z,y,x\n", "# z, y, x\n", "# x,y,z\nz,y,x\n"] {
        let input = format!("{head}1,2,3\n# 7,7,7\n4,5,6\n");
        let rows = table(&folder.nappe_with("project model.nappe.toml", input.as_bytes()));
        assert_eq!(rows.len(), 2, "{head}");
        let given = ["px", "py", "pz"].map(|c| number(&rows[0][c]));
        assert_eq!(given, [3.0, 2.0, 1.0], "{head}");
    }
    // What is about the columns in words is a comment.
    let rows =
        table(&folder.nappe_with("project model.nappe.toml", b"# x, y, z in metres\n1,2,3\n"));
    assert_eq!((rows.len(), number(&rows[0]["px"])), (1, 1.0));
    // Text in another encoding is noted once, with its line.
    let run = folder.nappe_with(
        "project model.nappe.toml",
        b"x,y,z,note\n3,0,0,plain\n3,0,0,caf\xe9\n3,0,0,\xfc\n",
    );
    assert_eq!(table(&run).len(), 3);
    assert_eq!(run.stderr.matches("not UTF-8").count(), 1, "{}", run.stderr);
    assert!(run.stderr.contains("standard input:3: "), "{}", run.stderr);
    // A line break within quotes makes no row of each half.
    let run = folder.nappe_with(
        "project model.nappe.toml",
        b"x,y,z,note\n3,0,0,\"first\n4,0,0,second\"\n5,0,0,\"whole\"\n",
    );
    let status: Vec<String> = table(&run).iter().map(|r| r["status"].clone()).collect();
    assert_eq!(status[0], "unreadable", "{}", run.stderr);
    assert_eq!(status.last().unwrap(), "ok");
    assert!(
        run.stderr
            .contains("standard input:2:7: the quote that begins here does not end in this line"),
        "{}",
        run.stderr
    );
}

#[test]
fn what_was_found_before_reading_stops_is_told() {
    let folder = Folder::with_model(MODEL);
    let long = "x".repeat((1 << 20) + 1);
    folder.write("points.csv", &format!("x,y,z\n1,two,3\n{long}\n"));
    for output in ["", " -o out.csv"] {
        let run = folder.nappe(&format!(
            "project model.nappe.toml --points points.csv{output}"
        ));
        let told = run.problem();
        let [bad, stop] = [
            "points.csv:2:3: y is `two`",
            "points.csv:3: the line is longer",
        ]
        .map(|what| told.find(what));
        assert!(bad.is_some() && bad < stop, "{told:.2000}");
        assert!(run.stdout.is_empty() && !folder.path("out.csv").exists());
    }
}

/// A plate so large that rounding makes its gap wider, hardly farther away than a ball.
#[test]
fn wide_gaps_of_later_places_are_counted() {
    let plate = MODEL.replace(
        "[[[0, 0, -5], [0, 1, -5]], [[1, 0, -5], [1, 1, -5]]]",
        "[[[-1e7, -1e7, 5.0000001], [-1e7, 1e7, 5.0000001]], [[1e7, -1e7, 5.0000001], [1e7, 1e7, 5.0000001]]]",
    );
    let folder = Folder::with_model(&plate);
    let run = folder.nappe_with(
        "project model.nappe.toml --all --tolerance 8e-7",
        b"0,0,-3\n0,0,3.5\n",
    );
    let rows = table(&run);
    let of = |row: &std::collections::HashMap<String, String>| {
        (
            row["pz"].clone(),
            row["surface"].clone(),
            row["status"].clone(),
        )
    };
    let found: Vec<_> = rows.iter().map(of).collect();
    let row = |pz: &str, surface: &str, status: &str| (pz.into(), surface.into(), status.into());
    let expected = [
        row("-3.0", "ball", "ok"),
        row("3.5", "ball", "ok"),
        row("3.5", "plate", "gap"),
    ];
    assert_eq!(found, expected);
    assert!(
        run.stderr
            .contains("1 of 2 points have a gap above the tolerance"),
        "{}",
        run.stderr
    );
}

#[test]
fn notes_say_what_signs_are_about() {
    let folder = Folder::with_model(MODEL);
    let closed = folder.nappe_with(
        "project model.nappe.toml --signed --surface ball",
        b"3,0,0\n",
    );
    assert!(
        closed.code == 0 && closed.stderr.is_empty(),
        "{}",
        closed.stderr
    );
    let mixed = folder.nappe_with("project model.nappe.toml --signed", b"3,0,0\n");
    assert!(
        mixed.stderr.contains(
            "1 of 2 surfaces close shells; of 1 the sign is that of the normal r_u × r_v"
        ),
        "{}",
        mixed.stderr
    );
}

#[test]
fn curves_without_a_box_have_a_tolerance() {
    let folder = Folder::with_model(
        "[curves.hump]\nkind = \"expression\"\nx = \"1/(t*t - t + 0.3)\"\ny = \"t\"\nz = \"0\"\ndomain = [0, 1]\n",
    );
    for all in ["", " --all"] {
        let run = folder.nappe_with(
            &format!("project model.nappe.toml --curve hump{all}"),
            b"25,0.5,0\n",
        );
        let rows = table(&run);
        assert_eq!((rows.len(), rows[0]["status"].as_str()), (1, "ok"));
        assert!((number(&rows[0]["distance"]) - 5.0).abs() < 1e-7);
    }
}

#[test]
fn the_example_points_lie_at_the_vase() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let run = crate::run::nappe(&root)
        .args(["project", "vase.nappe.toml", "--points", "vase-points.csv"])
        .args(["--signed", "--quiet"])
        .output()
        .unwrap();
    assert!(run.status.success(), "{run:?}");
    let run = Run {
        code: 0,
        stdout: run.stdout,
        stderr: String::from_utf8(run.stderr).unwrap(),
    };
    let rows = table(&run);
    assert_eq!(rows.len(), 10);
    assert!(rows.iter().all(|r| r["status"] == "ok"), "{rows:?}");
    let inside = rows.iter().find(|r| r["id"] == "inside").unwrap();
    let [x, y, z, signed, u] = ["x", "y", "z", "signed", "u"].map(|c| number(&inside[c]));
    // In the half plane of the point, near the belly, whose radius is 80 at a height of 86.4.
    assert!((4.0 * x - 3.0 * y).abs() < 1e-6 && x > 0.0 && (0.0..=1.0).contains(&u));
    assert!((signed + (x.hypot(y) - 5.0).hypot(z - 90.0)).abs() < 1e-8);
    assert!((-75.0f64.hypot(3.6)..-70.0).contains(&signed) && inside["surface"] == "wall");
    // The foot is flat, its normal points down.
    for (id, exact) in [("foot-1", 0.1), ("foot-2", -0.2)] {
        let row = rows.iter().find(|r| r["id"] == id).unwrap();
        assert!((number(&row["signed"]) - exact).abs() < 1e-6, "{row:?}");
        assert_eq!(row["surface"], "foot");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::with_model(MODEL);
    folder.write("points.csv", &csv(&points(20_000)));
    let mut child = nappe(&folder.path(""))
        .args(["project", "model.nappe.toml", "--points", "points.csv"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 16];
    std::io::Read::read_exact(child.stdout.as_mut().unwrap(), &mut first).unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{output:?}"
    );
}
