// The reference of everything that users can set or look at, as Markdown: docs/settings.md, which a test holds to this.
#pragma once

#include <string>

namespace sunfleck::gi {

// Settings by struct, then techniques, sources of samples, counters and debug views, all from their declarations.
std::string settings_reference();

} // namespace sunfleck::gi
