// SPDX-License-Identifier: GPL-3.0-or-later
// A beam of 1 × 0.1 × 0.1 m along x, its axis on the x axis: a cantilever when "root" is fixed. `size` 0.03 gives
// 2 k tetrahedra, 0.013 about 5 k vertices, 0.0078 about 20 k. Lengths in m.
size = 0.03;
length = 1;
height = 0.1;
SetFactory("OpenCASCADE");
Box(1) = {0, -height/2, -height/2, length, height, height};
e = height/1000;
root() = Surface In BoundingBox{-e, -height, -height, e, height, height};
tip() = Surface In BoundingBox{length-e, -height, -height, length+e, height, height};
all() = Surface{:};
sides() = all();
sides() -= root();
sides() -= tip();
Physical Surface("root") = root();
Physical Surface("tip") = tip();
Physical Surface("sides") = sides();
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
