// What programs do when the GPU stops answering.
#pragma once

#include "engine/core/result.h"

#include <functional>

namespace sunfleck::viewer {

// Runs work that makes a device of its own. Where the device is lost, a warning says so and the work is run again on a
// new one, twice at most; the third loss is returned. Other errors are returned at once.
Status survive_lost_devices(const std::function<Status()>& work);

} // namespace sunfleck::viewer
