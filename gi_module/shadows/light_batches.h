// A technique's light samples (VPLs) in the batches that kernels process: only the light that it owns.
#pragma once

#include "gi_module/shadows/shadow_service.h"
#include "gi_module/transport/light_batch.h"
#include "gi_module/transport/light_plan.h"

namespace sunfleck::gi {

inline constexpr Counter light_batch_counter{"light_batches", "batches", "light samples",
                                             "Batches of light samples that kernels process, one dispatch each"};

// The samples of [first, first + count) whose cells are in `cells`, as rows in upload memory. There is always at least
// one batch, which may be empty: the first batch initialises the sums, the last one writes them out.
Result<std::vector<LightBatch>> make_light_batches(const SampleSet& samples, const ShadowService& shadows,
                                                   CellSet cells, std::uint32_t first, std::uint32_t count,
                                                   gpu::FrameResources& resources);

// Whether a sample's light belongs to one of these cells, on any receiver.
bool owns_sample(CellSet cells, const LightSample& sample);

// The rows of all samples, with intensity 0 for those of other cells. `storage` holds them if there are any.
std::span<const shared::LightRow> owned_rows(const SampleSet& samples, CellSet cells,
                                             std::vector<shared::LightRow>& storage);

} // namespace sunfleck::gi
