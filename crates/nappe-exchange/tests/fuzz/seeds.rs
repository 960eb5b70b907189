//! Small valid files of every format.

use nappe::body::sew;
use nappe::curve::Line;
use nappe::surface::{SurfaceRef, Torus, TorusOptions, bilinear, ruled};
use nappe::{DAffine3, DVec3, Dir, NurbsCurve, Revolution, RevolutionOptions};
use nappe_exchange::iges;
use nappe_exchange::{
    Document, Item, ItemForm, Progress, Scene, WriteOptions, mesh_document, write,
};
use std::io::{Cursor, Read, Write};
use std::sync::Arc;
use zip::write::SimpleFileOptions;

const NURBS: &str = "<?xml version=\"1.0\"?>\n<xml>\n<Geometry type=\"Nurbs\" label=\"arc\">\n<Basis type=\"NurbsBasis\"><Basis type=\"BSplineBasis\">\n<KnotVector degree=\"2\">0 0 0 1 1 1</KnotVector></Basis>\n<weights>1 0.70710678118654757 1</weights></Basis>\n<coefs geoDim=\"2\">1 0 1 1\n0 1</coefs>\n</Geometry>\n<MultiPatch/></xml>";
const NET: &str = "<xml><Geometry type=\"TensorBSpline2\"><Basis type=\"TensorBSplineBasis2\"><Basis type=\"BSplineBasis\" index=\"0\"><KnotVector degree=\"1\">0 0 1 2 2</KnotVector></Basis><Basis type=\"BSplineBasis\" index=\"1\"><KnotVector degree=\"1\">0 0 3 3</KnotVector></Basis></Basis><coefs geoDim=\"3\">0 0 0 1 0 0 2 0 5 0 3 0 1 3 0 2 3 0</coefs></Geometry></xml>";
const BEZIER: &str =
    "2\n2 1\n0 0 0\n1 0 2\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0\n";
const AEROFOIL: &str =
    "A section\n1.0 0.001\n0.5 0.06\n0.1 0.04\n0.0 0.0\n0.1 -0.03\n0.5 -0.02\n1.0 -0.001\n";
const STATIONS: &str =
    "Another\n3. 3.\n\n0.0 0.0\n0.5 0.06\n1.0 0.001\n\n0.0 0.0\n0.5 -0.02\n1.0 -0.001\n";
const POINTS: &str = "\"a\"\n0,0,0;1,0,0\n0,1,0;1,2,1\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const POLYGONS: &str = "mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 0.2 0\nv 0 1 0\nusemtl red\nf 1 2 3 4 5\nf 1/1/1 2/2/2 -1\nl 1 2 3\ncurv 0 1 1 2\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment a\nelement vertex 5\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0.5 0.2 0 4\n0 1 0 5\n5 0 1 2 3 4\n3 0 1 2\n";

/// Curves of several kinds in places of places, as shapes of a compound.
fn brep() -> String {
    let curves = [
        "1 1 1 1 0 0.6 0.8",
        "3 1 2 3 0 0 1 1 0 0 0 1 0 5 2",
        "7 1 1 2 4 5 0 0 0 1 2 0 0 1 2 2 0 1 0 2 0 1 0 1 1 1 2 1 3 1 4 1",
        "8 -2 2 5 1 2 3 0 0 1 1 0 0 0 1 0 3 4",
    ];
    let n = curves.len();
    let mut text = String::from(
        "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nLocations 2\n1 0 -1 0 0 1 0 0 0 0 0 1 0\n2 1 3 0\n",
    );
    text += &format!("Curve2ds 0\nCurves {n}\n");
    curves.iter().for_each(|c| text += &format!("{c}\n"));
    text += "Polygon3D 0\nPolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\n\n";
    text += &format!("TShapes {}\n", n + 1);
    for i in 1..=n {
        text += &format!("Ed\n 1e-007 1 1 0\n1  {i} 0 0.25 1.5\n0\n\n0101000\n*\n");
    }
    text += "Co\n\n1100000\n";
    (0..n).for_each(|i| text += &format!("+{} 0 ", n + 1 - i));
    text + "*\n\n+1 2 \n"
}

/// A sheet of two plates, a cylinder, a torus, and a line.
fn document() -> Document {
    let plate = |y: f64, z: f64| -> SurfaceRef {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let corners = [
            [at(0.0, 0.0, 0.0), at(0.0, y, z)],
            [at(1.0, 0.0, 0.0), at(1.0, y, z)],
        ];
        Arc::new(bilinear(corners).unwrap())
    };
    let wall = Line::new(DVec3::X, DVec3::new(1.0, 0.0, 2.0)).unwrap();
    let wall = Revolution::new(
        Arc::new(wall),
        nappe::Frame::WORLD,
        RevolutionOptions::default(),
    );
    let ring = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
    let bodies: [Vec<SurfaceRef>; 3] = [
        vec![plate(1.0, 0.0), plate(0.0, 1.0)],
        vec![Arc::new(wall.unwrap())],
        vec![Arc::new(ring)],
    ];
    let item = |form| Item {
        name: "it's a part".into(),
        colour: Some([0.25, 0.5, 0.75]),
        form,
    };
    let mut items: Vec<Item> = bodies
        .iter()
        .map(|b| {
            item(ItemForm::Body {
                body: sew(b, 1e-9).body,
                faces: Vec::new(),
            })
        })
        .collect();
    let line = Line::new(DVec3::ZERO, DVec3::ONE).unwrap();
    items.push(item(ItemForm::Curve(Arc::new(line))));
    Document {
        name: Some("whole".into()),
        items,
        ..Document::default()
    }
}

/// A part of a turn of a spline, and a spline that is moved.
fn swept() -> Document {
    let points = [
        [2.0, 0.0, 0.0],
        [3.0, 0.0, 1.0],
        [1.0, 0.0, 2.0],
        [0.0, 0.0, 2.0],
    ];
    let curve = NurbsCurve::bezier(&points.map(DVec3::from), None).unwrap();
    let other = curve.transformed(&DAffine3::from_translation(DVec3::Y));
    let options = RevolutionOptions {
        angle: 2.0,
        ..RevolutionOptions::default()
    };
    let turned = Revolution::new(Arc::new(curve.clone()), nappe::Frame::WORLD, options);
    let moved = ruled(Arc::new(curve), Arc::new(other), Dir::U);
    let surfaces: [SurfaceRef; 2] = [Arc::new(turned.unwrap()), Arc::new(moved.unwrap())];
    let item = |surface| Item {
        name: String::new(),
        colour: None,
        form: ItemForm::Body {
            body: sew(&[surface], 1e-9).body,
            faces: Vec::new(),
        },
    };
    Document {
        items: surfaces.into_iter().map(item).collect(),
        ..Document::default()
    }
}

fn written(ending: &str, scene: &Scene) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(format!("a.{ending}"));
    write(&path, scene, &WriteOptions::default()).unwrap();
    std::fs::read(path).unwrap()
}

/// Small valid files of a format.
pub(crate) fn of(ending: &str) -> Vec<Vec<u8>> {
    let texts: &[&str] = match ending {
        "xml" => &[NURBS, NET],
        "bpt" => &[BEZIER],
        "dat" => &[AEROFOIL, STATIONS],
        "cpt" => &[POINTS],
        "stl" => &[STL],
        "obj" => &[POLYGONS],
        "ply" => &[PLY],
        _ => &[],
    };
    let mut all: Vec<Vec<u8>> = texts.iter().map(|t| t.as_bytes().to_vec()).collect();
    match ending {
        "brep" => all.push(brep().into_bytes()),
        "step" | "igs" => {
            let scene = Scene {
                document: document(),
                ..Scene::default()
            };
            all.push(written(ending, &scene));
            let swept = Scene {
                document: swept(),
                ..Scene::default()
            };
            all.push(written(ending, &swept));
            if ending == "igs" {
                let dir = tempfile::tempdir().unwrap();
                let path = dir.path().join("a.igs");
                let options = iges::IgesOptions {
                    tolerance: 1e-6,
                    trimmed: true,
                };
                iges::write(&path, &scene.document, &options).unwrap();
                all.push(std::fs::read(path).unwrap());
            }
        }
        "stl" | "obj" | "ply" | "glb" | "gltf" | "3mf" => {
            let made = mesh_document(&document(), Some(0.2), Progress::default());
            all.push(written(ending, &made.scene));
        }
        _ => {}
    }
    all
}

const MODEL: &str = "3D/3dmodel.model";

/// The model in a package.
pub(crate) fn unpacked(package: &[u8]) -> Vec<u8> {
    let mut all = zip::ZipArchive::new(Cursor::new(package)).unwrap();
    let mut out = Vec::new();
    let mut file = all.by_name(MODEL).unwrap();
    file.read_to_end(&mut out).unwrap();
    out
}

/// A package with nothing but a model.
pub(crate) fn packed(model: &[u8]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    zip.start_file(MODEL, options).unwrap();
    zip.write_all(model).unwrap();
    zip.finish().unwrap().into_inner()
}
