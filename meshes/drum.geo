// SPDX-License-Identifier: GPL-3.0-or-later
// The upper half of a drum of radius 1 about the y axis, its rim only, down to z = -leg: what meshes/strip.geo
// lies on. One element wide. Lengths in m.
radius = 1; inner = 0.95; leg = radius/4; width = 0.06;
along = 40; // elements of a quarter turn
For k In {0:1}
  r = inner + k*(radius - inner);
  Point(10*k + 2) = {-r, 0, 0};
  Point(10*k + 3) = {0, 0, r};
  Point(10*k + 4) = {r, 0, 0};
EndFor
Point(100) = {0, 0, 0};
For k In {0:1}
  Circle(10*k + 2) = {10*k + 2, 100, 10*k + 3};
  Circle(10*k + 3) = {10*k + 3, 100, 10*k + 4};
EndFor
For i In {2:4}
  Line(50 + i) = {i, 10 + i};
  Transfinite Curve{50 + i} = 2;
EndFor
For i In {2:3}
  Curve Loop(i) = {i, 51 + i, -(10 + i), -(50 + i)};
  Plane Surface(i) = {i};
  Transfinite Surface{i};
EndFor
Transfinite Curve{2, 12, 3, 13} = along + 1;
out[] = Extrude {0, width, 0} { Surface{2:3}; Layers{1}; };
Physical Volume("solid") = Volume{:};
