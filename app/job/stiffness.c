// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/stiffness.h"

#include "base/text.h"
#include "contact/surface/smooth/smooth_points.h"
#include "fem/model/compliance/laws.h"

static const char *const reasons[] = {
    [FEM_COMPLIANCE_SCENE] = "given by the scene",
    [FEM_COMPLIANCE_BODIES] = "by 2 % of the bodies' compression",
    [FEM_COMPLIANCE_BLOW] = "by the hardest impact",
    [FEM_COMPLIANCE_ELEMENTS] = "by the elements at curved surfaces",
    [FEM_COMPLIANCE_LEAVES] = "by the elements of leaves that bend together",
    [FEM_COMPLIANCE_TIP] = "by the elements at a tip",
};
enum { REASONS = sizeof reasons / sizeof *reasons };

// A reason with the first two that it holds for.
static void add_reason(const FemModel *model, const FemCompliance *choice, FemComplianceBound reason,
                       char *text, size_t size, size_t *used) {
  int count = 0;
  for (int a = 0; a < model->scene->body_count; a++)
    for (int b = a; b < choice->party_count; b++) {
      if (!fem_compliance_meets(model, a, b) || choice->bounds[a * choice->party_count + b] != reason)
        continue;
      if (count++ == 0)
        text_append(text, size, used, ", %s ('%s' and '%s'", reasons[reason],
                    fem_compliance_party_name(model, a), fem_compliance_party_name(model, b));
    }
  if (count > 1) text_append(text, size, used, " and %d more", count - 1);
  if (count > 0) text_append(text, size, used, ")");
}

void app_stiffness_describe(const FemModel *model, const FemCompliance *choice, char *text, size_t size) {
  const FemContactDef *contact = &model->scene->contact;
  size_t used = 0;
  double range[2];
  fem_compliance_range(model, choice, range);
  text_append(text, size, &used, "%.3g", range[0]);
  if (range[1] > range[0]) text_append(text, size, &used, " … %.3g", range[1]);
  text_append(text, size, &used, " %s", contact_def_potential_unit(contact->potential));
  if (contact->potential != CONTACT_POTENTIAL_FIELD) return;
  if (fem_laws_are_wanted(contact)) text_append(text, size, &used, ", of friction and of linear pairs");
  for (int reason = 0; reason < REASONS; reason++)
    add_reason(model, choice, (FemComplianceBound)reason, text, size, &used);
}

// A line names so many bodies, and counts the others.
enum { NAMED = 3 };

void app_stiffness_describe_levels(const FemModel *model, const FemCompliance *choice, char *text,
                                   size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (int level = 1; level <= CONTACT_SMOOTH_MOST_LEVEL; level++) {
    int count = 0;
    for (int b = 0; b < model->body_count; b++) {
      if (choice->levels[b] != level) continue;
      if (count++ == 0)
        text_append(text, size, &used, "%scurved edges in %d parts (", used ? ", " : "", 1 << level);
      if (count <= NAMED)
        text_append(text, size, &used, "%s'%s'", count > 1 ? ", " : "", fem_compliance_party_name(model, b));
    }
    if (count > NAMED) text_append(text, size, &used, " and %d more", count - NAMED);
    if (count > 0) text_append(text, size, &used, ")");
  }
  for (int b = 0; b < model->body_count; b++)
    if (choice->is_faceted[b])
      text_append(text, size, &used,
                  "%s'%s' touches with flat facets: 'curved: true' in its mesh curves its quadratic elements",
                  used ? "; " : "", fem_compliance_party_name(model, b));
}
