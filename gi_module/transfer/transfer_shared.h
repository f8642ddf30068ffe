// Constants of the passes that draw movers lit by precomputed transfer.
#ifndef SUNFLECK_GI_TRANSFER_TRANSFER_SHARED_H
#define SUNFLECK_GI_TRANSFER_TRANSFER_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

struct TransferConstants {
    uint row;         // of the instance
    int first_vertex; // of the mesh, in the vertex buffers
};

// Of the reverse depth, relative: fragments that differ by more belong to another layer of the mover.
SHARED_CONSTANT float transfer_depth_tolerance = 5e-4f;

SHARED_END
#endif
