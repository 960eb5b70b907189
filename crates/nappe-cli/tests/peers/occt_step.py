"""Another kernel's answers about STEP files, for tests.

    python occt_step.py A.step B.step … > answers.json

For each file: whether all of it is valid (BRepCheck), how many solids, faces and free edges it has, its area and its volume, and
points of its faces. Exit code 3: Open CASCADE is not installed (`pip install cadquery-ocp`)."""

import json
import sys

try:
    from OCP.STEPControl import STEPControl_Reader
except ImportError as e:
    print(f"Open CASCADE (cadquery-ocp): {e}", file=sys.stderr)
    sys.exit(3)

from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID, TopAbs_SHELL
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

try:  # version 8 and later
    from OCP.BRepGProp import BRepGProp as props

    surface_properties, volume_properties = props.SurfaceProperties, props.VolumeProperties
except AttributeError:
    surface_properties, volume_properties = BRepGProp.SurfaceProperties_s, BRepGProp.VolumeProperties_s

EPS = 1e-9


def static(cls, name):
    return getattr(cls, name, None) or getattr(cls, name + "_s")


def count(shape, kind):
    e, n = TopExp_Explorer(shape, kind), 0
    while e.More():
        n += 1
        e.Next()
    return n


def each(shape, kind):
    e = TopExp_Explorer(shape, kind)
    while e.More():
        yield e.Current()
        e.Next()


def measure(function, shape):
    p = GProp_GProps()
    function(shape, p, EPS)
    return p.Mass()


def answer(path):
    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return {"read": False}
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        return {"read": False}
    closed = [static(BRep_Tool, "IsClosed")(s) for s in each(shape, TopAbs_SHELL)]
    return {
        "read": True,
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "solids": count(shape, TopAbs_SOLID),
        "closed": sum(closed),
        "faces": count(shape, TopAbs_FACE),
        "area": measure(surface_properties, shape),
        "volume": sum(measure(volume_properties, s) for s in each(shape, TopAbs_SOLID)),
    }


json.dump([answer(p) for p in sys.argv[1:]], sys.stdout)
