//! Bodies, made on several threads and put in the document in the order of the file.

use super::faces::Builder;
use super::file::{File, Refused};
use super::left::Left;
use super::place::Space;
use crate::document::Lost;
use crate::{Colour, FaceStyle, Item, ItemForm};
use nappe::parallel;
use std::collections::HashMap;

/// What a body of the file is made of.
pub(super) enum Source {
    /// Shells, all but the first of which are hollows if it is a solid.
    Shells { shells: Vec<u64>, solid: bool },
    /// A face by itself.
    Face,
}

/// A body that is to be made.
pub(super) struct Job<'a> {
    pub(super) space: Space<'a>,
    /// The names on the way to it.
    pub(super) path: Vec<String>,
    pub(super) id: u64,
    pub(super) source: Source,
    pub(super) colour: Option<Colour>,
}

/// What comes next in the document.
pub(super) enum Next<'a> {
    Item(Item),
    Left(Refused, Lost),
    Job(Box<Job<'a>>),
}

/// So many things wait at most until they are made.
pub(super) const WAITING: usize = 512;
/// While bodies are made on several threads, each may read this part of what may be read at all. More have to be made one
/// after the other, so that what is refused does not depend on the threads.
const SHARE: u64 = 64;

/// A body that was made, or why not.
struct Made {
    left: Left,
    item: Option<Item>,
    reads: u64,
    spent: bool,
}

/// Makes what waits: items and what is left out go to `items` and `left`, in order.
pub(super) fn make(
    file: &File<'_>,
    colours: &HashMap<u64, Colour>,
    threads: usize,
    waiting: Vec<Next<'_>>,
    items: &mut Vec<Item>,
    left: &mut Left,
) {
    let jobs: Vec<&Job<'_>> = waiting
        .iter()
        .filter_map(|n| match n {
            Next::Job(job) => Some(job.as_ref()),
            _ => None,
        })
        .collect();
    // A single body has all threads for itself.
    let own = (threads / jobs.len().max(1)).max(1);
    let run = |i: usize| jobs[i].run(&file.view(SHARE), own, colours);
    let mut made = parallel::each(threads, jobs.len(), run, |m| m.spent);
    let spent = made.iter().any(|m| m.spent);
    if spent {
        made.clear();
        for job in &jobs {
            let done = job.run(&file.view(1), threads, colours);
            file.add_reads(done.reads);
            made.push(done);
        }
    } else {
        file.add_reads(made.iter().map(|m| m.reads).sum());
    }
    let mut made = made.into_iter();
    for next in waiting {
        match next {
            Next::Item(item) => items.push(item),
            Next::Left(refused, lost) => left.put(&refused, lost),
            Next::Job(_) => {
                if let Some(made) = made.next() {
                    left.append(made.left);
                    items.extend(made.item);
                }
            }
        }
    }
}

impl Job<'_> {
    /// Makes the body, whose reads count for `file`.
    fn run(&self, file: &File<'_>, threads: usize, colours: &HashMap<u64, Colour>) -> Made {
        let before = file.reads();
        let space = Space {
            file,
            ..self.space.clone()
        };
        let mut left = Left::default();
        let mut builder = Builder::new(&space, threads);
        let item = match self.build(&mut builder, &mut left) {
            Ok(()) => Some(self.item(file, builder, colours)),
            Err(refused) => {
                left.add(&refused);
                None
            }
        };
        Made {
            left,
            item,
            reads: file.reads() - before,
            spent: file.is_spent(),
        }
    }

    fn build(&self, builder: &mut Builder<'_, '_>, left: &mut Left) -> Result<(), Refused> {
        let (shells, solid) = match &self.source {
            Source::Shells { shells, solid } => (shells, *solid),
            Source::Face => {
                let face = builder.face(self.id)?;
                builder.body.shells.push(nappe::body::Shell {
                    faces: vec![face],
                    closed: false,
                });
                return Ok(());
            }
        };
        let mut last: Option<Refused> = None;
        let mut void = false;
        for shell in shells {
            match builder.shell(*shell, solid, left) {
                Ok(()) if solid && void => builder.turn_inside_out(),
                Ok(()) => {}
                Err(r) => {
                    left.add(&r);
                    last = Some(r);
                }
            }
            void = true;
        }
        if builder.body.faces.is_empty() {
            let why = last.map_or("it has no faces".into(), |r| r.why);
            return Err(self.space.file.refused(self.id, why));
        }
        Ok(())
    }

    fn item(
        &self,
        file: &File<'_>,
        builder: Builder<'_, '_>,
        colours: &HashMap<u64, Colour>,
    ) -> Item {
        let colour = match &self.source {
            Source::Shells { shells, .. } => {
                let of_shell = shells.iter().find_map(|s| colours.get(s).copied());
                colours.get(&self.id).copied().or(of_shell).or(self.colour)
            }
            Source::Face => self.colour,
        };
        let style = |face: &u64| FaceStyle {
            name: name(file, *face),
            colour: colours.get(face).copied().filter(|c| Some(*c) != colour),
        };
        let mut faces: Vec<FaceStyle> = builder.numbers.iter().map(style).collect();
        if faces.iter().all(|f| *f == FaceStyle::default()) {
            faces.clear();
        }
        let body = builder.body;
        let name = named(file, self.path.clone(), self.id);
        Item {
            name,
            colour,
            form: ItemForm::Body { body, faces },
        }
    }
}

/// The name of an item with those on the way to it.
pub(super) fn named(file: &File<'_>, mut path: Vec<String>, id: u64) -> String {
    let own = name(file, id);
    if !own.is_empty() && path.last() != Some(&own) {
        path.push(own);
    }
    let name = path.join("/");
    file.charge(name.len());
    name
}

/// The name that an entity has; many systems write that it has none.
fn name(file: &File<'_>, id: u64) -> String {
    let name = file.record(id).map_or(String::new(), |r| {
        // Of a complex entity the name is in a part of its own.
        r.part("REPRESENTATION_ITEM")
            .map_or_else(|| r.args().text(0), |args| args.text(0))
    });
    if name == "NONE" { String::new() } else { name }
}

#[cfg(test)]
mod tests {
    use super::super::read_on;
    use crate::report::Progress;
    use std::fmt::Write;

    /// A file of a few megabytes of polygons, some of them without a point, in whose texts entities seem to begin.
    fn file() -> String {
        let mut data = String::new();
        let mut shells = Vec::new();
        for k in 0..12_000 {
            let at = 100 * k + 1000;
            for (i, (x, y)) in [(0, 0), (1, 0), (1, 1), (0, 1)].iter().enumerate() {
                let text = if k % 7 == 0 { "a;\n#12=B(" } else { "" };
                let (id, x) = (at + i, x + 2 * k);
                // Some texts end in an odd place, and some points are not there.
                let text = if k % 11 == 0 {
                    format!("{text};\n#9 /*''")
                } else {
                    text.into()
                };
                if k % 50 != 3 || i != 2 {
                    writeln!(data, "#{id}=CARTESIAN_POINT('{text}',({x}.,{y}.,0.5));").unwrap();
                }
            }
            let ids: Vec<String> = (at..at + 4).map(|i| format!("#{i}")).collect();
            write!(
                data,
                "#{}=POLY_LOOP('',({}));\n/* ;\n#4=C(); */#{}=FACE_BOUND('',#{},.T.);\n#{}=FACE_SURFACE('f{k}',(#{}),#5,.T.);\n#{}=OPEN_SHELL('s{k}',(#{}));\n",
                at + 4, ids.join(","), at + 5, at + 4, at + 6, at + 5, at + 7, at + 6
            )
            .unwrap();
            shells.push(format!("#{}", at + 7));
        }
        format!(
            "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=SHAPE_REPRESENTATION('',({}),#9);\n#5=PLANE('',#6);\n\
             #6=AXIS2_PLACEMENT_3D('',#7,$,$);\n#7=CARTESIAN_POINT('',(0.,0.,0.5));\n#9=CONTEXT();\n{data}ENDSEC;\nEND-ISO-10303-21;\n",
            shells.join(",")
        )
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let text = file();
        assert!(text.len() > 3_000_000);
        let one = read_on(text.as_bytes(), 1, Progress::default()).unwrap();
        assert_eq!(one.document.items.len(), 12_000 - 240);
        assert!(!one.document.left_out.is_empty());
        for threads in [2, 3, 8] {
            let more = read_on(text.as_bytes(), threads, Progress::default()).unwrap();
            assert_eq!(more.entities, one.entities);
            assert_eq!(more.kinds, one.kinds);
            assert_eq!(more.document.left_out, one.document.left_out);
            for (a, b) in one.document.items.iter().zip(&more.document.items) {
                assert_eq!(format!("{a:?}"), format!("{b:?}"));
            }
            assert_eq!(more.document.items.len(), one.document.items.len());
        }
        // What is wrong far inside is told with the same place.
        let wrong = text.replacen("#1199000=", "#1199000 ", 1);
        assert_ne!(wrong, text);
        let errors = [1, 2, 5].map(|n| {
            read_on(wrong.as_bytes(), n, Progress::default())
                .unwrap_err()
                .to_string()
        });
        assert!(
            errors[0].contains("`=`") && errors.iter().all(|e| *e == errors[0]),
            "{errors:?}"
        );
    }

    /// One shell of splines, some of them without a point or with the surface of the face before.
    fn shell() -> String {
        let (mut data, mut faces) = (String::new(), Vec::new());
        for k in 0..300 {
            let at = 100 * k + 1000;
            for (i, (x, y)) in [(0, 0), (0, 1), (1, 0), (1, 1)].iter().enumerate() {
                if k % 50 != 3 || i != 2 {
                    let (id, x) = (at + i, x + 2 * k);
                    writeln!(data, "#{id}=CARTESIAN_POINT('',({x}.,{y}.,0.5));").unwrap();
                }
            }
            let surface = if k % 7 == 1 { at - 100 + 4 } else { at + 4 };
            writeln!(
                data,
                "#{}=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#{at},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,1.),(0.,1.),\
                 .UNSPECIFIED.);\n#{}=VERTEX_POINT('',#{at});\n#{}=VERTEX_LOOP('',#{});\n#{}=FACE_BOUND('',#{},.T.);\n\
                 #{}=ADVANCED_FACE('f{k}',(#{}),#{surface},.T.);",
                at + 4, at + 1, at + 2, at + 3, at + 5, at + 6, at + 5, at + 7, at + 6, at + 8, at + 7
            )
            .unwrap();
            faces.push(format!("#{}", at + 8));
        }
        format!(
            "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=SHAPE_REPRESENTATION('',(#2),#9);\n#2=OPEN_SHELL('s',({}));\n\
             #9=CONTEXT();\n{data}ENDSEC;\nEND-ISO-10303-21;\n",
            faces.join(",")
        )
    }

    #[test]
    fn nor_does_it_within_a_shell() {
        let text = shell();
        let on = |threads| read_on(text.as_bytes(), threads, Progress::default()).unwrap();
        let one = on(1);
        let left: usize = one.document.left_out.iter().map(|l| l.count).sum();
        let of = |k: usize| if k % 7 == 1 { k - 1 } else { k };
        let lost = (0..300).filter(|k| of(*k) % 50 == 3).count();
        assert_eq!(left, lost, "{:?}", one.document.left_out);
        let crate::ItemForm::Body { body, .. } = &one.document.items[0].form else {
            panic!()
        };
        assert_eq!(body.faces.len(), 300 - left);
        // A surface that two faces have is read once.
        let [a, b] = [0, 1].map(|i| &body.faces[i].surface);
        assert!(std::sync::Arc::ptr_eq(a, b));
        for threads in [2, 3, 8] {
            let more = on(threads);
            assert_eq!(more.document.left_out, one.document.left_out);
            assert_eq!(
                format!("{:?}", more.document.items),
                format!("{:?}", one.document.items)
            );
        }
    }
}
