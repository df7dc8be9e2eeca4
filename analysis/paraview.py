#!/usr/bin/python3
"""A recorded trajectory for ParaView or VisIt: an XDMF file that refers to the results file.

Each frame has the segments' centres, joined by lines, with orientation (w, x, y, z), radius, length, rod and whether a
clamp holds them. If the job recorded forces, each frame also has tension [N], bending and torsion [N m] and stress [Pa], as
render.py shows them; they are 0 where unknown, as in the first frame. These are numbers in the XDMF file. All others stay in
the HDF5 file: keep the two together. Open the .xdmf with ParaView's "XDMF Reader"; its Xdmf3 readers fail on parts of
datasets, which frames are. To show tubes, apply Extract Surface and Tube with Scalars "radius" and Vary Radius "By Absolute
Scalar". Obstacles are a separate block of triangles, "obstacles", which Extract Block selects. The script prints the path.
"""

import os
from xml.etree import ElementTree

import numpy as np

from rodsweep.drawing import staging, surfaces
from rodsweep.reading import commandline, obstacles, trajectory
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.writing import outputs

EXAMPLES = """examples:
  analysis/paraview.py results/net.h5
  analysis/paraview.py results/ring.h5 --task 3 -o ring.xdmf"""
TOPOLOGY = "/Xdmf/Domain/Topology[1]"
NUMBERS = {"f8": "Float", "i2": "Int", "i1": "Char"}
CONSTANT = {"radius": "radius_m", "length": "length_m", "rod": "rod", "static": "static"}


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    trajectory.add_task_argument(made)
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: NAME-taskN.xdmf beside the file)")
    outputs.add_force(made)
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = trajectory.chosen(file, options)
        path = options.output or f"{os.path.splitext(options.file)[0]}-task{shown.task}.xdmf"
        outputs.check(path, options)
        reference = os.path.relpath(options.file, os.path.dirname(path) or ".")
        with outputs.whole(path) as part:
            touched = obstacles.of_task(file, shown.task)
            document(shown, reference, touched).write(part, encoding="utf-8", xml_declaration=True)
        print(path)


def document(shown, reference, touched=()):
    """The XDMF (version 2) of all frames. reference: path of the results file from the XDMF; touched:
    obstacles.of_task()."""
    root = ElementTree.Element("Xdmf", Version="2.0")
    domain = ElementTree.SubElement(root, "Domain")
    topology(domain, trajectory.joints(shown), len(shown.length))
    series = ElementTree.SubElement(domain, "Grid", Name=f"task {shown.task}", GridType="Collection",
                                    CollectionType="Temporal")
    for frame, (row, time) in enumerate(zip(shown.first_row, shown.time_s)):
        grid = ElementTree.SubElement(series, "Grid", Name=f"frame {frame}", GridType="Uniform")
        ElementTree.SubElement(grid, "Time", Value=repr(float(time)))
        ElementTree.SubElement(grid, "Topology", Reference=TOPOLOGY)
        rows(ElementTree.SubElement(grid, "Geometry", GeometryType="XYZ"), shown, reference, "/trajectories/position_m", row)
        rows(attribute(grid, "orientation", "Matrix"), shown, reference, "/trajectories/orientation", row)
        for name, column in CONSTANT.items():
            rows(attribute(grid, name, "Scalar"), shown, reference, f"{trajectory.SEGMENTS}/{column}", shown.first_segment)
        if shown.has_forces():
            for name, values in shown.internal_forces(frame).items():    # not every XDMF reader reads NaN
                numbers(attribute(grid, name, "Scalar"), np.nan_to_num(values), NumberType="Float", Precision="8")
    if touched:
        low, high, _ = staging.bounds(shown, range(shown.frames()))

        def surface(time):
            return surfaces.joined([surfaces.surface(obstacle.at(time), (low + high) / 2,
                                                     float(np.linalg.norm(high - low))) for obstacle in touched])

        if any(obstacle.velocity.any() for obstacle in touched):
            moving = ElementTree.SubElement(domain, "Grid", Name="obstacles", GridType="Collection",
                                            CollectionType="Temporal")
            for time in shown.time_s:
                solids(moving, *surface(time), time)
        else:
            solids(domain, *surface(0.0))
    ElementTree.indent(root, " ")
    return ElementTree.ElementTree(root)


def topology(parent, pairs, segments):
    """Lines between the centres of joined segments; points if no segments are joined."""
    if len(pairs):
        lines = ElementTree.SubElement(parent, "Topology", TopologyType="Polyline", NodesPerElement="2",
                                       NumberOfElements=str(len(pairs)))
    else:
        pairs = [[segment] for segment in range(segments)]
        lines = ElementTree.SubElement(parent, "Topology", TopologyType="Polyvertex", NodesPerElement="1",
                                       NumberOfElements=str(segments))
    numbers(lines, pairs, NumberType="Int")


def solids(parent, points, triangles, time=None):
    """Triangles as a grid, at one time or at all times."""
    grid = ElementTree.SubElement(parent, "Grid", Name="obstacles", GridType="Uniform")
    if time is not None:
        ElementTree.SubElement(grid, "Time", Value=repr(float(time)))
    faces = ElementTree.SubElement(grid, "Topology", TopologyType="Triangle", NumberOfElements=str(len(triangles)))
    numbers(faces, triangles, NumberType="Int")
    numbers(ElementTree.SubElement(grid, "Geometry", GeometryType="XYZ"), points, NumberType="Float", Precision="8")


def numbers(parent, rows, **kind):
    """Adds an array as text."""
    rows = np.asarray(rows)
    item = ElementTree.SubElement(parent, "DataItem", Format="XML", Dimensions=text(*rows.shape), **kind)
    item.text = "\n" + "\n".join(" ".join(f"{value:.9g}" for value in row) for row in rows.reshape(len(rows), -1)) + "\n"


def attribute(grid, name, kind):
    return ElementTree.SubElement(grid, "Attribute", Name=name, AttributeType=kind, Center="Node")


def rows(parent, shown, reference, path, first):
    """Adds a reference to rows of a dataset, from the first on one for every segment, as a hyperslab: start, stride and
    count along every axis."""
    dataset = shown.h5[path]
    shape, width = dataset.shape, dataset.shape[1:]
    extent = text(len(shown.length), *width)
    slab = ElementTree.SubElement(parent, "DataItem", ItemType="HyperSlab", Type="HyperSlab", Dimensions=extent)
    start, stride = text(int(first), *[0] * len(width)), text(*[1] * len(shape))
    ElementTree.SubElement(slab, "DataItem", Format="XML", NumberType="Int",
                           Dimensions=text(3, len(shape))).text = f"{start} {stride} {extent}"
    whole = ElementTree.SubElement(slab, "DataItem", Format="HDF", NumberType=NUMBERS[dataset.dtype.str[1:]],
                                   Precision=str(dataset.dtype.itemsize), Dimensions=text(*shape))
    whole.text = f"{reference}:{path}"


def text(*values):
    return " ".join(map(str, values))


if __name__ == "__main__":
    commandline.run(main)
