// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter of a slice of a shaft of radius 1 about z, `segments` edges on its round side, for plane strain.
// Lengths in m.
segments = 8; thickness = 0.15;
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {0, 1, 0};
Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
Transfinite Curve{2} = segments + 1;
Transfinite Curve{1, 3} = Ceil(0.63*segments) + 1;
out[] = Extrude {0, 0, thickness} { Surface{1}; Layers{1}; };
Physical Surface("z_min") = {1};
Physical Surface("z_max") = {out[0]};
Physical Surface("y_min") = {out[2]};
Physical Surface("round") = {out[3]};
Physical Surface("x_min") = {out[4]};
Physical Volume("solid") = {out[1]};
