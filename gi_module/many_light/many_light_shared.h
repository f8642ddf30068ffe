// What the kernels of the many-light system and the CPU agree on.
//
// Pixels are lit in groups of 64: tiles of 8x8 pixels of the low-resolution picture, or 64 pixels of one region that
// are lit again at full resolution. A group's pixels lie on few nodes (surface patches, movers); the visibility rows of
// those nodes are merged into two lists of samples: those that somewhere need a shadow test, and those that do not.
#ifndef SUNFLECK_GI_MANY_LIGHT_MANY_LIGHT_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_MANY_LIGHT_SHARED_H
#include "engine/core/shader_language.h"
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/flat_shading_shared.h"
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// Nodes of a group have slots 0 to 9. Slot 10 is for pixels of any further node, or of none: every sample is tested.
SHARED_CONSTANT uint local_node_count = 11u;
SHARED_CONSTANT uint other_nodes = 10u;
SHARED_CONSTANT uint entry_on_mover = 256u;    // beside the slot: the pixel shows a mover
SHARED_CONSTANT uint entry_is_baked = 512u;    // beside the slot, in lists for baked light: they are for this pixel
SHARED_CONSTANT uint node_baked = 0x80000000u; // beside an entry's node: its light comes from baked light
SHARED_CONSTANT uint node_normal_differs = 0x40000000u;  // shaded by another normal than its light map knows, which is not used
SHARED_CONSTANT uint node_mask = 0x3fffffffu;

// A list entry: sample (of the batch) in bits 0 to 8; then two bits for each slot, so that what lights a pixel does not
// depend on its company. From bit 20: whether the slot's pixels ask the shadow map. From bit 9: for those that ask,
// whether the slot's light map holds the sample's unshadowed light, so that only what is blocked is subtracted; for the
// others, whether the sample's light is still to be added.
SHARED_CONSTANT uint list_sample_mask = 0x1ffu;
SHARED_CONSTANT uint list_values_shift = 9u;
SHARED_CONSTANT uint list_tests_shift = 20u;

// By node: where its light map is.
struct NodeRow {
    vec4 place; // planar: lowest u, v and extents in its chart
    uint chart;
    uint first_texel; // of its light map; no_light_map if it has none
    uint columns;     // of texels; the first and last lie on the patch's border
    uint rows;
};
SHARED_CONSTANT uint no_light_map = 0xffffffffu;

// A group's lists for one batch.
struct LightListCounts {
    uint tested;
    uint untested;
};

// Which pixels of a stage's groups a pass is for. With baked light, the rough ones are gathered into groups of their
// own and lit first; then corrections follow for those that took baked light.
SHARED_CONSTANT uint phase_plain = 0u; // every pixel of the stage's groups
SHARED_CONSTANT uint phase_rough = 1u; // a list of entries without baked light
SHARED_CONSTANT uint phase_baked = 2u; // pixels with baked light, in the stage's groups

struct ManyLightConstants {
    uint width; // to cell_columns: as in LowResolutionConstants
    uint height;
    uint low_width;
    uint low_height;
    uint scale;
    uint group_columns;
    uint group_count;
    uint group_capacity;
    uint cell_columns;
    uint list_stride; // entries that a group may have
    uint batch_first; // sample
    uint batch_count;
    uint words_per_row; // of the visibility database, see VisibilityDatabase::rows
    uint state_words;
    uint flag_words;
    uint map_resolution;
    float fixed_point; // steps of a light map a W/m2
    uint node_count;
    uint first_mover;  // nodes from here on are movers
    uint entry_blocks; // blocks of groups, for the list of rough entries
    uint mover_count;
};
SHARED_CONSTANT uint pixel_groups_per_block = 4u;
SHARED_CONSTANT uint max_culled_movers = 32u; // that lists are culled by; with more, they are not

// What show.comp shows in place of the irradiance.
SHARED_CONSTANT uint show_nothing = 0u;
SHARED_CONSTANT uint show_tiles = 1u;      // red: samples with a shadow test, green: without, as shares of all
SHARED_CONSTANT uint show_repaired = 2u;   // pixels that are lit again at full resolution
SHARED_CONSTANT uint show_visibility = 3u; // red: partial, green: none, blue: full
SHARED_CONSTANT uint show_staleness = 4u;  // age of the shadow maps that a surface needs: blue fresh, red eight frames
SHARED_CONSTANT uint show_light_maps = 5u; // W/m2
// Green: from baked light, with blue where movers change that; red: lit by all samples; with brightness by the light.
SHARED_CONSTANT uint show_baked = 6u;

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::NodeRow) == 32);
static_assert(sizeof(sunfleck::shared::ManyLightConstants) == 84);
static_assert(sunfleck::shared::lights_per_batch <= sunfleck::shared::list_sample_mask + 1);
static_assert(sunfleck::shared::list_values_shift + sunfleck::shared::local_node_count <=
              sunfleck::shared::list_tests_shift);
static_assert(sunfleck::shared::list_tests_shift + sunfleck::shared::local_node_count <= 32);
#endif
#endif
