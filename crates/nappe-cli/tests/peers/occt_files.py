"""What another kernel finds in STEP and IGES files, for tests.

    python occt_files.py ANSWERS.json A.step B.igs …

One answer for each file: whether it was read and is valid (BRepCheck), how many solids and closed shells it has, what these
enclose, and for each face its name, its area, how far that is from converged, and points of it. Lengths are millimetres. Exit
code 3: Open CASCADE is not installed (`pip install cadquery-ocp`)."""

import json
import sys

from rules import gauss

try:
    from OCP.STEPControl import STEPControl_Reader
except ImportError as e:
    print(f"Open CASCADE (cadquery-ocp): {e}", file=sys.stderr)
    sys.exit(3)

from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.BRepTools import BRepTools
from OCP.GeomAbs import (
    GeomAbs_BSplineCurve,
    GeomAbs_BSplineSurface,
    GeomAbs_Line,
    GeomAbs_SurfaceOfExtrusion,
    GeomAbs_SurfaceOfRevolution,
)
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Vec, gp_Vec2d
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.StepRepr import StepRepr_RepresentationItem
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_FORWARD, TopAbs_IN, TopAbs_REVERSED, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

# How far an integral may be from converged, relative to the face, and how often a piece is halved for that.
CONVERGED, DEPTH = 1e-9, 12
# Places of an edge that are looked at.
SAMPLES = 32
# Places of each face along either parameter.
GRID = 3


COARSE, FINE = gauss(5), gauss(8)


def integral(f, lo, hi, allowed, depth=DEPTH):
    """The integral of pairs of numbers, halved until two rules agree; and how far they are apart in the first."""
    h = hi - lo
    rules = []
    for rule in (COARSE, FINE):
        pairs = [(w, f(lo + h * x)) for x, w in rule]
        rules.append([h * sum(w * p[k] for w, p in pairs) for k in (0, 1)])
    (coarse, _), fine = rules
    apart = abs(fine[0] - coarse)
    if apart <= allowed or depth == 0:
        return [*fine, apart]
    mid = (lo + hi) / 2
    halves = [integral(f, *part, allowed / 2, depth - 1) for part in ((lo, mid), (mid, hi))]
    return [a + b for a, b in zip(*halves)]


def static(cls, name):
    return getattr(cls, name, None) or getattr(cls, name + "_s")


def each(shape, kind, *avoid):
    e = TopExp_Explorer(shape, kind, *avoid)
    while e.More():
        yield e.Current()
        e.Next()


def between(knots, lo, hi):
    """The ends and what lies between them."""
    width = 1e-10 * (hi - lo)
    return [lo, *sorted(k for k in knots if lo + width < k < hi - width), hi]


def crossings(f, lo, hi):
    """Where a function changes its sign, as far as some samples see it."""
    at = [lo + (hi - lo) * i / SAMPLES for i in range(SAMPLES + 1)]
    for a, b in zip(at, at[1:]):
        if f(b) == 0:
            yield b
        elif f(a) * f(b) < 0:
            for _ in range(60):
                mid = (a + b) / 2
                a, b = (a, mid) if f(a) * f(mid) <= 0 else (mid, b)
            yield b


class Face:
    """Area and flux of x/3 of a face, from OCCT's own derivatives. Its own integrals (BRepGProp) have a fixed number of nodes
    for each face and are wrong by up to three thousandths, whatever accuracy one asks for.

    By Green's formula: along the edges in the plane of parameters, the integral over u up to them, times dv."""

    def __init__(self, shape):
        self.reversed = shape.Orientation() == TopAbs_REVERSED
        self.shape = static(TopoDS, "Face")(shape.Oriented(TopAbs_FORWARD))
        self.surface = BRepAdaptor_Surface(self.shape)
        self.u0, self.u1, self.v0, self.v1 = static(BRepTools, "UVBounds")(self.shape)
        self.p, self.d_u, self.d_v = gp_Pnt(), gp_Vec(), gp_Vec()
        self.knots = [[], []]
        if self.surface.GetType() == GeomAbs_BSplineSurface:
            s = self.surface.BSpline()
            self.knots = [
                [s.UKnot(i + 1) for i in range(s.NbUKnots())],
                [s.VKnot(i + 1) for i in range(s.NbVKnots())],
            ]
        # Swept surfaces have the knots of their curves, along u or round the axis along v.
        along = {GeomAbs_SurfaceOfExtrusion: 0, GeomAbs_SurfaceOfRevolution: 1}.get(self.surface.GetType())
        if along is not None and self.surface.BasisCurve().GetType() == GeomAbs_BSplineCurve:
            s = self.surface.BasisCurve().BSpline()
            self.knots[along] = [s.Knot(i + 1) for i in range(s.NbKnots())]

    def element(self, u, v):
        self.surface.D1(u, v, self.p, self.d_u, self.d_v)
        n = self.d_u.Crossed(self.d_v)
        p = self.p
        return n.Magnitude(), (n.X() * p.X() + n.Y() * p.Y() + n.Z() * p.Z()) / 3

    def up_to(self, u, v, allowed):
        """The integral along u."""
        sign, lo, hi = (1, self.u0, u) if u > self.u0 else (-1, u, self.u0)
        spans = between(self.knots[0], lo, hi)
        parts = [integral(lambda t: self.element(t, v), a, b, allowed) for a, b in zip(spans, spans[1:]) if b > a]
        return [sign * sum(p[k] for p in parts) for k in (0, 1)]

    def along(self, edge, allowed):
        c = BRepAdaptor_Curve2d(edge, self.shape)
        lo, hi = c.FirstParameter(), c.LastParameter()
        p, d = gp_Pnt2d(), gp_Vec2d()
        breaks = []
        if c.GetType() == GeomAbs_BSplineCurve:
            s = c.BSpline()
            breaks = [s.Knot(i + 1) for i in range(s.NbKnots())]
            # The surface is less smooth at its own knots.
            for k, knots in enumerate(self.knots):
                breaks += [t for knot in knots for t in crossings(lambda t: c.Value(t).Coord(k + 1) - knot, lo, hi)]
        elif c.GetType() == GeomAbs_Line:
            c.D1(lo, p, d)
            for at, speed, knots in ((p.X(), d.X(), self.knots[0]), (p.Y(), d.Y(), self.knots[1])):
                if abs(speed) > 1e-9:
                    breaks += [lo + (k - at) / speed for k in knots]
        height = self.v1 - self.v0
        span = max(hi - lo, 1e-300)

        def rate(t):
            c.D1(t, p, d)
            u, v, speed = p.X(), p.Y(), d.Y()
            if abs(speed) * span <= 1e-15 * height or u == self.u0:
                return 0.0, 0.0
            area, flux = self.up_to(u, v, 0.1 * allowed / height)
            return area * speed, flux * speed

        spans = between(breaks, lo, hi)
        parts = [integral(rate, a, b, allowed / len(spans)) for a, b in zip(spans, spans[1:])]
        sign = -1 if edge.Orientation() == TopAbs_REVERSED else 1
        area, flux, apart = (sum(p[k] for p in parts) for k in (0, 1, 2))
        return sign * area, sign * flux, apart

    def measured(self):
        edges = [static(TopoDS, "Edge")(e) for e in each(self.shape, TopAbs_EDGE)]
        size = abs(self.element((self.u0 + self.u1) / 2, (self.v0 + self.v1) / 2)[0])
        allowed = CONVERGED * size * (self.u1 - self.u0) * (self.v1 - self.v0) / len(edges)
        parts = [self.along(e, allowed) for e in edges]
        area, flux, apart = (sum(p[k] for p in parts) for k in (0, 1, 2))
        return area, -flux if self.reversed else flux, apart

    def points(self):
        """Points of the face, not of what is cut away of its surface."""
        out = []
        for i in range(GRID):
            for j in range(GRID):
                u = self.u0 + (self.u1 - self.u0) * (i + 0.37) / GRID
                v = self.v0 + (self.v1 - self.v0) * (j + 0.41) / GRID
                if BRepClass_FaceClassifier(self.shape, gp_Pnt2d(u, v), 1e-9).State() == TopAbs_IN:
                    p = self.surface.Value(u, v)
                    out.append([p.X(), p.Y(), p.Z()])
        return out


def answer(path):
    step = path.endswith((".step", ".stp"))
    reader = STEPControl_Reader() if step else IGESControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return {"read": False}
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        return {"read": True, "valid": True, "solids": 0, "closed": 0, "volume": 0.0, "faces": []}
    transfer = reader.WS().TransferReader()

    def name(face):
        item = transfer.EntityFromShapeResult(face, 1) if step else None
        return item.Name().ToCString() if isinstance(item, StepRepr_RepresentationItem) else None

    def flux(body):
        return sum(Face(f).measured()[1] for f in each(body, TopAbs_FACE))

    # A closed shell may be outside solids, and turned either way.
    loose = [s for s in each(shape, TopAbs_SHELL, TopAbs_SOLID) if s.Closed()]
    faces = []
    for f in each(shape, TopAbs_FACE):
        face = Face(f)
        area, _, apart = face.measured()
        faces.append({"name": name(f), "area": area, "apart": apart, "points": face.points()})
    return {
        "read": True,
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "solids": sum(1 for _ in each(shape, TopAbs_SOLID)),
        "closed": sum(1 for s in each(shape, TopAbs_SHELL) if s.Closed()),
        "volume": sum(flux(s) for s in each(shape, TopAbs_SOLID)) + sum(abs(flux(s)) for s in loose),
        "faces": faces,
    }


# In a file of its own: OCCT also talks on the standard output.
answers = [answer(p) for p in sys.argv[2:]]
with open(sys.argv[1], "w") as out:
    json.dump(answers, out)
