// The list of techniques as the build knows it; everybody else asks techniques() (technique.h).
#pragma once

#include "gi_module/technique.h"

namespace sunfleck::gi {

std::vector<TechniqueEntry> built_in_techniques();

} // namespace sunfleck::gi
