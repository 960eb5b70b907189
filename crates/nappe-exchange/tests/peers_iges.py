"""What Open CASCADE finds in IGES files: one line of JSON for each. Exit code 3: it is not installed."""

import json
import sys

try:
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.IGESControl import IGESControl_Reader
    from OCP.Interface import Interface_Static
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer
except ImportError:
    sys.exit(3)

answers = []
for path in sys.argv[1:]:
    reader = IGESControl_Reader()
    status = reader.ReadFile(path)
    reader.TransferRoots()
    shape = reader.OneShape()
    count = {}
    for name, kind in [("faces", TopAbs_FACE), ("solids", TopAbs_SOLID)]:
        explorer, n = TopExp_Explorer(shape, kind), 0
        while explorer.More():
            n += 1
            explorer.Next()
        count[name] = n
    area, volume = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9)
    BRepGProp.VolumeProperties_s(shape, volume, 1e-9)
    answers.append(
        {
            **count,
            "area": area.Mass(),
            "volume": volume.Mass(),
            "valid": bool(BRepCheck_Analyzer(shape).IsValid()),
        }
    )
with open(sys.argv[1] + ".json", "w") as out:
    json.dump(answers, out)
