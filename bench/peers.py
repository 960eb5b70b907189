"""What other libraries take for the same tasks on the same inputs: one JSON object a line.

`cargo xtask bench` runs this with `python3`, or with the interpreter that NAPPE_PEERS_PYTHON names. A library that is not
installed is skipped with a line that says so. `pip install numpy scipy splipy geomdl cadquery-ocp` installs all of them.
Slow libraries take fewer items; `n` says how many.
"""

import json
import os
import sys
import time

# One core, as the rows they stand beside.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

SIDE = 1000
SCATTERED = 20000
HERE = os.path.dirname(os.path.abspath(__file__))


def emit(peer, task, n, seconds, how, kind=None):
    """`kind` names the row among those of one task."""
    row = {"peer": peer, "task": task, "kind": kind, "n": n, "ns_per_item": seconds * 1e9 / n, "how": how}
    print(json.dumps(row), flush=True)


def best(f, runs=5):
    f()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        f()
        times.append(time.perf_counter() - start)
    return min(times)


def load(name):
    with open(os.path.join(HERE, "inputs", name + ".json")) as f:
        return json.load(f)


def scattered():
    """The first parameter pairs of the splitmix64 sequence with seed 42."""
    x, mask, out = 42, (1 << 64) - 1, []
    for _ in range(2 * SCATTERED):
        x = (x + 0x9E3779B97F4A7C15) & mask
        z = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        out.append(((z ^ (z >> 31)) >> 11) / (1 << 53))
    return list(zip(out[::2], out[1::2]))


def run_scipy():
    import numpy as np
    from scipy.interpolate import BSpline, NdBSpline

    t = np.linspace(0.0, 1.0, SIDE)
    s = load("bicubic")
    ku, kv, p = np.array(s["knots_u"]), np.array(s["knots_v"]), np.array(s["points"])
    f = lambda: BSpline(kv, BSpline(ku, p, 3)(t).swapaxes(0, 1), 3)(t)
    emit("scipy", "T1", SIDE * SIDE, best(f), "BSpline in u, then in v")

    def normals():
        a, b = (BSpline.design_matrix(t, k, 3).toarray() for k in (ku, kv))
        da, db = (np.stack([BSpline(k, e, 3)(t, nu=1) for e in np.eye(20)], 1) for k in (ku, kv))
        q, dq = (m @ p.reshape(20, 60) for m in (a, da))
        q, dq = q.reshape(SIDE, 20, 3), dq.reshape(SIDE, 20, 3)
        r, u, v = np.matmul(b, q), np.matmul(b, dq), np.matmul(db, q)
        n = np.cross(u, v)
        return r, n / np.sqrt(np.einsum("ijc,ijc->ij", n, n))[..., None]

    emit("scipy", "T2", SIDE * SIDE, best(normals, 3), "dense products, cross product, normalised")
    uv, nd = np.array(scattered()), NdBSpline((ku, kv), p, 3)
    first, second = [(0, 0), (1, 0), (0, 1)], [(2, 0), (1, 1), (0, 2)]
    for task, orders in (("T3", first), ("T3b", first + second)):
        f = lambda: [nd(uv, nu=o) for o in orders]
        emit("scipy", task, SCATTERED, best(f), "NdBSpline, one call a derivative")
    s = load("torus")
    h = np.concatenate([np.array(s["points"]), np.ones((9, 9, 1))], -1) * np.array(s["weights"])[..., None]

    def rational():
        a, b = (BSpline.design_matrix(t, np.array(s[k]), 2).toarray() for k in ("knots_u", "knots_v"))
        x = np.matmul(b, (a @ h.reshape(9, 36)).reshape(SIDE, 9, 4))
        return x[..., :3] / x[..., 3:]

    emit("scipy", "T4", SIDE * SIDE, best(rational), "dense products and a division")


def run_splipy():
    import numpy as np
    from splipy import BSplineBasis, Surface

    def make(name):
        s = load(name)
        p = np.array(s["points"], dtype=float)
        rational = "weights" in s
        if rational:
            w = np.array(s["weights"])[..., None]
            p = np.concatenate([p * w, w], -1)
        bases = [BSplineBasis(s["degree_" + d] + 1, s["knots_" + d]) for d in "uv"]
        return Surface(*bases, p.transpose(1, 0, 2).reshape(-1, p.shape[-1]), rational=rational)

    t = np.linspace(0.0, 1.0, SIDE)
    bicubic, torus = make("bicubic"), make("torus")
    emit("splipy", "T1", SIDE * SIDE, best(lambda: bicubic(t, t)), "Surface()")
    emit("splipy", "T2", SIDE * SIDE, best(lambda: (bicubic(t, t), bicubic.normal(t, t)), 3), "Surface() and normal()")
    emit("splipy", "T4", SIDE * SIDE, best(lambda: torus(t, t)), "Surface()")


def run_geomdl():
    from geomdl import BSpline

    s = load("bicubic")
    b = BSpline.Surface()
    b.degree_u, b.degree_v = s["degree_u"], s["degree_v"]
    b.set_ctrlpts([list(p) for row in s["points"] for p in row], 20, 20)
    b.knotvector_u, b.knotvector_v = s["knots_u"], s["knots_v"]
    uv = scattered()[:1000]
    emit("geomdl", "T1", len(uv), best(lambda: b.evaluate_list(uv), 2), "evaluate_list")
    emit("geomdl", "T3", len(uv), best(lambda: [b.derivatives(u, v, 1) for u, v in uv], 2), "derivatives, point by point")


def occt_bicubic(poles):
    """The surface of the inputs with other control points, rows along u."""
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt
    try:  # version 8 and later
        from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    except ImportError:
        from OCP.TColgp import TColgp_Array2OfPnt as Array2_gp_Pnt
        from OCP.TColStd import TColStd_Array1OfInteger as Array1_int, TColStd_Array1OfReal as Array1_double

    def knots(all_knots):
        distinct = sorted(set(all_knots))
        values, counts = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
        for i, k in enumerate(distinct):
            values.SetValue(i + 1, k)
            counts.SetValue(i + 1, all_knots.count(k))
        return values, counts

    s = load("bicubic")
    (ku, mu), (kv, mv) = knots(s["knots_u"]), knots(s["knots_v"])
    net = Array2_gp_Pnt(1, 20, 1, 20)
    for i, row in enumerate(poles):
        for j, p in enumerate(row):
            net.SetValue(i + 1, j + 1, gp_Pnt(*p))
    return Geom_BSplineSurface(net, ku, kv, mu, mv, 3, 3)


def run_occt():
    from OCP.gp import gp_Pnt, gp_Vec

    b = occt_bicubic(load("bicubic")["points"])
    uv = scattered()
    p, d = gp_Pnt(), [gp_Vec() for _ in range(5)]
    emit("OCCT (Python)", "T1", len(uv), best(lambda: [b.D0(u, v, p) for u, v in uv]), "Geom_BSplineSurface.D0, point by point")
    emit("OCCT (Python)", "T3", len(uv), best(lambda: [b.D1(u, v, p, *d[:2]) for u, v in uv]), "D1, point by point")
    emit("OCCT (Python)", "T3b", len(uv), best(lambda: [b.D2(u, v, p, *d) for u, v in uv]), "D2, point by point")
    occt_mesh(b)


def occt_mesh(surface):
    """Meshes to a share of the diagonal, whose deviation nobody has proven."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopLoc import TopLoc_Location

    t = [i / 200 for i in range(201)]
    at = [surface.Value(u, v) for u in t for v in t]
    sizes = [max(c) - min(c) for c in ([p.X() for p in at], [p.Y() for p in at], [p.Z() for p in at])]
    diagonal = sum(s * s for s in sizes) ** 0.5
    face = BRepBuilderAPI_MakeFace(surface, 1e-7).Face()
    for share in ("1e-3", "1e-5"):
        # Once: it takes half a minute.
        BRepTools.Clean_s(face)
        start = time.perf_counter()
        BRepMesh_IncrementalMesh(face, float(share) * diagonal, False, 0.5, False)
        seconds = time.perf_counter() - start
        n = BRep_Tool.Triangulation_s(face, TopLoc_Location()).NbTriangles()
        kind = f"mesh of bicubic, {share}, two threads"
        emit(f"OCCT, {n} triangles, not proven", "T6", n, seconds, "BRepMesh_IncrementalMesh", kind)


def files_occt(path):
    """STEP out and in: the surface of the inputs at 1000 places, as in `crates/nappe-exchange/benches/files`."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    points = load("bicubic")["points"]
    all_faces, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(all_faces)
    for n in range(1000):
        surface = occt_bicubic([[(p[0] + 20.0 * n, p[1], p[2]) for p in row] for row in points])
        builder.Add(all_faces, BRepBuilderAPI_MakeFace(surface, 1e-7).Face())

    def write():
        writer = STEPControl_Writer()
        writer.Transfer(all_faces, STEPControl_AsIs)
        writer.Write(path)

    def read():
        reader = STEPControl_Reader()
        reader.ReadFile(path)
        reader.TransferRoots()

    # Once each: seconds, not milliseconds. Both talk on the standard output.
    emit("OCCT", "T9 out", 1000, best(write, 1), "STEPControl_Writer")
    emit("OCCT", "T9 in", 1000, best(read, 1), "STEPControl_Reader")


if sys.argv[1:2] == ["files"]:
    try:
        files_occt(sys.argv[2])
    except ImportError as e:
        print(f"OCCT (cadquery-ocp): skipped, {e}", file=sys.stderr)
    sys.exit()

for name, run in (("scipy", run_scipy), ("splipy", run_splipy), ("geomdl", run_geomdl), ("OCCT (cadquery-ocp)", run_occt)):
    try:
        run()
    except ImportError as e:
        print(f"{name}: skipped, {e}", file=sys.stderr)
