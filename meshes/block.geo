// SPDX-License-Identifier: GPL-3.0-or-later
// A cube of 0.2 m, standing on z = 0 around the z axis. Change `size` for a finer one. Lengths in m.
size = 0.05;
edge = 0.2;
SetFactory("OpenCASCADE");
Box(1) = {-edge/2, -edge/2, 0, edge, edge, edge};
e = edge/1000;
bottom() = Surface In BoundingBox{-edge/2-e, -edge/2-e, -e, edge/2+e, edge/2+e, e};
top() = Surface In BoundingBox{-edge/2-e, -edge/2-e, edge-e, edge/2+e, edge/2+e, edge+e};
all() = Surface{:};
sides() = all();
sides() -= bottom();
sides() -= top();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("sides") = sides();
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
