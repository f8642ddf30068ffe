// The demo as a program.
#include "engine/core/memory_limit.h"
#include "engine/core/output.h"
#include "engine/core/program_end.h"
#include "engine/core/stop_signals.h"
#include "game_demo/command_line.h"

#include <iostream>

int main(int argc, char** argv) {
    using namespace sunfleck;
    hold_standard_streams();
    demo::Options options;
    if (const std::optional<int> status = demo::read_command_line(argc, argv, options, std::cout, std::cerr))
        return printed(*status);
    set_memory_limit(std::uint64_t(options.memory_mib) << 20);
    end_at_interrupts(); // until there is something to save
    return run_to_end([&] {
        return options.headless && options.simulate ? demo::run_simulation(options)
               : options.headless                   ? demo::run_headless(options)
                                                    : demo::run_window(options);
    });
}
