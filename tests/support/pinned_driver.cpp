// Loaded before programs that tests start (LD_PRELOAD). The libraries themselves can't be: the validation layer's
// functions have the loader's names, and would be taken for them.
#include "tests/support/pinned_driver.h"

namespace {

__attribute__((constructor)) void pin() {
    sunfleck::tests::pin_driver();
}

} // namespace
