"""Another kernel's answers about a model's exact NURBS surfaces, for tests.

    python occt.py MODEL.json POINTS.csv < /dev/null > answers.json

MODEL.json is what `nappe build -o MODEL.json` writes, POINTS.csv has the columns x, y, z. The answers: for each point the
least distance to any of the surfaces; for each surface the area and the centre of the area. Exit code 3: Open CASCADE is not installed (`pip install cadquery-ocp`)."""

import csv
import json
import sys

from rules import gauss

try:
    from OCP.BRep import BRep_Tool  # noqa: F401
except ImportError as e:
    print(f"Open CASCADE (cadquery-ocp): {e}", file=sys.stderr)
    sys.exit(3)

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt, gp_Vec

try:  # version 8 and later
    from OCP.collections import Array1_double, Array1_int, Array2_double, Array2_gp_Pnt
except ImportError:
    from OCP.TColgp import TColgp_Array2OfPnt as Array2_gp_Pnt
    from OCP.TColStd import (
        TColStd_Array1OfInteger as Array1_int,
        TColStd_Array1OfReal as Array1_double,
        TColStd_Array2OfReal as Array2_double,
    )


def knots(all_knots):
    distinct = sorted(set(all_knots))
    values, counts = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
    for i, k in enumerate(distinct):
        values.SetValue(i + 1, k)
        counts.SetValue(i + 1, all_knots.count(k))
    return values, counts


def surface(s):
    points = s["points"]
    n, m = len(points), len(points[0])
    poles, weights = Array2_gp_Pnt(1, n, 1, m), Array2_double(1, n, 1, m)
    for i in range(n):
        for j in range(m):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*points[i][j]))
            weights.SetValue(i + 1, j + 1, s["weights"][i][j] if s.get("weights") else 1.0)
    (ku, mu), (kv, mv) = knots(s["knots_u"]), knots(s["knots_v"])
    return Geom_BSplineSurface(poles, weights, ku, kv, mu, mv, *s["degree"])


with open(sys.argv[1]) as f:
    model = json.load(f)
with open(sys.argv[2]) as f:
    points = [[float(row[c]) for c in "xyz"] for row in csv.DictReader(f)]
surfaces = [surface(s) for s in model["surfaces"]]
faces = [BRepBuilderAPI_MakeFace(s, 1e-9).Face() for s in surfaces]


def distance(p):
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*p)).Vertex()
    return min(BRepExtrema_DistShapeShape(vertex, face).Value() for face in faces)


RULE, PARTS = gauss(8), 8


def places(all_knots):
    """Places and weights for integrals along a parameter, in parts of each knot span."""
    spans = sorted(set(all_knots))
    for lo, hi in zip(spans, spans[1:]):
        for part in range(PARTS):
            for x, w in RULE:
                yield lo + (hi - lo) * (part + x) / PARTS, w * (hi - lo) / PARTS


def area(s, surface):
    """From its derivatives: its own integrals of areas (BRepGProp) have a fixed number of nodes, and are wrong by up to three
    thousandths on a teapot's patches."""
    p, d_u, d_v = gp_Pnt(), gp_Vec(), gp_Vec()
    total, moment = 0.0, [0.0] * 3
    across = list(places(s["knots_v"]))
    for u, a in places(s["knots_u"]):
        for v, b in across:
            surface.D1(u, v, p, d_u, d_v)
            piece = a * b * d_u.Crossed(d_v).Magnitude()
            total += piece
            for k, x in enumerate((p.X(), p.Y(), p.Z())):
                moment[k] += piece * x
    return {"area": total, "centre": [m / total for m in moment]}


json.dump({"distances": [distance(p) for p in points], "surfaces": [area(s, f) for s, f in zip(model["surfaces"], surfaces)]}, sys.stdout)
