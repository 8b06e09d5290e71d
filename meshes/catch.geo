// SPDX-License-Identifier: GPL-3.0-or-later
// What meshes/hook.geo snaps over: a block above it with chamfers. One element wide along y. Lengths in m.
bottom = 0.0042; top = 0.012; from = 0.062; to = 0.069; chamfer = 0.001; back = 0.0005; width = 0.003;
Point(1) = {from + chamfer, 0, bottom};
Point(2) = {to - back, 0, bottom};
Point(3) = {to, 0, bottom + 2*back};
Point(4) = {to, 0, top};
Point(5) = {from, 0, top};
Point(6) = {from, 0, bottom + chamfer};
For i In {1:6}
  Line(i) = {i, i % 6 + 1};
EndFor
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
out[] = Extrude {0, width, 0} { Surface{1}; Layers{1}; };
Physical Volume("solid") = Volume{:};
Mesh.MeshSizeMin = 0.001;
Mesh.MeshSizeMax = 0.001;
