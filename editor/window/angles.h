// Rotations as three angles, degrees: a turn about z, then about x, then about the upright y, so that in a room y is
// where something looks, x how far it looks up, and z how far it is tilted sideways.
#pragma once

#include "engine/core/maths.h"

namespace sunfleck::editor {

using Angles = glm::dvec3;

// x within 90, y and z within 180.
Angles angles_of(const quat& rotation);
quat rotation_of(const Angles& angles);

// One rotation has many angles: these are shown for exactly this rotation from now on, as somebody has typed or dragged
// them. The newest thousands are kept.
void remember_angles(const quat& rotation, const Angles& angles);
// What was remembered, else angles_of.
Angles shown_angles(const quat& rotation);

} // namespace sunfleck::editor
