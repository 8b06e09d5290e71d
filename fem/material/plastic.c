// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/plastic.h"

#include <math.h>

FemPlasticReturn fem_plastic_return(const FemMaterial *material, const FemPlastic *history,
                                    const double E[9]) {
  FemPlasticReturn r = {.plastic = *history};
  double mu = fem_material_lame(material).mu, trace = (E[0] + E[4] + E[8]) / 3, square = 0;
  for (int k = 0; k < 9; k++) {
    r.n[k] = 2 * mu * (E[k] - history->strain[k] - (k % 4 == 0 ? trace : 0));
    square += r.n[k] * r.n[k];
  }
  r.size = sqrt(square);
  double beyond = sqrt(1.5) * r.size - material->yield_stress - material->hardening * history->alpha;
  if (!(beyond > 0)) return r;
  r.growth = beyond / (3 * mu + material->hardening);
  for (int k = 0; k < 9; k++) {
    r.n[k] /= r.size;
    r.plastic.strain[k] += sqrt(1.5) * r.growth * r.n[k];
  }
  r.plastic.alpha += r.growth;
  r.along = 3 * mu / (3 * mu + material->hardening);
  r.across = sqrt(1.5) * r.growth * 2 * mu / r.size;
  return r;
}

static double dot(const double a[9], const double b[9]) {
  double sum = 0;
  for (int k = 0; k < 9; k++) sum += a[k] * b[k];
  return sum;
}

// By s: E_p grows along n = s/|s|, and by Δα, of which it is 1/(3μ + H) of q = √(3/2) |s|.
void fem_plastic_pull(const FemMaterial *material, const FemPlastic *history, const FemPlasticReturn *r,
                      const FemPlastic *by, FemPlasticSlope *slope) {
  for (int k = 0; k < 9; k++) slope->history.strain[k] += by->strain[k];
  slope->history.alpha += by->alpha;
  if (!(r->growth > 0)) return;
  double mu = fem_material_lame(material).mu, across = dot(by->strain, r->n);
  double by_beyond = (sqrt(1.5) * across + by->alpha) / (3 * mu + material->hardening), s[9];
  for (int k = 0; k < 9; k++)
    s[k] = sqrt(1.5) * (by_beyond * r->n[k] + r->growth / r->size * (by->strain[k] - across * r->n[k]));
  double trace = (s[0] + s[4] + s[8]) / 3;
  for (int k = 0; k < 9; k++) {
    slope->strain[k] += 2 * mu * (s[k] - (k % 4 == 0 ? trace : 0));
    slope->history.strain[k] -= 2 * mu * s[k];
  }
  slope->history.alpha -= by_beyond * material->hardening;
  slope->yield -= by_beyond;
  slope->hardening -= by_beyond * (history->alpha + r->growth);
  slope->mu += r->size / mu * dot(s, r->n) - 3 * by_beyond * r->growth;
}
