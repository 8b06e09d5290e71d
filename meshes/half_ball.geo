// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter of the upper half of an elastic ball of radius 1 about (0, 0, -1): its pole is in the origin, where it
// is fine within `near`, elements growing with the distance beyond. For two balls pressed together. Lengths in m.
// `scale` 1 has eight times the elements of 2.
scale = 2;
near = 0.025; fine = 0.002 * scale; growth = 0.12 * scale;
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, -1, 1, 0, Pi/2, Pi/2};
e = 1e-3;
x_min() = Surface In BoundingBox {-e, -e, -1 - e, e, 1 + e, e};
y_min() = Surface In BoundingBox {-e, -e, -1 - e, 1 + e, e, e};
middle() = Surface In BoundingBox {-e, -e, -1 - e, 1 + e, 1 + e, -1 + e};
Physical Surface("x_min") = {x_min()};
Physical Surface("y_min") = {y_min()};
Physical Surface("middle") = {middle()};
round() = Surface{:};
round() -= {x_min(), y_min(), middle()};
Physical Surface("round") = {round()};
Physical Volume("solid") = {1};
Point(1000) = {0, 0, 0};
Field[1] = Distance; Field[1].PointsList = {1000};
Field[2] = Threshold; Field[2].InField = 1;
Field[2].DistMin = near; Field[2].SizeMin = fine;
Field[2].DistMax = 1.4; Field[2].SizeMax = fine + growth * (1.4 - near);
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
