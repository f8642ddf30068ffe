// sunfleck compare: error metrics of image A against reference image B.
#include "editor/command_line/commands.h"
#include "editor/command_line/metrics.h"

#include "engine/core/output.h"

#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
Status compare(const CompareOptions& options) {
    const NamedFile inputs[] = {{"A", options.a}, {"B", options.b}}, output = {"--diff", options.difference};
    SUNFLECK_TRY(try_outputs({&output, 1}, inputs));
    if (!options.difference.empty())
        SUNFLECK_TRY(io::picture_kind(options.difference));
    SUNFLECK_ASSIGN(const io::Picture a, io::read_picture(options.a));
    SUNFLECK_ASSIGN(const io::Picture b, io::read_picture(options.b));
    if (a.width != b.width || a.height != b.height)
        return Error{"the pictures differ in size: " + std::to_string(a.width) + "x" + std::to_string(a.height) +
                     " and " + std::to_string(b.width) + "x" + std::to_string(b.height)};
    SUNFLECK_ASSIGN(const io::PictureKind kind, io::picture_kind(options.b));
    const Metrics m = compare_pictures(a, b, kind == io::PictureKind::exr);
    const Json json = {{"mean_a", m.mean_a},
                       {"mean_b", m.mean_b},
                       {"mae", m.mean_absolute_error},
                       {"max", m.maximum_error},
                       {"rmse", m.root_mean_square_error},
                       {"relative_mse", m.relative_mean_square_error},
                       {"psnr", m.peak_signal_to_noise},
                       {"ssim", m.structural_similarity},
                       {"flip", m.flip},
                       {"pixels", m.pixels},
                       {"left_out", m.left_out}};
    if (!options.difference.empty())
        SUNFLECK_TRY(io::write_picture(options.difference, difference_picture(a, b, kind == io::PictureKind::exr)));
    if (options.as_json) {
        std::printf("%s\n", json.dump().c_str());
        return {};
    }
    for (const auto& [name, value] : json.items())
        std::printf("%-14s %s\n", name.c_str(), value.dump().c_str());
    return {};
}

} // namespace sunfleck::command_line
