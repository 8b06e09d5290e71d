// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/box_intersection_d.h>

#include <cstddef>
#include <new>
#include <vector>

extern "C" {
#include "base/memory.h"
#include "contact/search/boxes.h"
}

namespace {

// CGAL's model of a box: points at the caller's bounds. The id breaks ties between equal coordinates and must
// be unique over both sequences; the boxes of b therefore count on where those of a end.
class Box {
public:
  typedef double NT;
  typedef std::size_t ID;

  Box(const double *bounds_, ID id_) : bounds(bounds_), number(id_) {}
  static int dimension() { return 3; }
  ID id() const { return number; }
  NT min_coord(int axis) const { return bounds[axis]; }
  NT max_coord(int axis) const { return bounds[axis + 3]; }

private:
  const double *bounds;
  ID number;
};

std::vector<Box> wrap(const double (*bounds)[6], int count, std::size_t first_id) {
  std::vector<Box> boxes;
  boxes.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; k++) boxes.emplace_back(bounds[k], first_id + static_cast<std::size_t>(k));
  return boxes;
}

void append(ContactBoxPairs *out, std::size_t a, std::size_t b) {
  if (out->count == out->capacity && !memory_reserve(reinterpret_cast<void **>(&out->pairs), &out->capacity,
                                                     out->count + 1, sizeof *out->pairs))
    throw std::bad_alloc();
  out->pairs[out->count][0] = static_cast<int>(a);
  out->pairs[out->count][1] = static_cast<int>(b);
  out->count++;
}

} // namespace

extern "C" Status contact_boxes_intersect(const double (*boxes_a)[6], int count_a, const double (*boxes_b)[6],
                                          int count_b, ContactBoxPairs *out) {
  if (count_a <= 0 || count_b <= 0) return STATUS_OK;
  const std::size_t first_b = static_cast<std::size_t>(count_a), kept = out->count;
  try {
    std::vector<Box> a = wrap(boxes_a, count_a, 0), b = wrap(boxes_b, count_b, first_b);
    CGAL::box_intersection_d(a.begin(), a.end(), b.begin(), b.end(), [=](const Box &box_a, const Box &box_b) {
      append(out, box_a.id(), box_b.id() - first_b);
    });
  } catch (const std::bad_alloc &) {
    out->count = kept;
    return status_no_memory("pairs of boxes");
  } catch (...) {
    out->count = kept;
    return status_fail(STATUS_SOLVER, "box intersection failed: are all bounds finite, min ≤ max?");
  }
  return STATUS_OK;
}

extern "C" void contact_boxes_destroy(ContactBoxPairs *pairs) {
  memory_free(pairs->pairs);
  *pairs = ContactBoxPairs();
}
