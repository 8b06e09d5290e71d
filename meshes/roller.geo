// SPDX-License-Identifier: GPL-3.0-or-later
// The lowest part of a roller of radius 1 about an axis along y, its lowest line in z = 0: what is pressed into
// meshes/plane_strain.geo. One element wide. Lengths in m.
radius = 1; half = 0.12; thickness = 0.03; width = 0.02;
along = 100;
Point(100) = {0, 0, radius};
For k In {0:1}
  r = radius - k*thickness;
  Point(10*k + 1) = {-r*Sin(half), 0, radius - r*Cos(half)};
  Point(10*k + 2) = {r*Sin(half), 0, radius - r*Cos(half)};
  Circle(10*k + 1) = {10*k + 1, 100, 10*k + 2};
EndFor
Line(51) = {1, 11};
Line(52) = {2, 12};
Curve Loop(1) = {1, 52, -11, -51};
Plane Surface(1) = {1};
Transfinite Curve{1, 11} = along + 1;
Transfinite Curve{51, 52} = 2 + 1;
Transfinite Surface{1};
out[] = Extrude {0, width, 0} { Surface{1}; Layers{1}; };
Physical Volume("solid") = Volume{:};
