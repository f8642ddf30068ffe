// One-sided test of many rows at once for a centre above zero, by random signs. The samples of all rows that belong to
// one column (one pair of processes) keep or change their sign together, so that rows may depend on each other in any
// way; the greatest statistic over the rows is what corrects for their number.
// P. H. Westfall, S. S. Young, "Resampling-Based Multiple Testing", 1993 (step-down maximum).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sunfleck::statistics {

// rows x columns, row after row; a value of exactly zero is a missing one and takes no part.
struct SampleTable {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;

    SampleTable(std::size_t row_count, std::size_t column_count)
        : rows(row_count), columns(column_count), values(row_count * column_count, 0.0) {}
    double& at(std::size_t row, std::size_t column) { return values[row * columns + column]; }
    std::span<const double> row(std::size_t index) const { return {values.data() + index * columns, columns}; }
};

struct FlipTestResult {
    std::vector<double> p; // of each row, corrected for all rows; exact where values are symmetric about zero or below
    double critical = 0.0; // the statistic that a row must exceed for a corrected p below `error`
};

// The statistic of a row is that of clipped_sum.h. Compares with all 2^columns changes of signs, or with `flips` random
// ones where these are fewer.
FlipTestResult flip_test(const SampleTable& samples, std::uint32_t flips, std::uint32_t seed, double error);

} // namespace sunfleck::statistics
