#include "gi_module/light_sampling/sample_clusters.h"

#include "engine/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <span>

namespace sunfleck::gi {
namespace {

constexpr float normal_length = 1.0f; // m: opposite normals are twice as far apart
constexpr float min_extent = 0.3f;    // m: so that flux counts even in a cluster without extent

// Position and scaled normal, m.
using Features = std::array<float, 6>;

Features features_of(const LightSample& sample) {
    const vec3 n = sample.normal * normal_length;
    return {sample.position.x, sample.position.y, sample.position.z, n.x, n.y, n.z};
}

struct Cluster {
    std::uint32_t first = 0, count = 0;
    double flux = 0;
    int axis = 0;     // of the largest extent
    double error = 0; // the cluster with the largest error is divided next
};

class Subdivision {
public:
    Subdivision(const std::vector<LightSample>& samples, float spread) : samples_(samples), spread_(spread) {
        order_.resize(samples.size());
        std::iota(order_.begin(), order_.end(), 0u);
    }

    Cluster measure(std::uint32_t first, std::uint32_t count) const {
        Cluster cluster{first, count, 0, 0, 0};
        Features low, high;
        low.fill(1e30f);
        high.fill(-1e30f);
        for (std::uint32_t i = first; i < first + count; ++i) {
            const LightSample& sample = samples_[order_[i]];
            cluster.flux += double(luminance(sample.flux));
            const Features features = features_of(sample);
            for (std::size_t k = 0; k < 6; ++k) {
                low[k] = std::min(low[k], features[k]);
                high[k] = std::max(high[k], features[k]);
            }
        }
        double square = double(min_extent) * double(min_extent);
        for (std::size_t k = 0; k < 6; ++k) {
            square += double(high[k] - low[k]) * double(high[k] - low[k]);
            if (high[k] - low[k] > high[std::size_t(cluster.axis)] - low[std::size_t(cluster.axis)])
                cluster.axis = int(k);
        }
        cluster.error = count > 1 ? std::pow(cluster.flux, 1.0 - 0.5 * double(spread_)) * square : -1.0;
        return cluster;
    }

    // At the median of the flux along the longest axis.
    std::pair<Cluster, Cluster> divide(const Cluster& cluster) {
        const auto begin = order_.begin() + cluster.first, end = begin + cluster.count;
        const std::size_t axis = std::size_t(cluster.axis);
        std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            const float pa = features_of(samples_[a])[axis], pb = features_of(samples_[b])[axis];
            return pa != pb ? pa < pb : a < b;
        });
        double flux = 0;
        std::uint32_t left = 0;
        while (left + 1 < cluster.count - 1 && flux < 0.5 * cluster.flux)
            flux += double(luminance(samples_[order_[cluster.first + left++]].flux));
        left = std::max(left, 1u);
        return {measure(cluster.first, left), measure(cluster.first + left, cluster.count - left)};
    }

    // The cluster's medoid, with the flux of all members and a disc as wide as they are spread. The light's path is
    // that of one of them, drawn in proportion to luminance; `number` in [0, 1).
    LightSample representative(const Cluster& cluster, float number) const {
        const auto members = std::span(order_).subspan(cluster.first, cluster.count);
        std::array<double, 6> mean{};
        glm::dvec3 flux(0.0);
        std::uint32_t drawn = members.front();
        double before = 0.0;
        for (const std::uint32_t i : members) {
            flux += glm::dvec3(samples_[i].flux);
            if (before <= double(number) * cluster.flux)
                drawn = i;
            before += double(luminance(samples_[i].flux));
            const Features features = features_of(samples_[i]);
            for (std::size_t k = 0; k < 6; ++k)
                mean[k] += double(luminance(samples_[i].flux)) / cluster.flux * double(features[k]);
        }
        LightSample sample = samples_[drawn];
        sample.flux = vec3(flux);
        place_at_medoid(cluster, mean, sample);
        return sample;
    }

private:
    void place_at_medoid(const Cluster& cluster, const std::array<double, 6>& mean, LightSample& sample) const {
        const auto members = std::span(order_).subspan(cluster.first, cluster.count);
        std::uint32_t medoid = members.front();
        double nearest = 1e30, variance = 0.0;
        for (const std::uint32_t i : members) {
            const Features features = features_of(samples_[i]);
            double in_space = 0.0, in_all = 0.0;
            for (std::size_t k = 0; k < 6; ++k) {
                in_all += (double(features[k]) - mean[k]) * (double(features[k]) - mean[k]);
                in_space = k < 3 ? in_all : in_space;
            }
            variance += double(luminance(samples_[i].flux)) / cluster.flux * in_space;
            if (in_all < nearest) {
                nearest = in_all;
                medoid = i;
            }
        }
        sample.position = samples_[medoid].position;
        sample.normal = samples_[medoid].normal;
        sample.index = samples_[medoid].index;
        sample.radius = std::sqrt(2.0f * float(variance)); // of a disc with that variance
    }

    const std::vector<LightSample>& samples_;
    float spread_;
    std::vector<std::uint32_t> order_;
};

} // namespace

std::vector<LightSample> cluster_samples(const std::vector<LightSample>& samples, std::uint32_t count, float spread,
                                         std::uint32_t seed) {
    if (samples.size() <= count)
        return samples;
    Subdivision subdivision(samples, spread);
    const auto less = [](const Cluster& a, const Cluster& b) {
        return a.error != b.error ? a.error < b.error : a.first > b.first;
    };
    std::priority_queue<Cluster, std::vector<Cluster>, decltype(less)> clusters(less);
    clusters.push(subdivision.measure(0, std::uint32_t(samples.size())));
    while (clusters.size() < count && clusters.top().error > 0) {
        const Cluster worst = clusters.top();
        clusters.pop();
        const auto [left, right] = subdivision.divide(worst);
        clusters.push(left);
        clusters.push(right);
    }
    std::vector<Cluster> all;
    for (; !clusters.empty(); clusters.pop())
        all.push_back(clusters.top());
    std::sort(all.begin(), all.end(), [](const Cluster& a, const Cluster& b) { return a.first < b.first; });
    std::vector<LightSample> result;
    for (std::uint32_t i = 0; i < all.size(); ++i)
        result.push_back(subdivision.representative(all[i], to_unit_float(hash_combine(hash_combine(seed, 0xc1), i))));
    return result;
}

} // namespace sunfleck::gi
