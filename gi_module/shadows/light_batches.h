// Light samples in the batches that kernels take, for a technique: only the light that it owns.
#pragma once

#include "gi_module/shadows/shadow_service.h"
#include "gi_module/transport/light_batch.h"
#include "gi_module/transport/light_plan.h"

namespace sunfleck::gi {

inline constexpr Counter light_batch_counter{"light_batches", "batches", "light samples",
                                             "Batches of light samples that kernels take, one dispatch each"};

// The samples of [first, first + count) whose cells are among `cells`, as rows in upload memory. There is always one
// batch, which may be empty: sums start and end with a batch.
Result<std::vector<LightBatch>> make_light_batches(const SampleSet& samples, const ShadowService& shadows,
                                                   CellSet cells, std::uint32_t first, std::uint32_t count,
                                                   gpu::FrameResources& resources);

// Whether a sample's light is of one of these cells, on any receiver.
bool owns_sample(CellSet cells, const LightSample& sample);

// The rows of all samples, in which those of other cells are dark. `storage` holds them where any are.
std::span<const shared::LightRow> owned_rows(const SampleSet& samples, CellSet cells,
                                             std::vector<shared::LightRow>& storage);

} // namespace sunfleck::gi
