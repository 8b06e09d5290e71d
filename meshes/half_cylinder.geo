// SPDX-License-Identifier: GPL-3.0-or-later
// Half of a cylinder of radius 0.1 along x, its uppermost line in z = 0, cut at its axis. Lengths in m.
size = 0.02; radius = 0.1; half = 0.15; // half its length
SetFactory("OpenCASCADE");
Cylinder(1) = {-half, 0, -radius, 2*half, 0, 0, radius};
Box(2) = {-half, -radius, -2*radius, 2*half, 2*radius, radius};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
e = 1e-4;
base() = Surface In BoundingBox{-half-e, -radius-e, -radius-e, half+e, radius+e, -radius+e};
Physical Surface("base") = base();
Physical Volume("solid") = {3};
Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;
