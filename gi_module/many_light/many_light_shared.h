// Constants and structs that the kernels of the many-light system share with the CPU.
//
// Pixels are lit in pixel groups of 64: tiles of 8x8 pixels of the low-resolution picture, or 64 pixels of one region
// that are lit again at full resolution (repaired). The pixels of a group lie on few nodes (surface patches, movers),
// the group's local nodes; the visibility rows of these are merged into two light lists: samples (VPLs) that need a
// shadow test at some of the pixels, and samples that need none.
//
// An entry is a place for a pixel in a group: entry / 64 is the group.
#ifndef SUNFLECK_GI_MANY_LIGHT_MANY_LIGHT_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_MANY_LIGHT_SHARED_H
#include "engine/core/shader_language.h"
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/flat_shading_shared.h"
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// Local nodes 0 to 9 of a pixel group are nodes of its own. Number 10 collects pixels on further nodes or on none:
// there every sample is tested.
SHARED_CONSTANT uint local_node_count = 11u;
SHARED_CONSTANT uint other_nodes = 10u;
SHARED_CONSTANT uint entry_on_mover = 256u;    // flag of an entry's local node: the pixel shows a mover
SHARED_CONSTANT uint entry_is_baked = 512u;    // the same, in passes for baked light: the list applies to this pixel
SHARED_CONSTANT uint node_baked = 0x80000000u; // flag of an entry's node: the pixel uses baked light
SHARED_CONSTANT uint node_normal_differs = 0x40000000u; // the shading normal is not that of its light map: unusable
SHARED_CONSTANT uint node_mask = 0x3fffffffu;

// An element of a light list: index of the sample in the batch in bits 0 to 8, then two bits per local node, so that
// the light of a pixel does not depend on the other pixels of its group. From bit 20 (tests): whether the local node's
// pixels are shadow-tested. From bit 9 (values): if so, whether the node's light map already contains the sample's
// unshadowed light, so that only the blocked part is subtracted; if not, whether the sample's light is still to be
// added.
SHARED_CONSTANT uint list_sample_mask = 0x1ffu;
SHARED_CONSTANT uint list_values_shift = 9u;
SHARED_CONSTANT uint list_tests_shift = 20u;

// By node: its light map.
struct NodeRow {
    vec4 place; // planar nodes: lowest u, v and extents in the chart
    uint chart;
    uint first_texel; // no_light_map if it has none
    uint columns;     // of texels; the first and the last lie on the patch's border
    uint rows;
};
SHARED_CONSTANT uint no_light_map = 0xffffffffu;

// Lengths of a pixel group's light lists for one batch.
struct LightListCounts {
    uint tested;
    uint untested;
};

// Which pixels of a stage's pixel groups a pass processes. With baked light, rough pixels are gathered into groups of
// their own and lit first; then follow corrections for the pixels that use baked light.
SHARED_CONSTANT uint phase_plain = 0u; // all pixels of the stage's groups
SHARED_CONSTANT uint phase_rough = 1u; // the list of entries without baked light
SHARED_CONSTANT uint phase_baked = 2u; // pixels with baked light in the stage's groups

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
    uint list_stride; // list elements per pixel group
    uint batch_first; // first sample of the batch
    uint batch_count;
    uint words_per_row; // of the visibility database, see VisibilityDatabase::rows
    uint state_words;
    uint flag_words;
    uint map_resolution;
    float fixed_point; // light map steps per W/m2
    uint node_count;
    uint first_mover;  // nodes from here on are movers
    uint entry_blocks; // blocks of pixel groups, for the list of rough entries
    uint mover_count;
    float refined_share; // of refined light: RefinedLight::share
};
SHARED_CONSTANT uint pixel_groups_per_block = 4u;
SHARED_CONSTANT uint max_culled_movers = 32u; // with more, light lists are not culled by movers

// False colours that show.comp shows in place of the irradiance.
SHARED_CONSTANT uint show_nothing = 0u;
SHARED_CONSTANT uint show_tiles = 1u;      // red: samples with a shadow test, green: without, as fractions of all
SHARED_CONSTANT uint show_repaired = 2u;   // pixels that are lit again at full resolution
SHARED_CONSTANT uint show_visibility = 3u; // red: partial, green: none, blue: full
SHARED_CONSTANT uint show_staleness = 4u;  // mean age of the shadow maps needed: blue fresh, red eight frames
SHARED_CONSTANT uint show_light_maps = 5u; // W/m2
// Green: baked light, plus blue where movers shadow it; red: lit by all samples. Brightness follows the light.
SHARED_CONSTANT uint show_baked = 6u;
SHARED_CONSTANT uint show_patches = 7u; // a colour for each node of the visibility database
// Shares of all samples, cyan (none) over green and yellow to red (all): with a shadow test; fully blocked; that may
// light the node; that a mover may shadow; that static geometry may shadow.
SHARED_CONSTANT uint show_shadow_tests = 8u;
SHARED_CONSTANT uint show_hidden = 9u;
SHARED_CONSTANT uint show_lighting = 10u;
SHARED_CONSTANT uint show_mover_shadows = 11u;
SHARED_CONSTANT uint show_static_shadows = 12u;

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::NodeRow) == 32);
static_assert(sizeof(sunfleck::shared::ManyLightConstants) == 88);
static_assert(sunfleck::shared::lights_per_batch <= sunfleck::shared::list_sample_mask + 1);
static_assert(sunfleck::shared::list_values_shift + sunfleck::shared::local_node_count <=
              sunfleck::shared::list_tests_shift);
static_assert(sunfleck::shared::list_tests_shift + sunfleck::shared::local_node_count <= 32);
#endif
#endif
