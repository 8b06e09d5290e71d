// SPDX-License-Identifier: GPL-3.0-or-later
// The upper half of an elastic ball of radius 1 about (0, 0, -1), all round: its pole is in the origin, where it is fine
// within `near`, elements growing with the distance beyond. For two balls that turn on each other. Lengths in m.
near = 0.07; fine = 0.0125; growth = 0.3;
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, -1, 1, 0, Pi/2, 2*Pi};
e = 1e-3;
middle() = Surface In BoundingBox {-1 - e, -1 - e, -1 - e, 1 + e, 1 + e, -1 + e};
Physical Surface("middle") = {middle()};
Physical Volume("solid") = {1};
Point(1000) = {0, 0, 0};
Field[1] = Distance; Field[1].PointsList = {1000};
Field[2] = Threshold; Field[2].InField = 1;
Field[2].DistMin = near; Field[2].SizeMin = fine;
Field[2].DistMax = 1.4; Field[2].SizeMax = fine + growth * (1.4 - near);
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
