// SPDX-License-Identifier: GPL-3.0-or-later
// The hook of a snap-fit in plane strain: a cantilever along x from its root at x = 0, with a nose on top of its
// tip. One element wide along y. Lengths in m.
length = 0.06; thickness = 0.004; nose = 0.003; size = 0.002; width = size;
Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Point(3) = {length, 0, thickness};
Point(4) = {0.0540, 0, thickness + nose};
Point(5) = {0.0515, 0, thickness + nose};
Point(6) = {0.0500, 0, thickness};
Point(7) = {0, 0, thickness};
For i In {1:7}
  Line(i) = {i, i % 7 + 1};
EndFor
Curve Loop(1) = {1:7};
Plane Surface(1) = {1};
out[] = Extrude {0, width, 0} { Surface{1}; Layers{1}; };
e = 1e-7;
root() = Surface In BoundingBox {-e, -e, -e, e, width + e, thickness + e};
Physical Surface("root") = root();
Physical Volume("solid") = Volume{:};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
