// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include <math.h>

#include "app/scene/keys/choices.h"
#include "fem/model/compliance/laws.h"
#include "fem/scene/scene.h"

static const char *finish_contact(void *self, const char **key) {
  FemContactDef *contact = self;
  if (contact->potential == CONTACT_POTENTIAL_FIELD) return NULL;
  if (fem_scene_most_friction(contact) > 0) {
    *key = "friction";
    return "friction builds on the potential field; remove 'potential' and 'stiffness', whose unit differs, "
           "or the friction";
  }
  if (contact->viscosity > 0) {
    *key = "viscosity";
    return "viscous contact builds on the potential field; remove 'potential' and 'stiffness', whose unit "
           "differs, or the viscosity";
  }
  if (fem_laws_are_wanted(contact)) {
    *key = contact->law.law.kind == CONTACT_LAW_LINEAR ? "pairs" : "law";
    return "only the potential field takes a pressure law; remove 'potential' and 'stiffness', whose unit "
           "differs, or the law";
  }
  if (contact->smooth > 0) {
    *key = "smooth";
    return "only the potential field works on smooth surfaces; remove 'potential' and 'stiffness', whose "
           "unit differs, or 'smooth'";
  }
  return NULL;
}

static const char *finish_friction(void *self, const char **key) {
  const FemFrictionDef *friction = self;
  *key = "static";
  if (friction->at_rest > 0 && friction->at_rest < friction->coefficient)
    return "static must not be below coefficient: at rest friction is no smaller than in sliding";
  return NULL;
}

static const SceneKey friction_keys[] = {
    {"coefficient", SCENE_NUMBER, AT(FemFrictionDef, coefficient), .range = "[0, inf)", .required = "0.3",
     .help = "Coulomb's μ: friction is at most μ times the normal force"},
    {"static", SCENE_NUMBER, AT(FemFrictionDef, at_rest), .range = "[0, inf)", .absent_help = "`coefficient`",
     .help = "μ_s of what sticks: where it breaks away friction falls to `coefficient`"},
    {"length", SCENE_NUMBER, AT(FemFrictionDef, length), .unit = "m", .range = "[0, inf)", .fallback = "0",
     .help = "slid while it falls; at least, and if 0, twice the stretch of the contact's spring that "
             "μ_s − μ holds"},
    {0},
};
static const SceneSection friction = {
    .help = "Coulomb friction", .keys = friction_keys, .shorthand = "coefficient", .finish = finish_friction};
// Without one the pair has that of any two.
static const SceneKey pair_friction_keys[] = {
    {"coefficient", SCENE_NUMBER, AT(FemFrictionDef, coefficient), .range = "[0, inf)", .required = "0.3",
     .absent = NAN, .help = "μ between these two"},
    {"static", SCENE_NUMBER, AT(FemFrictionDef, at_rest), .range = "[0, inf)", .absent_help = "`coefficient`",
     .help = "μ_s, as above"},
    {"length", SCENE_NUMBER, AT(FemFrictionDef, length), .unit = "m", .range = "[0, inf)", .fallback = "0",
     .help = "as above"},
    {0},
};
static const SceneSection pair_friction = {.help = "friction between two",
                                           .keys = pair_friction_keys,
                                           .shorthand = "coefficient",
                                           .finish = finish_friction};

static const SceneKey rest_keys[] = {
    {"speed", SCENE_NUMBER, AT(FemContactDef, rest_speed), .unit = "m/s", .range = "(0, inf)",
     .absent_help = "`time.tolerance` times √(E/ρ) of the slowest body",
     .help = "every vertex of a body at rest is slower"},
    {"acceleration", SCENE_NUMBER, AT(FemContactDef, rest_acceleration), .unit = "m/s²", .range = "(0, inf)",
     .absent_help = "five times `speed` over `time`",
     .help = "its centre of mass is accelerated by less in the step after which it falls asleep"},
    {"time", SCENE_NUMBER, AT(FemContactDef, rest_time), .unit = "s", .range = "(0, inf)",
     .absent_help = "twenty times the travel time of a wave through the largest body",
     .help = "bodies that touch fall asleep together after all of them have been at rest for this time"},
    {0},
};
static const SceneSection rest = {.help = "when bodies count as at rest", .keys = rest_keys};

static const SceneKey power_keys[] = {
    {"exponent", SCENE_NUMBER, AT(FemContactLawDef, law.exponent), .range = "[1, inf)", .required = "2",
     .help = "n of p = P (d/D)ⁿ"},
    {"pressure", SCENE_NUMBER, AT(FemContactLawDef, law.pressure), .unit = "Pa", .range = "(0, inf)",
     .required = "1e6", .help = "P, the pressure at the depth D"},
    {"depth", SCENE_NUMBER, AT(FemContactLawDef, law.depth), .unit = "m", .range = "(0, inf)",
     .required = "1e-5", .help = "D"},
    {0},
};
static const SceneSection power = {.help = "p = P (d/D)ⁿ", .keys = power_keys};

static const SceneKey exponential_keys[] = {
    {"pressure", SCENE_NUMBER, AT(FemContactLawDef, law.pressure), .unit = "Pa", .range = "(0, inf)",
     .required = "1e6", .help = "P of p = P (exp(d/D) − 1)"},
    {"depth", SCENE_NUMBER, AT(FemContactLawDef, law.depth), .unit = "m", .range = "(0, inf)",
     .required = "1e-5", .help = "D: over this depth the pressure grows by e"},
    {0},
};
static const SceneSection exponential = {.help = "p = P (exp(d/D) − 1)", .keys = exponential_keys};

static const SceneKey law_keys[] = {
    {"power", SCENE_SECTION, .section = &power, MARK(FemContactLawDef, law.kind, CONTACT_LAW_POWER),
     .help = "p = P (d/D)ⁿ"},
    {"exponential", SCENE_SECTION, .section = &exponential,
     MARK(FemContactLawDef, law.kind, CONTACT_LAW_EXPONENTIAL), .help = "or p = P (exp(d/D) − 1)"},
    {"table", SCENE_PROFILE, AT(FemContactLawDef, law.table), .argument = "d", .unit = "m, Pa",
     .count_offset = offsetof(FemContactLawDef, law.table_count),
     MARK(FemContactLawDef, law.kind, CONTACT_LAW_TABLE),
     .help =
         "or rows [d, p], the first [0, 0], p increasing, joined by a smooth curve that rises as they do, "
         "straight beyond the last"},
    {"formula", SCENE_FORMULA, AT(FemContactLawDef, law.formula), .argument = "d", .unit = "Pa",
     MARK(FemContactLawDef, law.kind, CONTACT_LAW_FORMULA), .help = "or a formula of d [m]"},
    {0},
};
static const SceneSection law = {.help = "a pressure law p(d) in place of a stiffness",
                                 .keys = law_keys,
                                 .one_of = "power exponential table formula",
                                 .shorthand = "formula",
                                 PLACE(FemContactLawDef, place)};

static const SceneKey pair_keys[] = {
    {"bodies", SCENE_TWO, AT(FemContactPairDef, names), .required = "[block, ground]",
     .help = "two names, of bodies or a body and an obstacle; twice the same: a body with itself"},
    {"stiffness", SCENE_NUMBER, AT(FemContactPairDef, stiffness), .unit = "Pa/m", .range = "(0, inf)",
     .absent_help = "as between any two", .help = "c or κ between these two, as above"},
    {"friction", SCENE_SECTION, AT(FemContactPairDef, friction), .section = &pair_friction,
     .absent_help = "as between any two", .help = "μ between these two, alone or a mapping"},
    {"law", SCENE_SECTION, AT(FemContactPairDef, law), .section = &law,
     .absent_help = "as between any two; linear with a `stiffness`", .help = "p(d) between these two"},
    {0},
};
static const SceneSection pair = {.help = "values for two bodies",
                                  .size = sizeof(FemContactPairDef),
                                  .keys = pair_keys,
                                  .some_of = "stiffness friction law",
                                  PLACE(FemContactPairDef, place)};

static const SceneKey contact_keys[] = {
    {"stiffness", SCENE_NUMBER, AT(FemContactDef, stiffness), .unit = "Pa/m", .range = "(0, inf)",
     .absent_help =
         "with `field` from height and E of each two bodies that meet, so that the overlap is 2 % of their "
         "compression; otherwise E of the softest body",
     .help = "penalty stiffness c; higher: less overlap, shorter steps (κ in Pa with the potential `nodal`)"},
    {"potential", SCENE_CHOICE, AT(FemContactDef, potential), .fallback = "field",
     .choices = &app_scene_choices_potentials, .help = "how overlaps become pressure"},
    {"law", SCENE_SECTION, AT(FemContactDef, law), .section = &law, .absent_help = "linear, by `stiffness`",
     .help =
         "p(d): the pressure between two flat surfaces that overlap by d in all, of two bodies and of a body "
         "and an obstacle alike; a formula alone or a mapping; needs the potential `field`"},
    {"overlap", SCENE_NAME, AT(FemContactDef, overlap), .fallback = "clip",
     .choices = &app_scene_choices_overlaps,
     .help = "the model that computes the overlap volume of two tetrahedra: a name, or a file of yours, from "
             "the scene file: net.safetensors, mine.so, mine.py:name, mine.onnx, exec:COMMAND; wrappers stand before "
             "it, as in both=mine.so"},
    {"margin", SCENE_NUMBER, AT(FemContactDef, margin), .unit = "m", .range = "(0, inf)",
     .absent_help = "half the shortest mean edge of a body",
     .help = "pairs nearer than this are candidates; a step that moves a vertex farther is tried again with "
             "a smaller step"},
    {"smooth", SCENE_INTEGER, AT(FemContactDef, smooth), .range = "[0, 2]", .absent = -1,
     .absent_help = "as often as the overlap needs to be as deep as the facets' sagittas",
     .help = "how often the edges of a curved surface of linear elements are halved for contact, new points "
             "on a smooth surface through the vertices; needs the potential `field`"},
    {"crease", SCENE_NUMBER, AT(FemContactDef, crease), .unit = "°", .range = "(0, 90]", .fallback = "30",
     .help = "`smooth`: edges between faces that make a larger angle stay sharp"},
    {"friction", SCENE_SECTION, AT(FemContactDef, friction), .section = &friction,
     .absent_help = "no friction", .help = "contacts resist sliding; a number alone is its coefficient"},
    {"pairs", SCENE_LIST, AT(FemContactDef, pairs), .section = &pair,
     .count_offset = offsetof(FemContactDef, pair_count),
     .help = "other values for two given bodies; of several entries for the same two the last one is used"},
    {"viscosity", SCENE_NUMBER, AT(FemContactDef, viscosity), .unit = "Pa s/m²", .range = "(0, inf)",
     .absent_help = "none",
     .help =
         "η: dissipates energy in impacts by a pressure η d dd/dt in addition to κ d, d the depth; with the "
         "potential `field`"},
    {"rest", SCENE_SECTION, .section = &rest, .absent_help = "no body sleeps",
     MARK(FemContactDef, rest_is_on, true),
     .help =
         "bodies at rest sleep, without unknowns and contact search, until something approaches them; `{}` "
         "for the defaults"},
    {0},
};
const SceneSection app_scene_keys_contact = {
    .help = "bodies push each other apart", .keys = contact_keys, .finish = finish_contact};
