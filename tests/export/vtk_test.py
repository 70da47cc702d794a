"""plumb run --vtk, read back with VTK's own reader and compared with --trajectory."""
import csv
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

SCENE = """{"plumb": 1,
"particles": [{"position": [0, 0, 0], "fixed": true}, {"position": [0.1, 0, 0], "mass": 2},
              {"position": [1, 2, 3], "velocity": [4, 0, 0], "mass": 3}, {"position": [0.3, 0, 0]}],
"rods": [{"a": 0, "b": 1}, {"a": 1, "b": 3, "mass": 6}],
"springs": [{"a": 0, "b": 3, "length": 0.2, "stiffness": 10}]}"""


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    assert reader.CanReadFile(path), path
    reader.Update()
    assert reader.GetErrorCode() == 0, path
    return reader.GetOutput()


def column(data, name):
    array = data.GetArray(name)
    assert array is not None, name
    return [array.GetTuple(i) for i in range(array.GetNumberOfTuples())]


def cells_of(cell_array):
    return [[cell_array.GetCellSize(i)] for i in range(cell_array.GetNumberOfCells())]


def check_first(poly):
    assert poly.GetNumberOfPoints() == 4
    assert cells_of(poly.GetVerts()) == [[1]], "one particle is in no rod"
    assert cells_of(poly.GetLines()) == [[2], [2]]
    ends = [[poly.GetCell(i).GetPointId(k) for k in range(poly.GetCell(i).GetNumberOfPoints())] for i in range(3)]
    assert ends == [[2], [0, 1], [1, 3]], ends
    assert column(poly.GetPointData(), "mass") == [(0,), (5,), (3,), (3,)]
    assert column(poly.GetPointData(), "fixed") == [(1,), (0,), (0,), (0,)]
    assert column(poly.GetCellData(), "rod") == [(-1,), (0,), (1,)]
    assert all(abs(s) < 1e-15 for (s,) in column(poly.GetCellData(), "stretch"))


def check_forces(poly, anchor, spring):
    def vector(row):
        return tuple(float(row[axis]) for axis in "xyz")
    reactions = column(poly.GetPointData(), "reaction")
    assert reactions[0] == vector(anchor) and reactions[0] != (0, 0, 0)
    assert reactions[1:] == [(0, 0, 0)] * 3
    assert column(poly.GetFieldData(), "spring") == [vector(spring)]
    assert len(column(poly.GetCellData(), "tension")) == 3


def main(plumb, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    scene, frames, table, forces = (os.path.join(folder, name)
                                    for name in ("scene.json", "frames", "trajectory.csv", "forces.csv"))
    with open(scene, "w") as file:
        file.write(SCENE)
    subprocess.run([plumb, "run", scene, "--duration", "1/6", "--dt", "1/60", "--vtk", frames, "--trajectory", table,
                    "--forces", forces, "--quiet"], check=True)
    with open(table) as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    with open(forces) as file:
        held = [row for row in csv.DictReader(file)]
    assert [row["kind"] for row in held] == ["anchor", "spring"] * 11, held
    collection = ElementTree.parse(os.path.join(frames, "run.pvd")).getroot()
    assert collection.get("type") == "Collection"
    sets = collection.findall("Collection/DataSet")
    assert len(sets) == 11 and len(rows) == 44, (len(sets), len(rows))
    for number, entry in enumerate(sets):
        poly = read(os.path.join(frames, entry.get("file")))
        of_frame = rows[4 * number:4 * number + 4]
        assert float(entry.get("timestep")) == of_frame[0]["t"]
        velocities = column(poly.GetPointData(), "velocity")
        for row in of_frame:
            particle = int(row["particle"])
            # Written with all their digits, so equal to the last bit.
            assert poly.GetPoint(particle) == (row["x"], row["y"], row["z"]), (number, particle)
            assert velocities[particle] == (row["vx"], row["vy"], row["vz"]), (number, particle)
        if number == 0:
            check_first(poly)
            continue
        check_forces(poly, *held[2 * number:2 * number + 2])
    print(len(sets), "frames read back")


if __name__ == "__main__":
    main(*sys.argv[1:])
