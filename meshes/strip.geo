// SPDX-License-Identifier: GPL-3.0-or-later
// A strip that lies round the upper half of a drum of radius 1 about the y axis, with straight legs down to
// z = -leg: a ruled mesh, one element wide. Lengths in m.
radius = 1; thickness = radius/80; leg = radius/4; width = 0.05;
along = 32;  // elements of a quarter turn
across = 1;  // through the thickness
down = 6;    // of a leg
For k In {0:1}
  r = radius + k*thickness;
  Point(10*k + 1) = {-r, 0, -leg};
  Point(10*k + 2) = {-r, 0, 0};
  Point(10*k + 3) = {0, 0, r};
  Point(10*k + 4) = {r, 0, 0};
  Point(10*k + 5) = {r, 0, -leg};
EndFor
Point(100) = {0, 0, 0};
For k In {0:1}
  Line(10*k + 1) = {10*k + 1, 10*k + 2};
  Circle(10*k + 2) = {10*k + 2, 100, 10*k + 3};
  Circle(10*k + 3) = {10*k + 3, 100, 10*k + 4};
  Line(10*k + 4) = {10*k + 4, 10*k + 5};
EndFor
For i In {1:5}
  Line(50 + i) = {i, 10 + i};
  Transfinite Curve{50 + i} = across + 1;
EndFor
For i In {1:4}
  Curve Loop(i) = {i, 51 + i, -(10 + i), -(50 + i)};
  Plane Surface(i) = {i};
  Transfinite Surface{i};
EndFor
Transfinite Curve{1, 11, 4, 14} = down + 1;
Transfinite Curve{2, 12, 3, 13} = along + 1;
out[] = Extrude {0, width, 0} { Surface{1:4}; Layers{1}; };
e = 1e-6;
slack() = Surface In BoundingBox {-2, -e, -leg - e, -radius + e, width + e, -leg + e};
pulled() = Surface In BoundingBox {radius - e, -e, -leg - e, 2, width + e, -leg + e};
Physical Surface("slack") = slack();
Physical Surface("pulled") = pulled();
Physical Volume("solid") = Volume{:};
