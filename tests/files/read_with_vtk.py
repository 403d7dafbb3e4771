"""Prints what VTK's own reader finds in a VTP, GLB or OBJ file, as JSON. Exit code 77: this VTK, of python3-vtk9 or of
ParaView, has no such reader, or there is none; the reason goes to stderr."""

import importlib
import json
import sys

READERS = {
    "vtp": ("vtkIOXML", "vtkXMLPolyDataReader"),
    "glb": ("vtkIOGeometry", "vtkGLTFReader"),
    "obj": ("vtkIOGeometry", "vtkOBJReader"),
}
ending = sys.argv[1].rsplit(".", 1)[1]
try:
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

    module, name = READERS[ending]
    reader = getattr(importlib.import_module("vtkmodules." + module), name)()
except (ImportError, AttributeError) as error:
    print(error, file=sys.stderr)
    sys.exit(77)


def rows(array):
    return [list(array.GetTuple(i)) for i in range(array.GetNumberOfTuples())]


def poly_data(output):
    """The first leaf of a glTF's blocks, the data set itself of the others."""
    while output is not None and output.IsA("vtkMultiBlockDataSet"):
        output = output.GetBlock(0) if output.GetNumberOfBlocks() else None
    return output


messages = vtkStringOutputWindow()
vtkOutputWindow.SetInstance(messages)
reader.SetFileName(sys.argv[1])
reader.Update()
data = poly_data(reader.GetOutput())
found = {"messages": messages.GetOutput(), "points": [], "arrays": {}, "fields": {}, "cells": []}
if data is not None:
    if data.GetNumberOfPoints():
        found["points"] = rows(data.GetPoints().GetData())
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        found["arrays"][array.GetName()] = rows(array)
    for i in range(data.GetFieldData().GetNumberOfArrays()):
        array = data.GetFieldData().GetAbstractArray(i)
        found["fields"][array.GetName()] = [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    for i in range(data.GetNumberOfCells()):
        ids = data.GetCell(i).GetPointIds()
        found["cells"].append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
json.dump(found, sys.stdout)
