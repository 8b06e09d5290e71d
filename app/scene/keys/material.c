// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "app/scene/keys/choices.h"
#include "fem/material/material.h"

static const char *finish_ogden(void *self, const char **key) {
  const FemMaterial *material = self;
  double sum = 0;
  *key = "exponents";
  for (int p = 0; p < 3; p++) {
    if (material->shares[p] > 0 && material->exponents[p] == 0)
      return "an exponent with a share must not be 0";
    sum += material->shares[p];
  }
  *key = "shares";
  return sum > 0 ? NULL : "one share at least must be positive";
}

const char *app_scene_keys_material_finish(void *self, const char **key) {
  const FemMaterial *material = self;
  *key = "poisson";
  if (material->law == FEM_MATERIAL_NEO_HOOKEAN_LOG && material->poisson < 0)
    return "neo_hookean_log needs ν ≥ 0, or it collapses; write law: neo_hookean beside it";
  *key = "plasticity";
  if (material->yield_stress > 0 && material->law != FEM_MATERIAL_STVK)
    return "plasticity is in the Green strain; write law: stvk beside it";
  *key = "fibre";
  if (material->fibre_stiffness > 0 && material->law == FEM_MATERIAL_LINEAR)
    return "fibres turn with the body, which the law linear cannot; write law: corotational, or another";
  return NULL;
}

static const SceneKey ogden_keys[] = {
    {"exponents", SCENE_VECTOR, AT(FemMaterial, exponents), .fallback = "[2, -2, 4]",
     .help = "α of three terms; may not be 0 where the share is not"},
    {"shares", SCENE_VECTOR, AT(FemMaterial, shares), .range = "[0, inf)", .fallback = "[1, 0, 0]",
     .help = "shares of μ of the terms, normalised to sum 1"},
    {0},
};
static const SceneSection ogden = {
    .help = "powers of the principal stretches", .keys = ogden_keys, .finish = finish_ogden};

static const SceneKey fibre_keys[] = {
    {"modulus", SCENE_NUMBER, AT(FemMaterial, fibre_stiffness), .unit = "Pa", .range = "(0, inf)",
     .required = "1e6", .help = "k of the energy k/2 E² with E the Green strain along the fibres"},
    {"direction", SCENE_DIRECTION, AT(FemMaterial, fibre_direction), .required = "[1, 0, 0]",
     .help = "at rest, as placed"},
    {"buckle", SCENE_SWITCH, AT(FemMaterial, fibres_buckle), .fallback = "false",
     .help = "they resist tension only"},
    {0},
};
static const SceneSection fibre = {.help = "transverse isotropy", .keys = fibre_keys};

static const SceneKey plasticity_keys[] = {
    {"yield", SCENE_NUMBER, AT(FemMaterial, yield_stress), .unit = "Pa", .range = "(0, inf)",
     .required = "2e5", .help = "yield stress in tension"},
    {"hardening", SCENE_NUMBER, AT(FemMaterial, hardening), .unit = "Pa", .range = "[0, inf)",
     .fallback = "0", .help = "isotropic: rise of the yield stress by plastic strain"},
    {0},
};
static const SceneSection plasticity = {.help = "J2 plasticity (von Mises)", .keys = plasticity_keys};

static const SceneKey material_keys[] = {
    {"law", SCENE_CHOICE, AT(FemMaterial, law), .fallback = "neo_hookean", .choices = &app_scene_choices_laws,
     .help = "constitutive law"},
    {"young", SCENE_NUMBER, AT(FemMaterial, young), .unit = "Pa", .range = "(0, inf)", .required = "1e6",
     .help = "Young's modulus E"},
    {"poisson", SCENE_NUMBER, AT(FemMaterial, poisson), .range = "(-1, 0.5)", .required = "0.4",
     .help = "Poisson's ratio ν; linear tetrahedra lock from about 0.45, `element: nodal` does not"},
    {"density", SCENE_NUMBER, AT(FemMaterial, density), .unit = "kg/m³", .range = "(0, inf)",
     .required = "1000", .help = "ρ at rest"},
    {"damping", SCENE_NUMBER, AT(FemMaterial, damping), .unit = "s", .range = "[0, inf)", .absent = -1,
     .absent_help = "`effects.damping`", .help = "stiffness-proportional damping β"},
    {"viscosity", SCENE_NUMBER, AT(FemMaterial, viscosity), .unit = "Pa s", .range = "[0, inf)",
     .fallback = "0",
     .help = "η of a Kelvin-Voigt solid: viscous stress 2η times the strain rate's deviator"},
    {"bulk_viscosity", SCENE_NUMBER, AT(FemMaterial, bulk_viscosity), .unit = "Pa s", .range = "[0, inf)",
     .fallback = "0", .help = "ζ: viscous pressure by the rate of volume change"},
    {"mooney", SCENE_NUMBER, AT(FemMaterial, mooney), .range = "[0, 1]", .fallback = "0.2",
     .help = "of mooney_rivlin: the second invariant's share c2/(c1 + c2) of μ"},
    {"ogden", SCENE_SECTION, .section = &ogden, .help = "terms of the law ogden"},
    {"plasticity", SCENE_SECTION, .section = &plasticity, .absent_help = "elastic",
     .help = "with the law stvk"},
    {"fibre", SCENE_SECTION, .section = &fibre, .absent_help = "no fibres",
     .help = "fibres along one direction"},
    {0},
};
const SceneSection app_scene_keys_material = {
    .help = "an elastic solid", .keys = material_keys, .finish = app_scene_keys_material_finish};
