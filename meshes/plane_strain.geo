// SPDX-License-Identifier: GPL-3.0-or-later
// A slice of an elastic half-space below z = 0 in plane strain: fine at the origin, to `far` away, one element
// wide along y. For a cylinder pressed into it and dragged: Hertz, Cattaneo and Mindlin. Lengths in m.
near = 0.08; fine = near/28; far = 8*near; width = fine;
middle = 56; outward = 13; down = 16; deep = 10; rate = 1.33; // elements
x[] = {-far, -near, near, far};
For i In {0:3}
  Point(i + 1) = {x[i], 0, 0};
  Point(i + 11) = {x[i], 0, -near};
  Point(i + 21) = {x[i], 0, -far};
EndFor
For j In {0:2}
  For i In {1:3}
    Line(10*j + i) = {10*j + i, 10*j + i + 1};
  EndFor
EndFor
For j In {0:1}
  For i In {1:4}
    Line(100 + 10*j + i) = {10*j + i, 10*j + i + 10};
  EndFor
EndFor
n = 0;
For j In {0:1}
  For i In {1:3}
    n = n + 1;
    Curve Loop(n) = {10*j + i, 100 + 10*j + i + 1, -(10*j + i + 10), -(100 + 10*j + i)};
    Plane Surface(n) = {n};
  EndFor
EndFor
Transfinite Curve{2, 12, 22} = middle + 1;
Transfinite Curve{1, 11, 21} = outward + 1 Using Progression 1/rate;
Transfinite Curve{3, 13, 23} = outward + 1 Using Progression rate;
Transfinite Curve{101:104} = down + 1 Using Progression 1.07;
Transfinite Curve{111:114} = deep + 1 Using Progression rate;
Transfinite Surface{1:n};
out[] = Extrude {0, width, 0} { Surface{1:n}; Layers{1}; };
e = 1e-6;
bottom() = Surface In BoundingBox {-far - e, -e, -far - e, far + e, width + e, -far + e};
left() = Surface In BoundingBox {-far - e, -e, -far - e, -far + e, width + e, e};
right() = Surface In BoundingBox {far - e, -e, -far - e, far + e, width + e, e};
Physical Surface("outer") = {bottom(), left(), right()};
Physical Volume("solid") = Volume{:};
