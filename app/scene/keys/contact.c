// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include <math.h>
#include <string.h>

#include "app/scene/keys/choices.h"
#include "fem/scene/scene.h"
#include "overlap/model.h"

// Whether the model of that name gives the centroid of an overlap, without which there is no `field`.
static bool has_centroid(const char *overlap) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  for (int i = 0; i < count; i++)
    if (strcmp(models[i]->name, overlap) == 0) return models[i]->has_centroid != NULL;
  return false;
}

static const char *finish_contact(void *self, const char **key) {
  FemContactDef *contact = self;
  if (!contact->potential_is_given)
    contact->potential =
        !contact->net && has_centroid(contact->overlap) ? CONTACT_POTENTIAL_FIELD : CONTACT_POTENTIAL_NODAL;
  if (!contact->potential_is_given && contact->potential == CONTACT_POTENTIAL_NODAL &&
      contact->stiffness > 0) {
    *key = "stiffness";
    return "the overlap model gives no centroid, so the potential would be nodal, whose stiffness is in Pa, "
           "not field, "
           "whose stiffness is in Pa/m; name the potential";
  }
  if (contact->viscosity > 0 && contact->potential != CONTACT_POTENTIAL_NODAL &&
      contact->potential != CONTACT_POTENTIAL_FIELD) {
    *key = "viscosity";
    return "viscosity builds on the potential field or nodal; take one of the two keys away";
  }
  FemFrictionLaw law = fem_scene_friction_law(contact);
  if (fem_scene_most_friction(contact) > 0 && law == FEM_FRICTION_STICK &&
      contact->potential != CONTACT_POTENTIAL_FIELD) {
    *key = "friction";
    return "the law stick builds on the potential field; take that, or the law velocity";
  }
  if (contact->friction > 0 && law == FEM_FRICTION_STICK && contact->slip_speed > 0) {
    *key = "friction";
    return "slip_speed belongs to the law velocity; with stick nothing creeps: take slip_speed away";
  }
  return NULL;
}

static const SceneKey friction_keys[] = {
    {"coefficient", SCENE_NUMBER, AT(FemContactDef, friction), .range = "[0, inf)", .required = "0.3",
     .help = "Coulomb's μ: sliding resists with μ times the normal force"},
    {"law", SCENE_CHOICE, AT(FemContactDef, friction_law), .fallback = "auto",
     .choices = &app_scene_choices_frictions, .help = "how it resists"},
    {"slip_speed", SCENE_NUMBER, AT(FemContactDef, slip_speed), .unit = "m/s", .range = "(0, inf)",
     .absent_help = "1e-3 of the smallest body's size over `end`",
     .help =
         "of the law velocity: slower slip counts as sticking: what sticks creeps, more slowly than this"},
    {0},
};
static const SceneSection friction = {
    .help = "Coulomb friction", .keys = friction_keys, .shorthand = "coefficient"};

static const SceneKey net_keys[] = {
    {"weights", SCENE_TEXT, AT(FemContactDef, net), .absent_help = "those that ship with the model",
     .help =
         "of a learned model: a .safetensors file, path from the scene file, or a name; taken in place of "
         "`overlap`, or by `hybrid` as its network"},
    {"ghosts", SCENE_CHOICE, AT(FemContactDef, net_options.ghosts), .fallback = "auto",
     .choices = &app_scene_choices_ghosts, .help = "tpn: volumes of pairs that share none"},
    {"gate", SCENE_CHOICE, AT(FemContactDef, net_options.gate), .fallback = "auto",
     .choices = &app_scene_choices_gates, .help = "tpn: whether the status head has a say in V"},
    {"orders", SCENE_CHOICE, AT(FemContactDef, net_options.orders), .fallback = "auto",
     .choices = &app_scene_choices_orders,
     .help = "tpn, hybrid: in which order the two tetrahedra are shown to the network"},
    {"out_of_range", SCENE_CHOICE, AT(FemContactDef, net_options.beyond), .fallback = "auto",
     .choices = &app_scene_choices_beyond, .help = "tpn: pairs unlike those of the network's training"},
    {"coplanar", SCENE_CHOICE, AT(FemContactDef, net_options.coplanar), .fallback = "auto",
     .choices = &app_scene_choices_coplanar,
     .help = "tpn, hybrid: pairs with faces that nearly lie in one plane, whose V has kinks"},
    {"touch", SCENE_NUMBER, AT(FemContactDef, net_options.touch), .range = "(0, 1)", .fallback = "0.02",
     .help = "share of overlap up to which V is faded in; `hybrid` of tpn-scene takes exact up to there, the "
             "network from twice that"},
    {"doubt", SCENE_NUMBER, AT(FemContactDef, net_options.doubt), .range = "(0, inf)", .fallback = "0.005",
     .help = "hybrid of a geo: relative error of V that its bound may reach; from there on `clip` takes "
             "over, alone from twice that"},
    {"deep", SCENE_NUMBER, AT(FemContactDef, net_options.deep), .range = "(0, 2]", .fallback = "0.3",
     .help = "hybrid of tpn-scene: share of overlap up to which the network is taken, exact from one and a "
             "half times that"},
    {"confidence", SCENE_NUMBER, AT(FemContactDef, net_options.confidence), .range = "(0.5, 1)",
     .fallback = "0.95",
     .help = "hybrid of tpn-scene: probability of the status head from which the network is taken"},
    {0},
};
static const SceneSection net = {
    .help = "how networks that follow the paper are used", .keys = net_keys, .shorthand = "weights"};

static const SceneKey rest_keys[] = {
    {"speed", SCENE_NUMBER, AT(FemContactDef, rest_speed), .unit = "m/s", .range = "(0, inf)",
     .absent_help = "`time.tolerance` times √(E/ρ) of the slowest body",
     .help = "every vertex of a calm body is slower"},
    {"acceleration", SCENE_NUMBER, AT(FemContactDef, rest_acceleration), .unit = "m/s²", .range = "(0, inf)",
     .absent_help = "five times `speed` over `time`",
     .help = "its centre of mass is accelerated by less in the step after which it falls asleep"},
    {"time", SCENE_NUMBER, AT(FemContactDef, rest_time), .unit = "s", .range = "(0, inf)",
     .absent_help = "twenty times what a wave takes through the largest body",
     .help = "what touches falls asleep together once all of it has been calm for so long"},
    {0},
};
static const SceneSection rest = {.help = "when bodies are at rest", .keys = rest_keys};

static const SceneKey pair_keys[] = {
    {"bodies", SCENE_TWO, AT(FemContactPairDef, names), .required = "[block, ground]",
     .help = "two names, of bodies or a body and an obstacle; twice the same: a body with itself"},
    {"stiffness", SCENE_NUMBER, AT(FemContactPairDef, stiffness), .unit = "Pa", .range = "(0, inf)",
     .absent_help = "as between any two", .help = "κ between these two, as above"},
    {"friction", SCENE_NUMBER, AT(FemContactPairDef, friction), .range = "[0, inf)", .absent = NAN,
     .absent_help = "as between any two", .help = "μ between these two"},
    {0},
};
static const SceneSection pair = {.help = "what holds between two",
                                  .size = sizeof(FemContactPairDef),
                                  .keys = pair_keys,
                                  .some_of = "stiffness friction",
                                  PLACE(FemContactPairDef, place)};

static const SceneKey contact_keys[] = {
    {"stiffness", SCENE_NUMBER, AT(FemContactDef, stiffness), .unit = "Pa", .range = "(0, inf)",
     .absent_help =
         "E of the softest body (with `body` over its smallest mean element volume); with `field` from "
         "height and E of each two that meet, such that what touches gives way by 2 % of what they do",
     .help = "penalty κ; higher: less overlap, shorter steps (Pa/m with the potential `field`, Pa/m³ with "
             "`body`)"},
    {"potential", SCENE_CHOICE, AT(FemContactDef, potential),
     .absent_help = "`field`; `nodal` with weights that `net` names, and with an overlap model that gives no "
                    "centroid (`tpn`, `tpn-bf16`, `tpn-published`, `tpn-scene`)",
     MARK(FemContactDef, potential_is_given, true), .choices = &app_scene_choices_potentials,
     .help = "how overlaps become pressure"},
    {"overlap", SCENE_NAME, AT(FemContactDef, overlap), .fallback = "clip",
     .choices = &app_scene_choices_overlaps,
     .help = "the model that gives the overlap volume of two tetrahedra"},
    {"net", SCENE_SECTION, .section = &net, .help = "of a learned model: its weights, or more in a mapping"},
    {"margin", SCENE_NUMBER, AT(FemContactDef, margin), .unit = "m", .range = "(0, inf)",
     .absent_help = "half the shortest mean edge of a body",
     .help = "pairs nearer than this are listed; a step that moves farther is tried again smaller"},
    {"hessian", SCENE_CHOICE, AT(FemContactDef, use_full_hessian), .fallback = "full",
     .choices = &app_scene_choices_hessians, .help = "derivatives of the contact force for Newton's method"},
    {"friction", SCENE_SECTION, .section = &friction, .absent_help = "no friction",
     .help = "what touches resists sliding; a number alone is its coefficient"},
    {"pairs", SCENE_LIST, AT(FemContactDef, pairs), .section = &pair,
     .count_offset = offsetof(FemContactDef, pair_count),
     .help = "what holds between some two in place of the above; of entries for the same two the last one"},
    {"viscosity", SCENE_NUMBER, AT(FemContactDef, viscosity), .unit = "Pa s", .range = "(0, inf)",
     .absent_help = "none",
     .help = "η: takes energy out of impacts. With `field` a pressure η d dd/dt beside κ d, d the depth [Pa "
             "s/m²]; with "
             "`nodal` η w dw/dt beside κ w, w the covered share of a vertex"},
    {"rest", SCENE_SECTION, .section = &rest, .absent_help = "no body sleeps",
     MARK(FemContactDef, rest_is_on, true),
     .help = "bodies at rest sleep, without unknowns and contact search, until something nears them; `{}` "
             "for the defaults"},
    {0},
};
const SceneSection app_scene_keys_contact = {.help = "bodies push each other apart",
                                             .keys = contact_keys,
                                             PLACE(FemContactDef, place),
                                             .finish = finish_contact};
