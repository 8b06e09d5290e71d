// SPDX-License-Identifier: GPL-3.0-or-later
// Its checks print before they throw, and cost half the speed; what they would guard is checked here.
#define CGAL_NDEBUG 1
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/convert_nef_polyhedron_to_polygon_mesh.h>

#include <array>
#include <exception>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

extern "C" {
#include "overlap/exact/cgal.h"
}

namespace {

typedef CGAL::Exact_predicates_inexact_constructions_kernel Predicates;
typedef CGAL::Exact_predicates_exact_constructions_kernel Exact;
typedef CGAL::Nef_polyhedron_3<Exact> Nef;
typedef CGAL::Surface_mesh<Exact::Point_3> Mesh;
typedef Exact::Exact_kernel Rational;

// A tetrahedron with positive orientation; vertex i is the caller's order[i].
struct Tet {
  std::array<Predicates::Point_3, 4> points;
  std::array<Exact::Point_3, 4> exact;
  std::array<int, 4> order{{0, 1, 2, 3}};
  bool is_flat;

  explicit Tet(const double *x) {
    for (int i = 0; i < 4; i++) points[i] = Predicates::Point_3(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    const CGAL::Orientation turn = CGAL::orientation(points[0], points[1], points[2], points[3]);
    is_flat = turn == CGAL::COPLANAR;
    if (turn == CGAL::NEGATIVE) {
      std::swap(points[2], points[3]);
      std::swap(order[2], order[3]);
    }
    for (int i = 0; i < 4; i++) exact[i] = Exact::Point_3(points[i].x(), points[i].y(), points[i].z());
  }

  Predicates::Tetrahedron_3 solid() const {
    return Predicates::Tetrahedron_3(points[0], points[1], points[2], points[3]);
  }
  bool encloses(const Tet &other) const {
    const Predicates::Tetrahedron_3 tet = solid();
    for (const Predicates::Point_3 &p : other.points)
      if (tet.has_on_unbounded_side(p)) return false;
    return true;
  }
  Nef nef() const {
    CGAL::Polyhedron_3<Exact> surface;
    surface.make_tetrahedron(exact[0], exact[1], exact[2], exact[3]);
    return Nef(surface);
  }
};

// A corner of the intersection as plain rationals, with its barycentric coordinates in both tetrahedra.
struct Corner {
  Rational::Point_3 point;
  std::array<std::array<Rational::FT, 4>, 2> shape; // [t][k] is 0 exactly in the plane of face k
};

typedef std::array<const Corner *, 3> Triangle;
typedef std::array<std::array<Rational::Vector_3, 4>, 2> Gradient;

// Barycentric coordinates of a tetrahedron: N_k(p) = slope_k·(p − x_0) for k > 0.
class Shape {
public:
  explicit Shape(const Tet &tet) : origin(CGAL::exact(tet.exact[0])) {
    std::array<Rational::Vector_3, 4> edge;
    for (int k = 1; k < 4; k++) edge[k] = CGAL::exact(tet.exact[k]) - origin;
    const Rational::FT det = CGAL::determinant(edge[1], edge[2], edge[3]);
    for (int k = 1; k < 4; k++) slope[k] = CGAL::cross_product(edge[k % 3 + 1], edge[(k + 1) % 3 + 1]) / det;
  }
  std::array<Rational::FT, 4> at(const Rational::Point_3 &p) const {
    std::array<Rational::FT, 4> shape;
    shape[0] = 1;
    for (int k = 1; k < 4; k++) {
      shape[k] = slope[k] * (p - origin);
      shape[0] -= shape[k];
    }
    return shape;
  }

private:
  Rational::Point_3 origin;
  std::array<Rational::Vector_3, 4> slope;
};

std::vector<Corner> find_corners(const Tet (&tets)[2], const Mesh &mesh) {
  const Shape shapes[2] = {Shape(tets[0]), Shape(tets[1])};
  std::vector<Corner> corners(mesh.num_vertices());
  for (const Mesh::Vertex_index v : mesh.vertices()) {
    Corner &corner = corners[v];
    corner.point = CGAL::exact(mesh.point(v));
    for (int t = 0; t < 2; t++) corner.shape[t] = shapes[t].at(corner.point);
  }
  return corners;
}

// The face of tetrahedron t whose plane holds the triangle, -1 if none.
int face_of(int t, const Triangle &triangle) {
  for (int k = 0; k < 4; k++) {
    bool is_in_plane = true;
    for (const Corner *corner : triangle) is_in_plane = is_in_plane && CGAL::is_zero(corner->shape[t][k]);
    if (is_in_plane) return k;
  }
  return -1;
}

// dV/dx_i += ∫ N_i n dA: over a triangle, its area vector times the mean of N_i at its corners.
void add_triangle(const Triangle &triangle, Gradient &gradient) {
  const int face[2] = {face_of(0, triangle), face_of(1, triangle)};
  const int owners = (face[0] >= 0) + (face[1] >= 0);
  if (owners == 0) throw std::logic_error("a facet of the intersection lies in no face of the input");
  const Rational::Vector_3 outward =
      CGAL::cross_product(triangle[1]->point - triangle[0]->point, triangle[2]->point - triangle[0]->point);
  for (int t = 0; t < 2; t++)
    for (int i = 0; i < 4 && face[t] >= 0; i++) {
      if (i == face[t]) continue;
      const Rational::FT sum = triangle[0]->shape[t][i] + triangle[1]->shape[t][i] + triangle[2]->shape[t][i];
      gradient[t][i] = gradient[t][i] + outward * Rational::FT(sum / (6 * owners));
    }
}

void find_gradient(const Tet (&tets)[2], const Mesh &mesh, double *gradient) {
  const std::vector<Corner> corners = find_corners(tets, mesh);
  Gradient sum;
  for (auto &vertices : sum) vertices.fill(CGAL::NULL_VECTOR);
  for (const Mesh::Face_index face : mesh.faces()) {
    Triangle triangle;
    Mesh::Halfedge_index edge = mesh.halfedge(face);
    for (const Corner *&corner : triangle) {
      corner = &corners[mesh.target(edge)];
      edge = mesh.next(edge);
    }
    add_triangle(triangle, sum);
  }
  for (int t = 0; t < 2; t++)
    for (int i = 0; i < 4; i++)
      for (int c = 0; c < 3; c++) gradient[12 * t + 3 * tets[t].order[i] + c] = CGAL::to_double(sum[t][i][c]);
}

// Of the pyramids from one corner over all triangles, six times: volume and the mean of its vertices.
void find_centroid(const Mesh &mesh, double *centroid) {
  const Rational::Point_3 apex = CGAL::exact(mesh.point(*mesh.vertices().begin()));
  Rational::FT volume = 0;
  Rational::Vector_3 sum = CGAL::NULL_VECTOR;
  for (const Mesh::Face_index face : mesh.faces()) {
    std::array<Rational::Vector_3, 3> way;
    Mesh::Halfedge_index edge = mesh.halfedge(face);
    for (Rational::Vector_3 &w : way) {
      w = CGAL::exact(mesh.point(mesh.target(edge))) - apex;
      edge = mesh.next(edge);
    }
    const Rational::FT part = CGAL::determinant(way[0], way[1], way[2]);
    volume += part;
    sum = sum + (way[0] + way[1] + way[2]) * Rational::FT(part / 4);
  }
  const Rational::Point_3 mean = apex + sum / volume;
  for (int c = 0; c < 3; c++) centroid[c] = CGAL::to_double(mean[c]);
}

unsigned intersect(const double *pair, const OverlapAnswer *answer) {
  const Tet tets[2] = {Tet(pair), Tet(pair + 12)};
  if (tets[0].is_flat || tets[1].is_flat) return OVERLAP_FLAT;
  if (!CGAL::do_intersect(tets[0].solid(), tets[1].solid())) return OVERLAP_DISJOINT;
  const Nef common = tets[0].nef() * tets[1].nef();
  if (common.number_of_volumes() < 2) return OVERLAP_DISJOINT; // the outside alone: no interior
  Mesh mesh;
  CGAL::convert_nef_polyhedron_to_polygon_mesh(common, mesh, true);
  // Of the exact value: to_double of a lazy number is content with an interval.
  *answer->volume = CGAL::to_double(CGAL::exact(CGAL::Polygon_mesh_processing::volume(mesh)));
  if (answer->gradient) find_gradient(tets, mesh, answer->gradient);
  if (answer->centroid) find_centroid(mesh, answer->centroid);
  return tets[0].encloses(tets[1]) || tets[1].encloses(tets[0]) ? OVERLAP_ENCLOSED : 0;
}

Status eval_pair(const void *, const double pair[24], const OverlapAnswer *answer) {
  overlap_ops_write_nothing(answer);
  try {
    *answer->flags = intersect(pair, answer);
  } catch (const std::bad_alloc &) {
    return status_no_memory("a Nef polyhedron");
  } catch (const std::exception &failure) {
    return status_fail(STATUS_SOLVER, "CGAL: %s", failure.what());
  } catch (...) {
    return status_fail(STATUS_SOLVER, "CGAL: unknown exception");
  }
  return STATUS_OK;
}

} // namespace

// clang-format off
extern "C" const OverlapOps overlap_cgal_ops = {
    "cgal",
    "CGAL: do_intersect, Nef_polyhedron_3, PMP::volume; the seed paper's ground truth",
    2.5e-3,             // seconds_per_pair
    nullptr,            // create
    eval_pair,
    nullptr,            // eval_batch
    nullptr,            // destroy
    nullptr,            // has_ghosts
    false,              // rejects_disjoint
    nullptr,            // eval_logits
    nullptr,            // eval_bounds
    nullptr,            // has_bounds
    nullptr,            // has_hessian
    overlap_ops_always, // has_centroid
    nullptr,            // has_gradient
    false,              // checks_finite
    false,              // lacks_scale
    nullptr,            // weights
    nullptr,            // eval_pull
    nullptr,            // eval_slopes
    nullptr,            // training
    nullptr,            // wants_origins
    false,              // gives_doubt
    false,              // gives_doubt_gradient
    nullptr,            // range
};
