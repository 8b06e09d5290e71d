// SPDX-License-Identifier: GPL-3.0-or-later
// A box of 0.1 × 0.2 × 0.3 m with named groups: the same solid that every other file box.* describes.
Point(1) = {0, 0, 0, 0.1};
Extrude {0.1, 0, 0} { Point{1}; }
Extrude {0, 0.2, 0} { Curve{1}; }
Extrude {0, 0, 0.3} { Surface{5}; }
Physical Volume("solid") = {1};
Physical Surface("bottom") = {5};
Physical Surface("top") = {27};
Physical Curve("edge") = {1};
Physical Point("corner") = {1};
Physical Surface(7) = {14};
