// SPDX-License-Identifier: GPL-3.0-or-later
// A die with a round foot, a slice of one element: 0.2 wide, its lowest line in z = 0, its foot an arc of radius 0.15.
// Lengths in m.
half = 0.1; radius = 0.15; height = 0.15; width = 0.018; size = 0.012;
side = radius - Sqrt(radius*radius - half*half);
Point(1) = {0, 0, radius};
Point(2) = {-half, 0, side};
Point(3) = {0, 0, 0};
Point(4) = {half, 0, side};
Point(5) = {half, 0, height};
Point(6) = {-half, 0, height};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {6, 2};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
out[] = Extrude {0, width, 0} { Surface{1}; Layers{1}; };
e = 1e-6;
top() = Surface In BoundingBox {-1, -1, height - e, 1, 1, height + e};
Physical Surface("top") = top();
Physical Volume("solid") = Volume{:};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
