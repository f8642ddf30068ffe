#include "engine/core/program_end.h"

#include "engine/core/caught.h"
#include "engine/core/exit_status.h"
#include "engine/core/log.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"

namespace sunfleck {

int printed(int status) {
    const Status written = flush_standard_output();
    if (written || status != exit_done)
        return status;
    log_error(written.error().message);
    return exit_failed;
}

int run_to_end(const std::function<Status()>& work) {
    const Status status = caught(work);
    if (!status)
        log_error(status.error().message);
    if (stop_requested())
        return exit_stopped_by(stop_signal());
    return printed(status ? exit_done : exit_failed);
}

} // namespace sunfleck
