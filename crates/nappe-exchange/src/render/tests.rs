//! Pictures are judged by what must be true of them.

use super::*;
use crate::samples::{cube, grid, saddle, sphere, torus};
use crate::tests::save;
use crate::{Field, Part};
use glam::DVec2;
use nappe::mesh::Mesh;
use std::f64::consts::{PI, TAU};

fn png(picture: &Picture<'_>, name: &str) -> Vec<u8> {
    let bytes = pixels::png(&picture.stage().unwrap(), Progress::default()).unwrap();
    save(&format!("{name}.png"), &bytes);
    bytes
}

fn svg_text(picture: &Picture<'_>, name: &str) -> String {
    let (text, _) = svg::svg(&picture.stage().unwrap(), Progress::default());
    save(&format!("{name}.svg"), text.as_bytes());
    text
}

/// Parallel, from the front, nothing but the surfaces.
fn plain(side: u32) -> PictureOptions {
    PictureOptions {
        size: [side, side],
        view: View::FRONT,
        projection: Projection::Parallel,
        background: Background::Transparent,
        borders: false,
        axes: false,
        title: false,
        ..Default::default()
    }
}

fn draw(picture: &Picture<'_>) -> (ink::Ink, lines::Depth) {
    pixels::draw(&picture.stage().unwrap(), Progress::default())
}

/// Two squares facing the front, one behind the other; the nearer one is listed first.
fn squares() -> Scene {
    let mut mesh = Mesh::default();
    for y in [0.0, 3.0] {
        let (points, mut patch) = grid(1, 1, [false, false], |u, v| {
            (DVec3::new(u + y / 6.0, y, v + y / 6.0), -DVec3::Y)
        });
        let first = mesh.points.len() as u32;
        mesh.points.extend(points);
        patch.vertices.iter_mut().for_each(|v| v.point += first);
        mesh.patches.push(patch);
    }
    let part = |name: &str, patch, colour| Part {
        name: name.into(),
        colour,
        patch,
    };
    let parts = vec![
        part("near", 0, [0.9, 0.2, 0.2]),
        part("far", 1, [0.2, 0.2, 0.9]),
    ];
    Scene {
        mesh,
        parts,
        ..Scene::default()
    }
}

/// The rings of an SVG path of relative lines.
fn rings(d: &str) -> Vec<Vec<DVec2>> {
    let ring = |text: &str| {
        let numbers: Vec<f64> = text
            .split(['l', ' '])
            .filter(|s| !s.is_empty())
            .map(|s| s.parse().unwrap())
            .collect();
        let mut at = DVec2::ZERO;
        numbers
            .chunks(2)
            .map(|c| {
                at += DVec2::new(c[0], c[1]);
                at
            })
            .collect()
    };
    d.split('M')
        .filter(|s| !s.is_empty())
        .map(|s| ring(s.trim_end_matches('z')))
        .collect()
}

fn area(d: &str) -> f64 {
    let of = |r: &Vec<DVec2>| {
        (0..r.len())
            .map(|i| r[i].perp_dot(r[(i + 1) % r.len()]))
            .sum::<f64>()
            / 2.0
    };
    rings(d).iter().map(of).sum()
}

/// Fill and path data of the filled shapes.
fn filled(text: &str) -> Vec<(String, String)> {
    let xml = roxmltree::Document::parse(text).unwrap();
    xml.descendants()
        .filter(|n| n.has_tag_name("path") && n.attribute("fill").is_some())
        .map(|n| {
            (
                n.attribute("fill").unwrap().to_owned(),
                n.attribute("d").unwrap().to_owned(),
            )
        })
        .collect()
}

#[test]
fn the_silhouette_of_a_sphere_is_a_disc_of_right_area() {
    let scene = sphere(400, 200);
    let picture = Picture::new(&scene, plain(400));
    let (ink, _) = draw(&picture);
    // The margin is 44 of 800.
    let radius = 400.0 * (0.5 - 44.0 / 800.0);
    let cover: f64 = ink.pixels.iter().map(|p| f64::from(p[3])).sum();
    let disc = PI * radius * radius;
    assert!((cover / disc - 1.0).abs() < 1e-3, "{cover} {disc}");
    let shapes: f64 = filled(&svg_text(&picture, "disc"))
        .iter()
        .map(|(_, d)| area(d))
        .sum();
    // Coordinates are rounded to tenths of a pixel.
    assert!((shapes / disc - 1.0).abs() < 3e-3, "{shapes} {disc}");
}

#[test]
fn the_nearer_surface_is_seen_whatever_the_order() {
    for turned in [false, true] {
        let mut scene = squares();
        if turned {
            scene.parts.reverse();
        }
        let picture = Picture::new(&scene, plain(300));
        let (ink, depth) = draw(&picture);
        let at = |x: usize, y: usize| (ink.pixels[y * 300 + x], depth.far[y * 300 + x]);
        // The squares overlap in the middle; only the far one is at the upper right.
        let ((near, d0), (far, d1)) = (at(150, 150), at(270, 30));
        assert!(near[0] > near[2] && far[2] > far[0], "{near:?} {far:?}");
        assert!((f64::from(d1 - d0) - 3.0).abs() < 1e-5);
        let text = svg_text(&picture, "squares");
        let blue = |c: &str| {
            u8::from_str_radix(&c[5..7], 16).unwrap() > u8::from_str_radix(&c[1..3], 16).unwrap()
        };
        let order: Vec<bool> = filled(&text).iter().map(|(c, _)| blue(c)).collect();
        assert!(
            order.len() >= 2 && order.is_sorted_by(|a, b| a >= b),
            "{order:?}"
        );
    }
}

#[test]
fn a_symmetric_scene_gives_a_symmetric_outline() {
    let scene = torus(3.0, 1.0, 96, 48);
    let options = PictureOptions {
        view: View::at(0.0, 0.6),
        projection: Projection::default(),
        ..plain(301)
    };
    let (ink, depth) = draw(&Picture::new(&scene, options));
    let mut covered = 0;
    for y in 0..301 {
        for x in 0..150 {
            let (a, b) = (y * 301 + x, y * 301 + 300 - x);
            assert!((ink.pixels[a][3] - ink.pixels[b][3]).abs() < 0.07);
            if depth.far[a].is_finite() && depth.far[b].is_finite() {
                assert!((depth.far[a] - depth.far[b]).abs() < 1e-4 * depth.far[a]);
                covered += 1;
            }
        }
    }
    assert!(covered > 5000);
}

#[test]
fn the_same_scene_gives_the_same_bytes_at_any_scale() {
    let mut scene = torus(3.0, 1.0, 48, 24);
    scene.title = Some("A title".into());
    let options = PictureOptions {
        size: [320, 240],
        ..Default::default()
    };
    let first = png(&Picture::new(&scene, options.clone()), "scale");
    let text = svg_text(&Picture::new(&scene, options.clone()), "scale");
    // Powers of two change no digits.
    for scale in [1.0, 2f64.powi(20), 2f64.powi(-20)] {
        let mut other = scene.clone();
        other.mesh.points.iter_mut().for_each(|p| *p *= scale);
        other.mesh.patches[0].deviation = nappe::mesh::Certainty::Bounded(1e-2 * scale);
        assert!(
            png(&Picture::new(&other, options.clone()), "scale") == first,
            "{scale}"
        );
        assert!(
            svg_text(&Picture::new(&other, options.clone()), "scale") == text,
            "{scale}"
        );
    }
}

#[test]
fn hidden_lines_are_hidden_where_the_surface_is() {
    let scene = sphere(400, 200);
    let line = |y: f64| vec![DVec3::new(-2.0, y, 0.0), DVec3::new(2.0, y, 0.0)];
    let picture =
        Picture::new(&scene, plain(400)).lines([-2.0, 2.0].map(|y| Line::isoline(line(y))));
    let stage = picture.stage().unwrap();
    let (_, depth) = draw(&picture);
    let length = |spans: &[lines::Span], seen: bool| -> f64 {
        let of = |s: &lines::Span| {
            s.points
                .windows(2)
                .map(|p| (p[1] - p[0]).length())
                .sum::<f64>()
        };
        spans.iter().filter(|s| s.seen == seen).map(of).sum()
    };
    let whole = 400.0 * (1.0 - 88.0 / 800.0);
    let before = lines::spans(&line(-2.0), &stage.camera, &depth, stage.bias);
    assert_eq!(before.len(), 1);
    assert!((length(&before, true) - whole).abs() < 1e-9);
    let behind = lines::spans(&line(2.0), &stage.camera, &depth, stage.bias);
    assert_eq!(
        behind.iter().map(|s| s.seen).collect::<Vec<_>>(),
        [true, false, true]
    );
    // The sphere covers half of the line.
    assert!(
        (length(&behind, false) - whole / 2.0).abs() < 4.0,
        "{}",
        length(&behind, false)
    );
    // Of a circle on the sphere just the half that faces the eye is seen. (This one crosses the outline squarely.)
    let circle: Vec<DVec3> = (0..=360)
        .map(|k| (TAU * k as f64 / 360.0).sin_cos())
        .map(|(s, c)| DVec3::new(0.0, s, c))
        .collect();
    let tilted = PictureOptions {
        view: View::at(0.0, 0.7),
        ..plain(400)
    };
    let picture = Picture::new(&scene, tilted);
    let stage = picture.stage().unwrap();
    let (_, depth) = draw(&picture);
    let spans = lines::spans(&circle, &stage.camera, &depth, stage.bias);
    let share = length(&spans, true) / (length(&spans, true) + length(&spans, false));
    assert!((share - 0.5).abs() < 0.01, "{share}");
}

#[test]
fn stripes_of_both_kinds_of_picture_agree() {
    let scene = saddle(40);
    let options = PictureOptions {
        paint: Paint::Zebra { stripes: 8 },
        view: View::ISO,
        projection: Projection::default(),
        ..plain(400)
    };
    let picture = Picture::new(&scene, options);
    let (ink, _) = draw(&picture);
    let dark: f64 = ink
        .pixels
        .iter()
        .filter(|p| p[3] > 0.0 && colour::linear(p[0]) < 0.45)
        .map(|p| f64::from(p[3]))
        .sum();
    let vectors: f64 = filled(&svg_text(&picture, "stripes"))
        .iter()
        .filter(|(c, _)| u8::from_str_radix(&c[1..3], 16).unwrap() < 128)
        .map(|(_, d)| area(d))
        .sum();
    assert!(
        dark > 5000.0 && (vectors / dark - 1.0).abs() < 0.02,
        "{vectors} {dark}"
    );
}

#[test]
fn colours_of_a_field_are_those_of_the_legend() {
    // A square facing the eye whose field is x: colours must run over the whole legend from left to right.
    let (points, patch) = grid(4, 4, [false, false], |u, v| {
        (DVec3::new(u, 0.0, v), -DVec3::Y)
    });
    let values = vec![patch.vertices.iter().map(|v| 100.0 * v.uv[0]).collect()];
    let mut scene = Scene::from_mesh(
        Mesh {
            points,
            patches: vec![patch],
        },
        ["square"],
        Default::default(),
    );
    scene.fields.push(Field {
        name: "height <x>".into(),
        unit: "mm".into(),
        values,
        unbounded: [false; 2],
    });
    let paint = Paint::Field {
        index: 0,
        map: ColourMap::Auto,
        range: None,
    };
    let picture = Picture::new(
        &scene,
        PictureOptions {
            paint,
            ..plain(400)
        },
    );
    let stage = picture.stage().unwrap();
    let scale = stage.scale.as_ref().unwrap();
    assert_eq!(
        (scale.lo, scale.hi, scale.map),
        (0.0, 100.0, ColourMap::Sequential)
    );
    let (ink, _) = draw(&picture);
    for k in 1..10 {
        let share = k as f64 / 10.0;
        let p = stage.camera.project(DVec3::new(share, 0.0, 0.5));
        let seen = ink.pixels[p.y as usize * 400 + p.x as usize];
        let want = colour::mapped(ColourMap::Sequential, share);
        // The light darkens all channels by one factor.
        let ratio = [0, 1, 2].map(|c| colour::linear(seen[c]) / colour::linear(want[c]));
        assert!(
            ratio
                .iter()
                .all(|r| (r - ratio[0]).abs() < 0.1 && *r > 0.6 && *r < 1.01),
            "{ratio:?}"
        );
    }
    let text = svg_text(&picture, "field");
    let xml = roxmltree::Document::parse(&text).unwrap();
    let texts: Vec<_> = xml
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text())
        .collect();
    for want in ["height <x>", "in mm", "0", "20", "100"] {
        assert!(texts.contains(&want), "{texts:?}");
    }
}

#[test]
fn files_are_pictures_of_the_size_asked_for_and_bad_requests_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let scene = cube();
    let path = dir.path().join("a.png");
    let options = crate::WriteOptions {
        picture: PictureOptions {
            size: [123, 77],
            ..Default::default()
        },
        ..Default::default()
    };
    let report = crate::write(&path, &scene, &options).unwrap();
    assert_eq!(report.triangles, 12);
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = ::png::Decoder::new(file).read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    assert_eq!((info.width, info.height), (123, 77));
    std::fs::remove_file(&path).unwrap();
    let fails = |options: PictureOptions, nets: Vec<Net>| match Picture::new(&scene, options)
        .nets(nets)
        .write(&path, Progress::default())
    {
        Err(ExchangeError::Picture { source, .. }) => source,
        other => panic!("{other:?}"),
    };
    let with = |change: fn(&mut PictureOptions)| {
        let mut options = PictureOptions::default();
        change(&mut options);
        fails(options, vec![])
    };
    assert!(matches!(
        with(|o| o.size = [0, 10]),
        PictureError::Size { width: 0, .. }
    ));
    assert!(matches!(
        with(|o| o.line_width = f64::NAN),
        PictureError::Range { .. }
    ));
    assert!(matches!(
        with(|o| o.view.roll = f64::INFINITY),
        PictureError::Range { .. }
    ));
    assert!(matches!(
        with(|o| o.projection = Projection::Perspective { field_of_view: 3.0 }),
        PictureError::FieldOfView { .. }
    ));
    assert!(matches!(
        with(|o| o.paint = Paint::Field {
            index: 0,
            map: ColourMap::Auto,
            range: None
        }),
        PictureError::NoField {
            index: 0,
            fields: 0
        }
    ));
    let net = Net::new("n", vec![DVec3::ZERO; 5], 2);
    assert!(matches!(
        fails(PictureOptions::default(), vec![net]),
        PictureError::Net {
            points: 5,
            columns: 2,
            ..
        }
    ));
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn degenerate_scenes_are_drawn_without_harm() {
    // A curve only; a surface seen edge on; a single line along the sight.
    let curve = |a: DVec3, b: DVec3| Scene {
        curves: vec![crate::Polyline {
            name: "c".into(),
            points: vec![a, b],
        }],
        ..Scene::default()
    };
    let flat = {
        let (points, patch) = grid(3, 3, [false, false], |u, v| {
            (DVec3::new(u, v, 0.0), DVec3::Z)
        });
        Scene::from_mesh(
            Mesh {
                points,
                patches: vec![patch],
            },
            ["flat"],
            Default::default(),
        )
    };
    let scenes = [
        curve(DVec3::ZERO, DVec3::X),
        curve(DVec3::ZERO, DVec3::Y),
        curve(DVec3::ONE, DVec3::ONE),
        flat,
    ];
    for scene in &scenes {
        for projection in [Projection::Parallel, Projection::default()] {
            let options = PictureOptions {
                projection,
                borders: true,
                ..plain(64)
            };
            let picture = Picture::new(scene, options);
            let (ink, _) = draw(&picture);
            assert!(ink.pixels.iter().flatten().all(|c| (0.0..=1.0).contains(c)));
            assert!(ink.pixels.iter().any(|p| p[3] > 0.2), "nothing is seen");
            let text = svg_text(&picture, "degenerate");
            assert!(!text.contains("NaN") && !text.contains("inf"));
        }
    }
}

/// For a person to look at: run with `NAPPE_KEEP=<directory>`.
#[test]
fn pictures_of_all_kinds_are_drawn() {
    let scene = Scene {
        title: Some("Torus, Krümmung, Кривизна".into()),
        ..torus(3.0, 1.2, 96, 48)
    };
    let big = PictureOptions {
        size: [600, 450],
        ..Default::default()
    };
    let field = |index| Paint::Field {
        index,
        map: ColourMap::Auto,
        range: Some([-0.2, 0.2]),
    };
    let saddle = saddle(40);
    let run = |c: f64, flip: bool| {
        let at = move |t: f64| {
            if flip {
                DVec3::new(c, t, c * t)
            } else {
                DVec3::new(t, c, c * t)
            }
        };
        Line::isoline((0..=60).map(|i| at(i as f64 / 30.0 - 1.0)).collect())
    };
    let iso = (1..10).flat_map(|k| [false, true].map(|flip| run(k as f64 / 5.0 - 1.0, flip)));
    let net = (0..9)
        .map(|k| DVec2::new((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0))
        .map(|p| p.extend(1.5 * p.x * p.y));
    let cube = cube();
    let pictures = [
        ("torus", Picture::new(&scene, big.clone())),
        (
            "gauss",
            Picture::new(
                &scene,
                PictureOptions {
                    paint: field(0),
                    ..big.clone()
                },
            ),
        ),
        (
            "mean",
            Picture::new(
                &scene,
                PictureOptions {
                    paint: field(1),
                    background: Background::Dark,
                    ..big.clone()
                },
            ),
        ),
        (
            "saddle",
            Picture::new(&saddle, big.clone())
                .lines(iso)
                .nets([Net::new("net", net.collect(), 3)]),
        ),
        (
            "zebra",
            Picture::new(
                &scene,
                PictureOptions {
                    paint: Paint::Zebra { stripes: 10 },
                    ..big.clone()
                },
            ),
        ),
        (
            "cube",
            Picture::new(
                &cube,
                PictureOptions {
                    view: View::at(0.5, 0.4),
                    ..big
                },
            ),
        ),
    ];
    for (name, picture) in &pictures {
        let (bytes, text) = (png(picture, name), svg_text(picture, name));
        assert!(bytes.len() > 5000 && text.len() > 1000);
        roxmltree::Document::parse(&text).unwrap();
        // A vector picture stays smaller than a mesh would be.
        assert!(text.len() < 1_000_000, "{name}: {}", text.len());
    }
}

/// A dot has its colour where it is seen, and is fainter where a surface hides it; the key names it.
#[test]
fn dots_and_their_key() {
    let scene = squares();
    let dot = |y: f64| Dot {
        at: DVec3::new(0.7, y, 0.7),
        colour: [0.0, 0.8, 0.0],
        radius: 40.0,
    };
    let entry = |colour, dot, text: &str| KeyEntry {
        colour,
        width: 6.0,
        dot,
        text: text.into(),
    };
    let green = |y: f64| {
        let picture = Picture::new(&scene, plain(400)).dots([dot(y)]);
        let stage = picture.stage().unwrap();
        let p = stage.camera.project(dot(y).at);
        let [r, g, _, _] = draw(&picture).0.pixels[p.y as usize * 400 + p.x as usize];
        g - r
    };
    let (seen, hidden, without) = (green(-1.0), green(1.5), {
        let picture = Picture::new(&scene, plain(400));
        let p = picture.stage().unwrap().camera.project(dot(1.5).at);
        let [r, g, _, _] = draw(&picture).0.pixels[p.y as usize * 400 + p.x as usize];
        g - r
    });
    assert!(seen > 0.5 && hidden > without + 0.05 && hidden < seen - 0.2);

    let key = [
        entry([0.0, 0.8, 0.0], true, "a place"),
        entry([0.8, 0.0, 0.0], false, "a line & more"),
    ];
    let picture = Picture::new(&scene, plain(400)).dots([dot(-1.0)]);
    let with = picture.clone().key(key);
    let text = svg_text(&with, "key");
    assert!(text.contains(">a place</text>") && text.contains(">a line &amp; more</text>"));
    // Its room is taken from the scene, which stays left of it.
    let widest = |picture: &Picture<'_>| {
        let stage = picture.stage().unwrap();
        let points = scene.mesh.points.iter();
        let x = points.map(|p| stage.camera.project(*p).x);
        x.fold(0.0, f64::max)
    };
    let left = |m: &marks::Mark| match m {
        marks::Mark::Stroke { from, .. } => from.x,
        marks::Mark::Text { at, .. } => at.x,
        marks::Mark::Bar { min, .. } => min.x,
    };
    let stage = with.stage().unwrap();
    let first = stage.marks.iter().map(left).fold(f64::INFINITY, f64::min);
    assert_eq!(stage.marks.len(), 4);
    assert!(widest(&with) < first && widest(&picture) > widest(&with));

    let nowhere = Dot {
        at: DVec3::new(0.0, f64::NAN, 0.0),
        ..dot(0.0)
    };
    assert!(matches!(
        Picture::new(&scene, plain(400))
            .dots([dot(0.0), nowhere])
            .stage(),
        Err(PictureError::DotNotFinite { index: 1, .. })
    ));
}
