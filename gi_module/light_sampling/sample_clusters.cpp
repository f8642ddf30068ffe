#include "gi_module/light_sampling/sample_clusters.h"

#include "engine/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <queue>
#include <span>

namespace sunfleck::gi {
namespace {

constexpr float normal_length = 1.0f; // m: opposite normals are twice as far apart
constexpr float min_extent = 0.3f;    // m: so that flux counts even in a cluster without extent
// Clusters with less than so many times the mean flux are divided by surfaces, where one surface has at least this
// share of the flux, and the others together have it, too.
constexpr double small_cluster = 6.0, least_share = 0.25;

constexpr std::size_t clusters_between_reports = 64; // the first few, which are large, report each

// Position and scaled normal, m.
using Features = std::array<float, 6>;

Features features_of(const LightSample& sample) {
    const vec3 n = sample.normal * normal_length;
    return {sample.position.x, sample.position.y, sample.position.z, n.x, n.y, n.z};
}

// Whether both may lie on one surface: on one plane or, where normals differ a little, on one that bends from one to
// the other, so that no chord is inclined to it by more than the normals are to each other.
bool on_one_surface(const LightSample& a, const LightSample& b) {
    constexpr float smooth = 0.9f; // cosine; more is an edge
    if (!(glm::dot(a.normal, b.normal) >= smooth))
        return false;
    const vec3 chord = b.position - a.position, size = glm::max(glm::abs(a.position), glm::abs(b.position));
    const float rounding = 16.0f * std::numeric_limits<float>::epsilon() * std::max({size.x, size.y, size.z});
    return std::abs(glm::dot(a.normal, chord)) <= glm::length(a.normal - b.normal) * glm::length(chord) + rounding;
}

struct Cluster {
    std::uint32_t first = 0, count = 0;
    double flux = 0;
    int axis = 0;     // of the largest extent
    double error = 0; // the cluster with the largest error is divided next
};

class Subdivision {
public:
    Subdivision(const std::vector<LightSample>& samples, std::uint32_t count, float spread)
        : samples_(samples), spread_(spread) {
        order_.resize(samples.size());
        std::iota(order_.begin(), order_.end(), 0u);
        small_ = small_cluster * measure(0, std::uint32_t(samples.size())).flux / count;
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

    // Small ones by surfaces, since a VPL lies on one; others, and those without a surface that holds enough of the
    // flux, at the median.
    std::pair<Cluster, Cluster> divide(const Cluster& cluster) {
        std::uint32_t left = cluster.flux < small_ ? move_surface_first(cluster) : 0;
        left = left > 0 ? left : move_nearer_half_first(cluster);
        return {measure(cluster.first, left), measure(cluster.first + left, cluster.count - left)};
    }

    // A member is drawn in proportion to luminance, by `number` in [0, 1); the sample has its path. The place is that
    // of the medoid of those on its surface; the flux is that of all, and the disc is as wide as all are spread.
    LightSample representative(const Cluster& cluster, float number) const {
        const auto members = std::span(order_).subspan(cluster.first, cluster.count);
        glm::dvec3 flux(0.0);
        std::uint32_t drawn = members.front();
        double before = 0.0;
        for (const std::uint32_t i : members) {
            flux += glm::dvec3(samples_[i].flux);
            if (before <= double(number) * cluster.flux)
                drawn = i;
            before += double(luminance(samples_[i].flux));
        }
        std::vector<std::uint32_t> around;
        std::copy_if(members.begin(), members.end(), std::back_inserter(around),
                     [&](std::uint32_t i) { return i == drawn || on_one_surface(samples_[drawn], samples_[i]); });
        const LightSample& medoid = samples_[medoid_of(around)];
        LightSample sample = samples_[drawn];
        sample.flux = vec3(flux);
        sample.position = medoid.position;
        sample.normal = medoid.normal;
        sample.index = medoid.index;
        sample.radius = radius_of(members);
        return sample;
    }

private:
    // Puts those members first that lie on the surface that has most of the flux; returns how many, or 0 where there is
    // no surface to divide by.
    std::uint32_t move_surface_first(const Cluster& cluster) {
        const auto begin = order_.begin() + cluster.first, end = begin + cluster.count;
        auto brightest = begin, brightest_end = end;
        double most = -1.0;
        for (auto first = begin; first != end;) {
            const LightSample& of_surface = samples_[*first];
            const auto next = std::stable_partition(
                first + 1, end, [&](std::uint32_t i) { return on_one_surface(of_surface, samples_[i]); });
            double flux = 0.0;
            for (auto i = first; i != next; ++i)
                flux += double(luminance(samples_[*i].flux));
            if (flux > most) {
                most = flux;
                brightest = first, brightest_end = next;
            }
            first = next;
        }
        if (brightest_end - brightest == end - begin ||
            std::min(most, cluster.flux - most) < least_share * cluster.flux)
            return 0;
        std::rotate(begin, brightest, brightest_end);
        return std::uint32_t(brightest_end - brightest);
    }

    // Divides at the median of the flux along the longest axis; returns how many come first.
    std::uint32_t move_nearer_half_first(const Cluster& cluster) {
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
        return std::max(left, 1u);
    }

    // Of all features, weighted by luminance.
    std::array<double, 6> mean_of(std::span<const std::uint32_t> members) const {
        double flux = 0.0;
        std::array<double, 6> mean{};
        for (const std::uint32_t i : members) {
            const double weight = double(luminance(samples_[i].flux));
            flux += weight;
            const Features features = features_of(samples_[i]);
            for (std::size_t k = 0; k < 6; ++k)
                mean[k] += weight * double(features[k]);
        }
        for (double& feature : mean)
            feature /= flux;
        return mean;
    }

    // The member nearest to the mean.
    std::uint32_t medoid_of(std::span<const std::uint32_t> members) const {
        const std::array<double, 6> mean = mean_of(members);
        const auto square_to_mean = [&](std::uint32_t i) {
            const Features features = features_of(samples_[i]);
            double square = 0.0;
            for (std::size_t k = 0; k < 6; ++k)
                square += (double(features[k]) - mean[k]) * (double(features[k]) - mean[k]);
            return square;
        };
        return *std::min_element(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
            return square_to_mean(a) < square_to_mean(b);
        });
    }

    // Of a disc over which light varies in place as much as over the members, m.
    float radius_of(std::span<const std::uint32_t> members) const {
        const std::array<double, 6> mean = mean_of(members);
        double flux = 0.0, squares = 0.0;
        for (const std::uint32_t i : members) {
            const double weight = double(luminance(samples_[i].flux));
            const glm::dvec3 away = glm::dvec3(samples_[i].position) - glm::dvec3(mean[0], mean[1], mean[2]);
            flux += weight;
            squares += weight * glm::dot(away, away);
        }
        return std::sqrt(2.0f * float(squares / flux));
    }

    const std::vector<LightSample>& samples_;
    float spread_;
    double small_ = 0.0; // W; less is divided by surfaces
    std::vector<std::uint32_t> order_;
};

} // namespace

std::vector<LightSample> cluster_samples(const std::vector<LightSample>& samples, std::uint32_t count, float spread,
                                         std::uint32_t seed, const std::function<bool(float)>& progress) {
    if (samples.size() <= count)
        return samples;
    Subdivision subdivision(samples, count, spread);
    const auto less = [](const Cluster& a, const Cluster& b) {
        return a.error != b.error ? a.error < b.error : a.first > b.first;
    };
    // Each halving of all clusters takes about as long.
    const auto share_divided = [&](std::size_t clusters) {
        return std::log2(float(clusters)) / std::log2(float(count));
    };
    std::priority_queue<Cluster, std::vector<Cluster>, decltype(less)> clusters(less);
    clusters.push(subdivision.measure(0, std::uint32_t(samples.size())));
    while (clusters.size() < count && clusters.top().error > 0) {
        const bool reports =
            clusters.size() < clusters_between_reports || clusters.size() % clusters_between_reports == 0;
        if (progress && reports && !progress(share_divided(clusters.size())))
            return {};
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
