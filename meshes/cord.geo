// SPDX-License-Identifier: GPL-3.0-or-later
// The section of a round cord of radius 0.01 about the y axis in plane strain: an O-ring. One element wide.
// Lengths in m.
radius = 0.01; size = 0.0016; width = size;
Point(100) = {0, 0, 0};
Point(1) = {radius, 0, 0};
Point(2) = {0, 0, radius};
Point(3) = {-radius, 0, 0};
Point(4) = {0, 0, -radius};
For i In {1:4}
  Circle(i) = {i, 100, i % 4 + 1};
EndFor
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
out[] = Extrude {0, width, 0} { Surface{1}; Layers{1}; };
Physical Volume("solid") = Volume{:};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
