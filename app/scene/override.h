// SPDX-License-Identifier: GPL-3.0-or-later
// `--set key=value`: changes a scene's tree before it is read, so an override is checked like the file
// itself.
//
//   contact.stiffness=1e6              a key in a section, which is made if the file has none
//   bodies.lower.material.young=2e6    an item of a list by its name …
//   bodies[0].velocity=[0, 0, -1]      … or by its number; the value is YAML or JSON
//   contact=null                       as if the key were not there
#ifndef TETLAP_APP_SCENE_OVERRIDE_H
#define TETLAP_APP_SCENE_OVERRIDE_H

#include "app/scene/tree.h"

// STATUS_USAGE: no '=', a path that leads nowhere, a value that is no YAML. `override` is kept, not copied.
Status app_scene_override_apply(SceneNode *root, const char *override);

#endif
