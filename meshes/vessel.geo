// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter of a thick-walled cylinder: radii 0.1 m and 0.2 m, a slice 0.03 m long along z. For tests and examples of
// pressure vessels (Lamé). The groups are its faces.
a = 0.1; b = 0.2; length = 0.03; size = 0.012;
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {b, 0, 0}; Point(4) = {0, b, 0}; Point(5) = {0, a, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Line(3) = {4, 5}; Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
out[] = Extrude {0, 0, length} { Surface{1}; };
Physical Volume("wall") = {out[1]};
Physical Surface("z_min") = {1}; Physical Surface("z_max") = {out[0]};
Physical Surface("y_min") = {out[2]}; Physical Surface("outer") = {out[3]};
Physical Surface("x_min") = {out[4]}; Physical Surface("inner") = {out[5]};
Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;
