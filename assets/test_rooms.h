// The built-in test scenes. Each function fills an empty registry.
#pragma once

#include "assets/scene_builder.h"

#include <string_view>
#include <vector>

namespace sunfleck::assets {

void make_cornell(SceneBuilder& scene);       // the classic box: correctness, colour bleeding
void make_furnace(SceneBuilder& scene);       // closed box, albedo 0.5, emission 1: irradiance has a closed form
void make_area_room(SceneBuilder& scene);     // two large area lights, soft shadows (thesis fig. 5-1 left)
void make_table_room(SceneBuilder& scene);    // coloured walls, table, complex mover (fig. 5-1 centre)
void make_four_pillars(SceneBuilder& scene);  // occlusion everywhere, movers (fig. 5-1 right, 4-12)
void make_gap_room(SceneBuilder& scene);      // light through a narrow gap: sampling failure (fig. 6-1)
void make_near_occluder(SceneBuilder& scene); // an occluder that almost touches light samples (fig. 6-2)
void make_two_rooms(SceneBuilder& scene);     // a door, walls from 0 to 20 cm: leaks

void make_ring(SceneBuilder& scene);      // caustics of a metal ring (splatting, fig. 4)
void make_glass(SceneBuilder& scene);     // and of a glass bird
void make_arena(SceneBuilder& scene);     // a game level with a moving lamp
void make_hall(SceneBuilder& scene);      // arches and pillars, one spot light on the floor (8,000 triangles)
void make_gallery(SceneBuilder& scene);   // sculptures over a yellow floor (80,000 triangles)
void make_chamber(SceneBuilder& scene);   // marble, a moving spot light
void make_cave(SceneBuilder& scene);      // curved walls, moving lights
void make_classroom(SceneBuilder& scene); // many small occluders, four area lights
void make_office(SceneBuilder& scene);    // the same with two
void make_atrium(SceneBuilder& scene);    // 250,000 triangles, 60 materials

void make_lantern_house(SceneBuilder& scene); // the demo's level
void make_lantern_game(SceneBuilder& scene);  // the game's: doors that open to reflected light

// A furnace of another albedo and emission.
void make_furnace_of(SceneBuilder& scene, float albedo, float emission);

struct BuiltInScene {
    std::string_view name;
    void (*make)(SceneBuilder&);
};
const std::vector<BuiltInScene>& built_in_scenes();

} // namespace sunfleck::assets
