// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef TETLAP_CONTACT_INTERFACE_H
#define TETLAP_CONTACT_INTERFACE_H

// The force between two bodies, or a body and a shape (b = body_count + number of the shape). A body with
// itself (a = b): the force on the element of lower number of each pair; in all it is none.
typedef struct ContactInterface {
  int a, b;         // a < b, or a = b
  double force[3];  // on a [N]; the opposite acts on b
  double pressed;   // Σ |F_ij|: ∫ p dA, whatever its directions [N]
  double volume;    // Σ V_ij [m³]
  int active_count; // pairs with V > 0
  double centre[3]; // of pressure [m]; NaN: nothing presses
} ContactInterface;

#endif
