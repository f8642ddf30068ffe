// The self-test's samples: three processes at once, of base, of the same source built with other bytes, and of a build
// with one pass made slower. They are kept in a file, a line each, so that measuring can go on another day.
#pragma once

#include "editor/gate/comparison.h"

namespace sunfleck::gate {

struct Triple {
    std::uint32_t number = 0;
    std::string rebuild; // which one
    std::string slowed;  // the row that was made slower
    Hello hello;
    std::vector<Frame> base, same, slow; // without counters
};

struct TriplePrograms {
    std::vector<std::string> base, same, slow;
};
// Turns as in a pair, in which the three follow each other in one order and then in the reverse one.
Result<Triple> run_triple(const TriplePrograms& programs, const PairOptions& options, std::uint32_t number,
                          const Patience& patience);

// Adds the triple as one line; a line that was cut off before is dropped.
Status append_triple(const std::filesystem::path& path, const Triple& triple);
// None where there is no file.
Result<std::vector<Triple>> read_triples(const std::filesystem::path& path);

// Base and one of the others as a pair.
PairRun pair_of(const Triple& triple, const std::vector<Frame>& head);

} // namespace sunfleck::gate
