// SPDX-License-Identifier: GPL-3.0-or-later
// A ball of radius 0.1 m about the origin. Change `size` for a finer one. Lengths in m.
size = 0.026;
radius = 0.1;
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, radius};
Physical Surface("surface") = Boundary{ Volume{1}; };
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
