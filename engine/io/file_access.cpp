#include "engine/io/file_access.h"

#include "engine/core/hash.h"
#include "engine/core/memory_limit.h"
#include "engine/io/uri.h"

#include <algorithm>

namespace sunfleck::io {

namespace fs = std::filesystem;

Status FileAccess::check(const fs::path& path) const {
    const Result<fs::path> resolved = resolve(path);
    return resolved ? Status() : Status(resolved.error());
}

Result<fs::path> FileAccess::resolve(const fs::path& path) const {
    if (root.empty() && !allow_outside)
        return Error{"'" + shortened(path.string()) + "' names no readable file"};
    if (allow_outside)
        return path;
    std::error_code code;
    const fs::path base = fs::canonical(root, code);
    const fs::path target = code ? fs::path() : fs::weakly_canonical(path, code);
    if (code)
        return Error{"'" + shortened(path.string()) + "' is not a path: " + code.message()};
    const auto [end, unused] = std::mismatch(base.begin(), base.end(), target.begin(), target.end());
    if (end != base.end())
        return Error{"'" + shortened(path.string()) + "' is not allowed: it lies outside the scene's folder '" +
                     base.string() + "' (--allow-outside, for scenes that you trust)"};
    return target;
}

Result<std::string> FileAccess::read(const fs::path& path, std::size_t size_limit) const {
    // By the name that was checked, without its links: one that is changed in between leads nowhere else.
    SUNFLECK_ASSIGN(const fs::path resolved, resolve(path));
    std::error_code code; // a scene may name one file many times
    if (const std::uintmax_t size = fs::file_size(resolved, code); !code && size <= size_limit)
        SUNFLECK_TRY(
            check_memory(size, "'" + shortened(path.filename().string()) + "'", "the size or number of files"));
    SUNFLECK_ASSIGN(std::string bytes, read_file(resolved, size_limit));
    if (content_hash != nullptr) {
        const std::uint64_t size = bytes.size(); // where one file ends and the next begins
        *content_hash = hash_bytes(hash_bytes(*content_hash, &size, sizeof size), bytes.data(), bytes.size());
    }
    return bytes;
}

fs::path real_folder(const fs::path& file) {
    std::error_code code;
    const fs::path resolved = fs::weakly_canonical(file, code);
    const fs::path folder = (code ? file : resolved).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

} // namespace sunfleck::io
