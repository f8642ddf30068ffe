// Views of the game's rooms for pictures without a window: one input that both programs play, and for each view the
// world of that moment as a scene that the path tracer reads.
#pragma once

#include "engine/core/result.h"

#include <filesystem>

namespace sunfleck::bench {

// Of the input, in which a view is the last step of a frame, and frame 0, spacing, 2 spacing, ... give a picture.
inline constexpr unsigned view_steps_per_frame = 10, view_spacing = 20;

// Plays the solution of a level from room to room. At the entry of each, the person rests until the picture is settled;
// then looks away and back within two thirds of a second, so that the second view is the first, seen while the person
// and the lantern in hand still turn. Writes into the folder:
//   views.walk        the input, to be played at `view_steps_per_frame`
//   ROOM-MOMENT.scene.json   the world then, with nothing that moves; moments are "settled" and, where anything in the
//                            room has moved since, "turning"
//   views.txt         a line for each view: room, moment, frame, camera, scene, parted by tabs
//   world.txt         exposure and hash of the last world, each on a line
Status write_views(const std::filesystem::path& level, const std::filesystem::path& folder);

// Writes a picture at half of its size in each direction: the means of four pixels each.
Status halve_picture(const std::filesystem::path& from, const std::filesystem::path& to);

} // namespace sunfleck::bench
