// sunfleck compare: error metrics of image A against reference image B.
#include "editor/command_line/common.h"
#include "editor/command_line/metrics.h"

#include "engine/core/file.h"

namespace sunfleck::command_line {
namespace {

struct CompareOptions {
    std::string a, b, difference;
    bool as_json = false;
};

Status run(const CompareOptions& options) {
    SUNFLECK_ASSIGN(const io::Picture a, io::read_picture(options.a));
    SUNFLECK_ASSIGN(const io::Picture b, io::read_picture(options.b));
    if (a.width != b.width || a.height != b.height)
        return Error{"the images differ in size: " + std::to_string(a.width) + "x" + std::to_string(a.height) +
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

} // namespace

Command make_compare_command(CLI::App& program) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* app = program.add_subcommand("compare", "Compares image A with a reference image B of the same size");
    app->footer(
        "Example: sunfleck compare render.exr reference.exr --json --diff difference.png\n"
        "EXR is compared scene-linear, PNG as display values. Pixels with alpha 0 in either image are ignored.\n"
        "relative_mse: mean of |A-B|^2 / (|B|^2 + 0.01 m^2), m the mean of |B|. ssim and flip of EXR images\n"
        "are computed after tone mapping by x / (x + m). psnr is 999 for equal images.");
    app->add_option("A", options->a, "Image to evaluate")->required();
    app->add_option("B", options->b, "Reference image")->required();
    app->add_option("--diff", options->difference, "Write the absolute difference, times eight, as .png");
    app->add_flag("--json", options->as_json, "Print a JSON object");
    return {app, [options] {
                const Status status = run(*options);
                return status ? 0 : fail(status.error());
            }};
}

} // namespace sunfleck::command_line
