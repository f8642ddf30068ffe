// Where the centre of a few samples lies, when now and then one of them is wild. Everything follows from one statistic:
// the sum of the samples, each cut at the median of their sizes, over the root of the sum of the squares of what is
// left. It rises with Student's t. Cut and root stay the same when samples change their sign, so that a test by random
// signs (sign_flips.h) is exact, and under such changes it has mean 0 and variance 1.
#pragma once

#include <span>
#include <vector>

namespace sunfleck::statistics {

// The terms of the statistic, which is their sum. A sample of exactly zero takes no part: callers use it for "missing".
std::vector<float> clipped_terms(std::span<const double> samples);
double clipped_statistic(std::span<const double> samples);
// The statistic of the samples less `centre`.
double clipped_statistic(std::span<const double> samples, double centre);

// The centre at which the statistic is `deviate`: 0 gives the estimate, 1.96 the lower and -1.96 the upper limit of its
// interval at 95 %. Normal deviates are meant; for eight samples and more the true error is at most theirs by a hair.
// Infinite where there are too few samples.
double clipped_centre(const std::vector<double>& samples, double deviate);

// The deviate that a normal variable exceeds with this probability (below 0.5).
double normal_deviate(double probability);

} // namespace sunfleck::statistics
