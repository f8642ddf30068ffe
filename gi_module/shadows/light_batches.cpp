#include "gi_module/shadows/light_batches.h"

#include <cstring>

namespace sunfleck::gi {

bool owns_sample(CellSet cells, const LightSample& sample) {
    LightCell cell{path_part(sample.bounce, sample.punctual), sample.dynamic, false, false};
    for (const bool specular : {false, true})
        for (const bool on_mover : {false, true}) {
            cell.specular = specular;
            cell.on_mover = on_mover;
            if (cells[cell.index()])
                return true;
        }
    return false;
}

Result<std::vector<LightBatch>> make_light_batches(const SampleSet& samples, const ShadowService& shadows,
                                                   CellSet cells, std::uint32_t first, std::uint32_t count,
                                                   gpu::FrameResources& resources) {
    std::vector<LightBatch> batches;
    std::uint32_t place = first;
    const std::uint32_t end = first + count;
    const auto skip = [&] {
        while (place < end && !owns_sample(cells, samples.samples()[place]))
            ++place;
    };
    skip();
    do {
        LightBatch batch;
        batch.first = place;
        const bool any = place < end;
        batch.light_class = any ? samples.light_class_of(place) : 0;
        batch.dynamic = any && samples.samples()[place].dynamic;
        SUNFLECK_ASSIGN(batch.rows, resources.allocate(sizeof(shared::LightRow) * shared::lights_per_batch));
        while (place < end && batch.count < shared::lights_per_batch &&
               samples.light_class_of(place) == batch.light_class &&
               samples.samples()[place].dynamic == batch.dynamic && owns_sample(cells, samples.samples()[place])) {
            shared::LightRow row = samples.rows()[place];
            row.bitangent.w = shadows.lag(place++);
            std::memcpy(batch.rows.data + sizeof row * batch.count++, &row, sizeof row);
        }
        batches.push_back(batch);
        skip();
    } while (place < end);
    return batches;
}

std::span<const shared::LightRow> owned_rows(const SampleSet& samples, CellSet cells,
                                             std::vector<shared::LightRow>& storage) {
    storage.clear();
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (owns_sample(cells, samples.samples()[i]))
            continue;
        if (storage.empty())
            storage.assign(samples.rows().begin(), samples.rows().end());
        storage[i].intensity_slot *= vec4(0.0f, 0.0f, 0.0f, 1.0f);
    }
    return storage.empty() ? samples.rows() : std::span<const shared::LightRow>(storage);
}

} // namespace sunfleck::gi
