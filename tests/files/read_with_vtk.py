"""Prints what VTK's own reader finds in a VTP, GLB or OBJ file, as JSON. Exit code 77: there is no VTK."""

import json
import sys

try:
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkOBJReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
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
ending = sys.argv[1].rsplit(".", 1)[1]
reader = {"vtp": vtkXMLPolyDataReader, "glb": vtkGLTFReader, "obj": vtkOBJReader}[ending]()
reader.SetFileName(sys.argv[1])
reader.Update()
data = poly_data(reader.GetOutput())
found = {"messages": messages.GetOutput(), "points": [], "arrays": {}, "cells": []}
if data is not None:
    if data.GetNumberOfPoints():
        found["points"] = rows(data.GetPoints().GetData())
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        found["arrays"][array.GetName()] = rows(array)
    for i in range(data.GetNumberOfCells()):
        ids = data.GetCell(i).GetPointIds()
        found["cells"].append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
json.dump(found, sys.stdout)
