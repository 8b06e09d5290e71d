// SPDX-License-Identifier: GPL-3.0-or-later
// Singular values of a 3 × 3 matrix with both factors proper rotations: F = U diag(σ) Vᵀ, det U = det V = +1,
// σ₁ ≥ σ₂ ≥ |σ₃|, and the sign of det F is the sign of σ₃ (Irving, Teran, Fedkiw 2004). So R = U Vᵀ is the
// rotation nearest to F, for inverted F too. Matrices are row-major.
#ifndef TETLAP_FEM_MATERIAL_SVD3_H
#define TETLAP_FEM_MATERIAL_SVD3_H

typedef struct FemSvd3 {
  double U[9];
  double sigma[3];
  double V[9];
} FemSvd3;

// One-sided Jacobi (Hestenes 1958), to rounding for every finite F: zero, rank-deficient, any scale. Where
// singular values coincide or vanish the factors are one valid choice. NaN or infinity in F make a
// singular value NaN or infinite.
void fem_svd3_factor(FemSvd3 *svd, const double F[9]);

// R = U Vᵀ.
void fem_svd3_rotation(const FemSvd3 *svd, double R[9]);

#endif
