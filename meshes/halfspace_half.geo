// SPDX-License-Identifier: GPL-3.0-or-later
// Half of an elastic half-space below z = 0, cut at y = 0: of a half ball of radius `far` about the origin, fine
// within `near` of it, elements growing with the distance beyond. For a ball pressed and rubbed along x. Lengths in m.
// `scale` 1 has eight times the elements of 2.
scale = 2;
near = 0.08; fine = 0.008 * scale; far = 20; growth = 0.12 * scale;
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, far, -Pi/2, 0, Pi};
e = 1e-3;
top() = Surface In BoundingBox {-far - e, -e, -e, far + e, far + e, e};
y_min() = Surface In BoundingBox {-far - e, -e, -far - e, far + e, e, e};
Physical Surface("top") = {top()};
Physical Surface("y_min") = {y_min()};
outer() = Surface{:};
outer() -= {top(), y_min()};
Physical Surface("outer") = {outer()};
Physical Volume("solid") = {1};
Point(1000) = {0, 0, 0};
Field[1] = Distance; Field[1].PointsList = {1000};
Field[2] = Threshold; Field[2].InField = 1;
Field[2].DistMin = near; Field[2].SizeMin = fine;
Field[2].DistMax = far; Field[2].SizeMax = fine + growth * (far - near);
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
