#include "viewer/lost_devices.h"

#include "engine/core/log.h"

namespace sunfleck::viewer {

Status survive_lost_devices(const std::function<Status()>& work) {
    constexpr int most = 3;
    for (int losses = 1;; ++losses) {
        Status status = work();
        if (status || status.error().code != ErrorCode::device_lost)
            return status;
        if (losses == most)
            return Error{status.error().message + " (" + std::to_string(most) + " times: it is given up)",
                         ErrorCode::device_lost};
        log_warning(status.error().message + "; the work begins again on a new device");
    }
}

} // namespace sunfleck::viewer
