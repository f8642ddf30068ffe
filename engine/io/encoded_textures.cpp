#include "engine/io/encoded_textures.h"

#include "engine/core/jobs.h"
#include "engine/io/image.h"

namespace sunfleck::io {

Result<std::vector<std::shared_ptr<const std::string>>> EncodedTextures::of(const scene::TextureStore& textures) {
    std::vector<std::shared_ptr<const std::string>> result;
    {
        const std::scoped_lock lock(mutex_);
        result = known_;
    }
    result.resize(textures.size());
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < result.size(); ++i)
        if (result[i] == nullptr)
            missing.push_back(i);
    std::vector<Status> failed(missing.size());
    parallel_for_chunks(missing.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const scene::Texture& texture = textures[std::uint32_t(missing[i])];
            auto png = encode_png(texture.width, texture.height, texture.pixels);
            if (png)
                result[missing[i]] = std::make_shared<const std::string>(std::move(*png));
            else
                failed[i] = png.error();
        }
    });
    for (const Status& status : failed)
        SUNFLECK_TRY(status);
    const std::scoped_lock lock(mutex_);
    encoded_ += missing.size();
    if (known_.size() < result.size())
        known_.resize(result.size());
    for (std::size_t i = 0; i < result.size(); ++i)
        if (known_[i] == nullptr)
            known_[i] = result[i];
    return result;
}

std::uint64_t EncodedTextures::encoded() const {
    const std::scoped_lock lock(mutex_);
    return encoded_;
}

} // namespace sunfleck::io
