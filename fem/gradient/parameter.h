// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a scene: which there are, their values, and which of them do not act.
#ifndef TETLAP_FEM_GRADIENT_PARAMETER_H
#define TETLAP_FEM_GRADIENT_PARAMETER_H

#include "fem/model/model.h"

typedef enum FemParameterKind {
  FEM_PARAMETER_YOUNG,             // E of a part at fixed ν [Pa]
  FEM_PARAMETER_POISSON,           // ν of a part at fixed E
  FEM_PARAMETER_MOONEY,            // of mooney_rivlin: the second invariant's share
  FEM_PARAMETER_OGDEN_EXPONENT,    // of ogden, α of a term (`row`)
  FEM_PARAMETER_OGDEN_SHARE,       // of ogden, the share of a term (`row`) before it is normalised
  FEM_PARAMETER_FIBRE,             // modulus of a part's fibres [Pa]
  FEM_PARAMETER_FIBRE_DIRECTION,   // of that, a component (`row`); its length does not act
  FEM_PARAMETER_DAMPING,           // β of a part, or (part −1) of all that have none of their own [s]
  FEM_PARAMETER_VISCOSITY,         // of a part [Pa s]
  FEM_PARAMETER_BULK_VISCOSITY,    // of a part [Pa s]
  FEM_PARAMETER_YIELD,             // yield stress of a part [Pa]
  FEM_PARAMETER_HARDENING,         // of a part [Pa]
  FEM_PARAMETER_DENSITY,           // of a part [kg/m³]
  FEM_PARAMETER_GRAVITY,           // a component [m/s²]
  FEM_PARAMETER_LOAD,              // loads[item] of a body: a component of its vector, or its pressure
  FEM_PARAMETER_VELOCITY,          // a component of a prescribed motion's velocity [m/s]
  FEM_PARAMETER_AMPLITUDE,         // of its amplitude [m]
  FEM_PARAMETER_FREQUENCY,         // [Hz]
  FEM_PARAMETER_SPIN,              // [rad/s]
  FEM_PARAMETER_TABLE,             // a displacement of its table, `component` of `row` [m]
  FEM_PARAMETER_PLACE,             // a coordinate of where a body or an obstacle stands [m]
  FEM_PARAMETER_SCALE,             // of a body's mesh: a factor, or (component −1) all three
  FEM_PARAMETER_ROTATE,            // the angle that it is turned by [°]
  FEM_PARAMETER_REST,              // a coordinate of a body's vertex (`row`) at rest [m]
  FEM_PARAMETER_CONTACT_STIFFNESS, // κ as the scene gives it for all pairs
  FEM_PARAMETER_PAIR_STIFFNESS,    // κ of contact.pairs[item]
  FEM_PARAMETER_LAW_PRESSURE,      // of contact.law, or of that of contact.pairs[item]: P [Pa]
  FEM_PARAMETER_LAW_DEPTH,         // D [m]
  FEM_PARAMETER_LAW_EXPONENT,      // n
  FEM_PARAMETER_LAW_TABLE,         // the pressure in `row` of its table [Pa]
  FEM_PARAMETER_FRICTION,          // μ of all that have none of their own in contact.pairs
  FEM_PARAMETER_PAIR_FRICTION,     // μ of contact.pairs[item]
  FEM_PARAMETER_START,             // a component of the velocity that a body starts with [m/s]
  FEM_PARAMETER_START_SPIN,        // of the angular velocity that it starts with [rad/s]
  FEM_PARAMETER_CONTACT_VISCOSITY, // acts in motions alone, where there is no derivative by it
} FemParameterKind;

typedef struct FemParameter {
  FemParameterKind kind;
  int body;     // of the scene's bodies; −1: none
  int part;     // of the model's, where it is of a material; −1: none
  int obstacle; // of the scene's obstacles; −1: none
  int item;     // of the body's loads or driven entries, of the contact's pairs; −1: none
  int row, component;
} FemParameter;

bool fem_parameter_is_of_material(const FemParameter *parameter); // acts by forces within its part
bool fem_parameter_is_of_yielding(const FemParameter *parameter); // of its part's plasticity
bool fem_parameter_is_of_motion(const FemParameter *parameter);   // of a prescribed motion
bool fem_parameter_is_of_shape(const FemParameter *parameter);    // moves a body's rest positions
bool fem_parameter_moves_rest(const FemParameter *parameter);     // of its shape, or of its place
bool fem_parameter_is_of_law(const FemParameter *parameter);      // of a pressure law of contact

// STATUS_INPUT: the scene does not give it, or no derivative is known; the message says why.
Status fem_parameter_check(const FemModel *model, const FemParameter *parameter);
// Why a parameter that was checked changes nothing, so that its derivatives are 0; NULL: it may.
const char *fem_parameter_idle(const FemModel *model, const FemParameter *parameter);
// As the scene gives it.
double fem_parameter_value(const FemModel *model, const FemParameter *parameter);
const char *fem_parameter_unit(const FemModel *model, const FemParameter *parameter);

// The number of a material that is this constant (`row` of ogden's terms or of the fibres' direction), and
// that of a motion that is this parameter.
double *fem_parameter_of_material(FemMaterial *material, FemParameterKind kind, int row);
double *fem_parameter_of_motion(FemConstraintDef *motion, const FemParameter *parameter);

// ∂λ/∂p, ∂μ/∂p by E and by ν.
FemLame fem_parameter_lame_rate(const FemMaterial *material, FemParameterKind kind);

// The prescribed motion that a parameter is of: driven[item] of its body, or its obstacle's.
const FemConstraintDef *fem_parameter_motion(const FemModel *model, const FemParameter *parameter);
// The law that a parameter is of; NULL: the scene has none there.
const ContactLaw *fem_parameter_law(const FemModel *model, const FemParameter *parameter);
// The entry of contact.pairs that gives two parties their stiffness or law, −1: none does.
int fem_parameter_pair(const FemModel *model, int a, int b);
// The same of their friction.
int fem_parameter_friction_pair(const FemModel *model, int a, int b);

#endif
