// Textures as PNG, which takes far longer than all else of a save: each is encoded once.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/texture_store.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace sunfleck::io {

// Of one store and its copies, which have the same textures under the same numbers; textures never change. Any thread.
class EncodedTextures {
public:
    // Of all that are in the store, encoded on all cores as far as they are new.
    Result<std::vector<std::shared_ptr<const std::string>>> of(const scene::TextureStore& textures);
    // How many were encoded so far.
    std::uint64_t encoded() const;

private:
    mutable std::mutex mutex_;
    std::vector<std::shared_ptr<const std::string>> known_; // by number; null: not yet
    std::uint64_t encoded_ = 0;
};

} // namespace sunfleck::io
