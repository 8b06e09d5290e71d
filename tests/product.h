// SPDX-License-Identifier: GPL-3.0-or-later
// A sink of second derivatives that keeps no matrix but multiplies with it: y += S d.
#ifndef TETLAP_TESTS_PRODUCT_H
#define TETLAP_TESTS_PRODUCT_H

#include <stdlib.h>

#include "contact/system.h"
#include "suite.h"

typedef struct Product {
  const double *d; // borrowed             (vertices, 3)
  double *y;       // the caller's (free)  (vertices, 3)
  int outer_count, dense_count;
} Product;

static inline double product_dot(const double *a, const double *b, int n) {
  double sum = 0;
  for (int k = 0; k < n; k++) sum += a[k] * b[k];
  return sum;
}

static inline void product_add_outer(void *self, int count, const int *vertices, const double *w,
                                     double scale) {
  Product *product = self;
  double along = 0;
  for (int k = 0; k < count; k++) along += product_dot(w + 3 * k, product->d + 3 * vertices[k], 3);
  for (int k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) product->y[3 * vertices[k] + c] += scale * along * w[3 * k + c];
  product->outer_count++;
}

static inline void product_add_dense(void *self, int count, const int *vertices, const double *matrix) {
  Product *product = self;
  for (int r = 0; r < 3 * count; r++)
    for (int c = 0; c < 3 * count; c++)
      product->y[3 * vertices[r / 3] + r % 3] +=
          matrix[3 * count * r + c] * product->d[3 * vertices[c / 3] + c % 3];
  product->dense_count++;
}

static inline Product product_of(const double *d, int vertex_count) {
  Product product = {.d = d, .y = calloc(3 * (size_t)vertex_count, sizeof(double))};
  ck_assert_ptr_nonnull(product.y);
  return product;
}

static inline ContactStiffnessSink product_sink(Product *product) {
  return (ContactStiffnessSink){product, product_add_outer, product_add_dense};
}

#endif
