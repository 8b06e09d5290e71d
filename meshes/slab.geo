// SPDX-License-Identifier: GPL-3.0-or-later
// A slab of 0.6 × 0.6 × 0.05 m, its top in z = 0: a floor or, turned, a press plate. Lengths in m.
size = 0.05;
width = 0.6;
height = 0.05;
SetFactory("OpenCASCADE");
Box(1) = {-width/2, -width/2, -height, width, width, height};
e = height/1000;
top() = Surface In BoundingBox{-width, -width, -e, width, width, e};
bottom() = Surface In BoundingBox{-width, -width, -height-e, width, width, -height+e};
all() = Surface{:};
sides() = all();
sides() -= top();
sides() -= bottom();
Physical Surface("top") = top();
Physical Surface("bottom") = bottom();
Physical Surface("sides") = sides();
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
