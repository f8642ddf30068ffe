// How the elements of a glTF file's sections refer to each other, and which of them a scene uses.
#pragma once

#include "engine/core/result.h"

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sunfleck::io {

// Checks that all references name elements that exist. Expects sections that are lists of objects. An element that no
// scene uses does no harm: where its references are broken, it is emptied and noted. Otherwise the message names place
// and index.
Status check_references(nlohmann::json& file, std::vector<std::string>& notes);

// Which elements the nodes of all scenes (of a file without scenes: all nodes) and all animations use, directly or
// through others. Broken references count for nothing.
class GltfUsage {
public:
    explicit GltfUsage(const nlohmann::json& file);
    bool uses(std::string_view section, std::size_t index) const;

private:
    void add(const nlohmann::json& file, const std::string& section, std::size_t index);

    std::map<std::string, std::vector<bool>, std::less<>> used_;
};

} // namespace sunfleck::io
