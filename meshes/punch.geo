// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter of a round flat punch of radius 0.05 m, standing on z = 0. Its rim has 4 · 24 facets. Lengths in m.
radius = 0.05; height = 0.05; facets = 24;
Point(1) = {0, 0, 0}; Point(2) = {radius, 0, 0}; Point(3) = {0, radius, 0};
Line(1) = {1, 2}; Circle(2) = {2, 1, 3}; Line(3) = {3, 1};
Transfinite Curve{2} = facets + 1; Transfinite Curve{1, 3} = 7;
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
out[] = Extrude {0, 0, height} { Surface{1}; };
Physical Volume("solid") = {out[1]};
Mesh.MeshSizeMin = 0.008; Mesh.MeshSizeMax = 0.008;
