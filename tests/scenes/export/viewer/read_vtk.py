"""Reads .vtp files with VTK itself and writes them as JSON:  read_vtk.py FILE...   (Debian: python3-vtk9)

Gives {file: {"points": [...], "verts": n, "lines": [ends...], "polys": [corners...], "point_data": {name: [...]}, "cell_data": {...}}}.
Fails if VTK reports an error or warning.
"""
import json
import sys

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader


def numbers(array):
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def fields(data):
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    return {array.GetName(): numbers(array) for array in arrays}


def main(files):
    complaints = []
    found = {}
    for file in files:
        reader = vtkXMLPolyDataReader()
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, lambda _object, kind, name=file: complaints.append(f"{name}: {kind}"))
        reader.SetFileName(file)
        reader.Update()
        data = reader.GetOutput()
        points = data.GetPoints()
        found[file] = {
            "points": numbers(points.GetData()) if points else [],
            "verts": data.GetNumberOfVerts(),
            "lines": numbers(data.GetLines().GetConnectivityArray()) if data.GetNumberOfLines() else [],
            "polys": numbers(data.GetPolys().GetConnectivityArray()) if data.GetNumberOfPolys() else [],
            "point_data": fields(data.GetPointData()),
            "cell_data": fields(data.GetCellData()),
        }
    if complaints:
        sys.exit("\n".join(complaints))
    json.dump(found, sys.stdout)


main(sys.argv[1:])
