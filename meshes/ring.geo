// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter of a slice of a ring about z, of radii 1 and 2, `segments` edges on its round sides, for plane strain.
// Lengths in m.
segments = 10; layers = 6; thickness = 0.15;
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {0, 1, 0};
Point(4) = {2, 0, 0};
Point(5) = {0, 2, 0};
Circle(1) = {2, 1, 3};
Line(2) = {3, 5};
Circle(3) = {5, 1, 4};
Line(4) = {4, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = segments + 1;
Transfinite Curve{2, 4} = layers + 1;
Transfinite Surface{1};
out[] = Extrude {0, 0, thickness} { Surface{1}; Layers{1}; };
Physical Surface("z_min") = {1};
Physical Surface("z_max") = {out[0]};
Physical Surface("hole") = {out[2]};
Physical Surface("x_min") = {out[3]};
Physical Surface("y_min") = {out[5]};
Physical Volume("solid") = {out[1]};
