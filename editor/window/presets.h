// Settings of the lighting under names, a file each: those that differ from their defaults.
#pragma once

#include "editor/document/document.h"

namespace sunfleck::editor {

// In alphabetical order.
std::vector<std::string> preset_names(const std::filesystem::path& folder);
// Names are letters, digits, spaces, "-" and "_". An existing preset is replaced.
Status save_preset(const std::filesystem::path& folder, const std::string& name, const gi::Settings& settings);
Result<gi::Settings> load_preset(const std::filesystem::path& folder, const std::string& name);
// One gesture.
Status apply_preset(const std::filesystem::path& folder, const std::string& name, Document& document);

} // namespace sunfleck::editor
