// Light samples as gloss.comp reads them: with the size of what each stands for.
#pragma once

#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/transport/light_batch.h"

namespace sunfleck::gi {

// How large a part of an emitter or of a lit surface a sample stands for: radius of a disc, m, or, of a directional
// one, the tangent of an angle. By sample.
std::vector<float> sizes_of_samples(const SampleSet& samples);

// Writes the sizes of a batch's samples into its rows (gloss_shared.h).
void write_sizes(const SampleSet& samples, std::span<const float> sizes, LightBatch& batch);

// Leaves every so many of a batch's samples of reflected light out, so that about one in `stride` is left; what is left
// has the light of all, and stands for so much more of the surface. Which these are depends on their order alone.
void thin_out(const SampleSet& samples, std::uint32_t stride, LightBatch& batch);

} // namespace sunfleck::gi
